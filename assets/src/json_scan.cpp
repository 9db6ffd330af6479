#include "json_scan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <vector>

#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

class Scan {
public:
    Scan(std::string_view text, const std::string& file) : text_(text), file_(file) {
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (text[i] == '\n') lineStarts_.push_back(i + 1);
        }
    }

    std::map<std::string, JsonPlace> places() && {
        value("", 0);
        if (!doubled_.empty()) throw AssetError(fmt::format("{}", fmt::join(doubled_, "\n")));
        return std::move(places_);
    }

private:
    void value(const std::string& pointer, int depth) {
        skipBlanks();
        const JsonPlace start = place(at_);
        if (depth > kMaxJsonDepth) {
            fail(start, fmt::format("{} nests deeper than {} levels, the most allowed", pointer, kMaxJsonDepth));
        }
        places_.emplace(pointer, start);
        if (peek() == '{')
            object(pointer, depth);
        else if (peek() == '[')
            array(pointer, depth);
        else if (peek() == '"')
            string();
        else
            at_ = std::min(text_.find_first_of(",]}/ \t\r\n", at_), text_.size());
    }

    void object(const std::string& pointer, int depth) {
        std::set<std::string> keys;
        ++at_;
        for (skipBlanks(); peek() != '}'; skipBlanks()) {
            const JsonPlace start = place(at_);
            const std::string key = parsedOrDiscarded(string()).get<std::string>();
            const std::string inner = pointer + pointerStep(key);
            if (!keys.insert(key).second) {
                doubled_.push_back(
                    complaint(start, fmt::format("{} occurs twice, a key must occur once in its object", inner)));
            }
            skipBlanks();
            ++at_;
            value(inner, depth + 1);
            skipComma();
        }
        ++at_;
    }

    void array(const std::string& pointer, int depth) {
        ++at_;
        std::size_t index = 0;
        for (skipBlanks(); peek() != ']'; skipBlanks()) {
            value(pointer + "/" + std::to_string(index++), depth + 1);
            skipComma();
        }
        ++at_;
    }

    std::string_view string() {
        const std::size_t start = at_++;
        while (peek() != '"') at_ += peek() == '\\' ? 2 : 1;
        ++at_;
        return text_.substr(start, at_ - start);
    }

    void skipComma() {
        skipBlanks();
        if (peek() == ',') ++at_;
    }

    void skipBlanks() {
        at_ = std::min(text_.find_first_not_of("\xef\xbb\xbf \t\r\n", at_), text_.size());
        while (peek() == '/') {
            const bool line = text_.substr(at_, 2) == "//";
            const std::size_t end = text_.find(line ? "\n" : "*/", at_ + 2);
            at_ = end == std::string_view::npos ? text_.size() : end + (line ? 1 : 2);
            at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size());
        }
    }

    char peek() const {
        if (at_ >= text_.size()) fail(place(text_.size()), "ends too early");
        return text_[at_];
    }

    JsonPlace place(std::size_t byte) const {
        const auto next = std::upper_bound(lineStarts_.begin(), lineStarts_.end(), byte);
        return {file_, static_cast<int>(next - lineStarts_.begin()), static_cast<int>(byte - *(next - 1)) + 1};
    }

    static std::string complaint(const JsonPlace& place, const std::string& message) {
        return fmt::format("{}:{}:{}: {}", place.file, place.line, place.column, message);
    }
    [[noreturn]] static void fail(const JsonPlace& place, const std::string& message) {
        throw AssetError(complaint(place, message));
    }

    std::string_view text_;
    const std::string& file_;
    std::size_t at_ = 0;
    std::vector<std::size_t> lineStarts_{0};
    std::map<std::string, JsonPlace> places_;
    std::vector<std::string> doubled_;  ///< complaints about keys
};

}  // namespace

JsonPlace placeAt(std::string_view text, std::size_t byte) {
    const std::string_view before = text.substr(0, std::min(byte, text.size()));
    const auto lineStart = before.rfind('\n');
    return {"", 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n')),
            1 + static_cast<int>(before.size() - (lineStart == std::string_view::npos ? 0 : lineStart + 1))};
}

std::map<std::string, JsonPlace> scanPlaces(std::string_view text, const std::string& file) {
    return Scan(text, file).places();
}

}  // namespace ragtop
