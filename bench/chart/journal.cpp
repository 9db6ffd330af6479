#include "journal.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "csv.h"

namespace ragtop::chart {
namespace {

bool isDisturbed(const Point& point) { return !point.alone && std::isfinite(point.cpuMs); }

}  // namespace

Journal::Journal(const std::filesystem::path& file, const std::string& plan, bool resume, bool again) : path_(file) {
    const std::string head = fmt::format("ragtop-chart-journal-1 {}\n", plan);
    if (resume) {
        std::ifstream stream(file, std::ios::binary);
        load({std::istreambuf_iterator<char>(stream), {}}, head);
        if (again) std::erase_if(known_, [](const auto& each) { return isDisturbed(each.second); });
    }
    // What was whole is written anew, so that a line that was cut off is gone.
    std::string text = head;
    for (const auto& [key, point] : known_) text += csvLine(point, 0, 0);
    writeWhole(file, text);
    file_.reset(std::fopen(file.c_str(), "ab"));
    if (!file_) throw std::runtime_error(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
}

void Journal::load(const std::string& text, const std::string& head) {
    const std::size_t first = text.find('\n');
    if (first == std::string::npos) return;
    if (text.substr(0, first + 1) != head)
        throw std::runtime_error(path_.string() +
                                 ":1: is of another sweep; go on with its options, or leave out --resume");
    std::size_t line = 2;
    for (std::size_t at = first + 1; at < text.size(); ++line) {
        const std::size_t end = text.find('\n', at);
        if (end == std::string::npos) return;
        const std::string place = fmt::format("{}:{}", path_.string(), line);
        const Point point = parseCsvLine(std::string_view(text).substr(at, end - at), place).point;
        known_.insert_or_assign(point.key(), point);
        at = end + 1;
    }
}

const Point* Journal::find(const std::string& key) const {
    const auto at = known_.find(key);
    return at == known_.end() ? nullptr : &at->second;
}

void Journal::add(const Point& point) { write(csvLine(point, 0, 0)); }

void Journal::write(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size() && std::fflush(file_.get()) == 0) return;
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
}

}  // namespace ragtop::chart
