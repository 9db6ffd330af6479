#include "faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace ragtop {

void Faults::add(const std::string& pointer, const std::string& message) {
    addLines(pointer, document_->complaint(pointer, message));
}

void Faults::addUnknown(const std::string& pointer, const std::string& message) {
    add(pointer, message);
    ofUnknown_.insert(pointer.substr(0, pointer.rfind('/')));
}

/// A file that is referred to twice says the same twice.
void Faults::addLines(const std::string& pointer, std::string_view lines) {
    wrong_.insert(pointer);
    for (std::size_t end = 0; end < lines.size();) {
        const std::size_t start = end == 0 ? 0 : end + 1;
        end = std::min(lines.find('\n', start), lines.size());
        std::string text(lines.substr(start, end - start));
        const auto isSame = [&](const Line& line) { return line.text == text; };
        if (std::none_of(lines_.begin(), lines_.end(), isSame))
            lines_.push_back({document_->place(pointer), lines_.size(), std::move(text)});
    }
}

void Faults::throwIfAny() const {
    constexpr std::size_t kShown = 20;
    if (lines_.empty()) return;
    std::vector<Line> sorted = lines_;
    std::sort(sorted.begin(), sorted.end(), [](const Line& a, const Line& b) {
        return std::tie(a.place.file, a.place.line, a.place.column, a.number) <
               std::tie(b.place.file, b.place.line, b.place.column, b.number);
    });
    std::string text;
    for (std::size_t i = 0; i < std::min(sorted.size(), kShown); ++i) text += (i == 0 ? "" : "\n") + sorted[i].text;
    if (sorted.size() > kShown) text += fmt::format("\nand {} more", sorted.size() - kShown);
    throw AssetError(text);
}

bool Faults::within(const std::string& pointer) const {
    if (wrong_.empty()) return false;
    const auto inside = wrong_.lower_bound(pointer + "/");
    return at(pointer) || (inside != wrong_.end() && inside->starts_with(pointer + "/"));
}

}  // namespace ragtop
