#include "xml_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>
#include <system_error>

#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{32} << 20;
constexpr int kMostLevels = 64;

/// The line on which elements nest too deep; 0: nowhere.
int lineTooDeep(std::string_view text) {
    int depth = 0;
    const auto after = [&](std::string_view end, std::size_t from) {
        const std::size_t found = text.find(end, from);
        return found == std::string_view::npos ? text.size() : found + end.size();
    };
    for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
        const std::string_view rest = text.substr(at);
        if (rest.starts_with("<!--")) {
            at = after("-->", at + 4);
        } else if (rest.starts_with("<![CDATA[")) {
            at = after("]]>", at);
        } else if (rest.starts_with("<?") || rest.starts_with("<!")) {
            at = after(">", at);
        } else if (rest.starts_with("</")) {
            --depth;
            at = after(">", at);
        } else {
            const std::size_t begin = at;
            // Quotes may hold brackets.
            for (++at; at < text.size() && text[at] != '>'; ++at) {
                if (text[at] == '"' || text[at] == '\'') at = after(text.substr(at, 1), at + 1) - 1;
            }
            if (at < text.size() && text[at - 1] != '/' && ++depth > kMostLevels)
                return 1 + static_cast<int>(
                               std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(begin), '\n'));
        }
    }
    return 0;
}

}  // namespace

void readXml(const std::filesystem::path& path, XmlText& into) {
    const std::string file = path.string();
    std::ifstream stream(path, std::ios::binary);
    std::error_code error;
    if (!stream || !std::filesystem::is_regular_file(path, error)) throw AssetError(file, "", "no such file");
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (error || bytes > kMostBytes)
        throw AssetError(file, "",
                         "is " + std::to_string(bytes) + " bytes long, must be at most " + std::to_string(kMostBytes));
    into.source.assign(std::istreambuf_iterator<char>(stream), {});
    if (const int line = lineTooDeep(into.source); line > 0)
        throw AssetError(file, std::to_string(line),
                         "nests elements deeper than " + std::to_string(kMostLevels) + " levels, the most allowed");
    TiXmlDocument& document = into.document;
    document.Parse(into.source.c_str(), nullptr, TIXML_ENCODING_UTF8);
    if (!document.Error()) return;
    const std::string place =
        document.ErrorRow() > 0 ? std::to_string(document.ErrorRow()) + ":" + std::to_string(document.ErrorCol()) : "";
    throw AssetError(file, place, std::string("is no XML: ") + document.ErrorDesc());
}

const TiXmlElement* nextElement(const TiXmlElement* element, const TiXmlElement& top, bool intoIt) {
    const TiXmlElement* next = intoIt ? element->FirstChildElement() : nullptr;
    while (!next && element != &top) {
        next = element->NextSiblingElement();
        if (!next) element = element->Parent()->ToElement();
    }
    return next;
}

int readNumbers(std::string_view text, std::span<double> values) {
    const char* at = text.data();
    const char* end = at + text.size();
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
    std::size_t found = 0;
    while (true) {
        while (at != end && blank(*at)) ++at;
        if (at == end) return static_cast<int>(found);
        if (*at == '+') ++at;
        double value = 0;
        const auto [after, error] = std::from_chars(at, end, value);
        if (error != std::errc() || (after != end && !blank(*after)) || !std::isfinite(value) ||
            std::abs(value) > static_cast<double>(std::numeric_limits<float>::max()) || found == values.size())
            return -1;
        values[found++] = value;
        at = after;
    }
}

}  // namespace ragtop
