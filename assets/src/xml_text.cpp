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

constexpr std::size_t kNowhere = std::string_view::npos;

/// What the library recurses on, and what it leaves out in silence.
class TextCheck {
public:
    explicit TextCheck(std::string_view text) : text_(text) {}

    void run() {
        std::size_t from = 0;
        for (; tooDeep == kNowhere && (at_ = text_.find('<', from)) < text_.size(); from = at_) {
            checkBetween(from, at_);
            passTag();
        }
        checkBetween(from, text_.size());
    }

    std::size_t tooDeep = kNowhere;  ///< where elements nest too deep
    std::size_t beside = kNowhere;   ///< where something is beside the first of all elements

private:
    std::size_t after(std::string_view end, std::size_t from) const {
        const std::size_t found = text_.find(end, from);
        return found == std::string_view::npos ? text_.size() : found + end.size();
    }

    void checkBetween(std::size_t from, std::size_t to) {
        if (depth_ > 0 || roots_ == 0) return;
        if (const std::size_t at = text_.find_first_not_of(" \t\r\n", from); at < to) beside = std::min(beside, at);
    }

    void passTag() {
        const std::string_view rest = text_.substr(at_);
        if (rest.starts_with("<!--")) {
            at_ = after("-->", at_ + 4);
        } else if (rest.starts_with("<![CDATA[")) {
            at_ = after("]]>", at_);
        } else if (rest.starts_with("<?") || rest.starts_with("<!")) {
            at_ = after(">", at_);
        } else if (rest.starts_with("</")) {
            if (--depth_ < 0) beside = std::min(beside, at_);
            at_ = after(">", at_);
        } else {
            passBeginning();
        }
    }

    void passBeginning() {
        const std::size_t begin = at_;
        // Quotes may hold brackets.
        for (++at_; at_ < text_.size() && text_[at_] != '>'; ++at_)
            if (text_[at_] == '"' || text_[at_] == '\'') at_ = after(text_.substr(at_, 1), at_ + 1) - 1;
        if (depth_ <= 0 && ++roots_ > 1) beside = std::min(beside, begin);
        if (at_ < text_.size() && text_[at_ - 1] != '/' && ++depth_ > kMostLevels) tooDeep = begin;
        if (at_ < text_.size()) ++at_;
    }

    std::string_view text_;
    std::size_t at_ = 0;
    int depth_ = 0, roots_ = 0;
};

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
    TextCheck check(into.source);
    check.run();
    const auto fail = [&](std::size_t at, const std::string& what) {
        const auto begin = into.source.begin();
        throw AssetError(file, std::to_string(1 + std::count(begin, begin + static_cast<std::ptrdiff_t>(at), '\n')),
                         what);
    };
    if (check.tooDeep != kNowhere)
        fail(check.tooDeep, "nests elements deeper than " + std::to_string(kMostLevels) + " levels, the most allowed");
    TiXmlDocument& document = into.document;
    document.Parse(into.source.c_str(), nullptr, TIXML_ENCODING_UTF8);
    if (document.Error()) {
        const std::string row = std::to_string(document.ErrorRow()), column = std::to_string(document.ErrorCol());
        throw AssetError(file, document.ErrorRow() > 0 ? row + ":" + column : "",
                         std::string("is no XML: ") + document.ErrorDesc());
    }
    if (check.beside != kNowhere) fail(check.beside, "has something beside its outermost element, must have nothing");
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
