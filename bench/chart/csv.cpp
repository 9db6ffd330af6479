#include "csv.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

namespace ragtop::chart {
namespace {

constexpr std::string_view kSchema = "ragtop-chart-1";

constexpr std::array kColumns{
    "schema",         "point",     "points",      "scene",      "quantity",   "unit",
    "reference_kind", "engine",    "version",     "variant",    "step_s",     "substeps",
    "iterations",     "default",   "seed",        "digest",     "outcome",    "failed_at_s",
    "value",          "reference", "error",       "error_low",  "error_high", "self_consistency",
    "contacts",       "passes",    "simulated_s", "repeats",    "reason",     "command",
    "alone",          "cpu_ms",    "cpu_ms_low",  "cpu_ms_high"};

constexpr std::array<std::string_view, 3> kOutcomes{"measured", "failed", "unsupported"};

std::string number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : std::string(); }

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"') result += '"';
        result += c == '\n' || c == '\r' ? ' ' : c;
    }
    return result + '"';
}

std::vector<std::string> fieldsOf(std::string_view line) {
    std::vector<std::string> fields(1);
    bool inQuotes = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (inQuotes && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
            fields.back() += c;
            ++i;
        } else if (c == '"') {
            inQuotes = !inQuotes;
        } else if (c == ',' && !inQuotes) {
            fields.emplace_back();
        } else {
            fields.back() += c;
        }
    }
    return fields;
}

/// Takes the fields of a line one after the other.
class Reader {
public:
    Reader(std::vector<std::string> fields, const std::string& place) : fields_(std::move(fields)), place_(place) {}

    std::string text() { return fields_[at_++]; }
    double real() {
        const std::string& field = fields_[at_];
        if (!field.empty()) return parse<double>("must be a number or empty");
        ++at_;
        return kNone;
    }
    template <class T>
    T whole() {
        return parse<T>("must be a whole number");
    }
    std::uint64_t hexadecimal() {
        std::uint64_t value = 0;
        const std::string& field = fields_[at_];
        const auto result = std::from_chars(field.data(), field.data() + field.size(), value, 16);
        if (result.ec != std::errc() || result.ptr != field.data() + field.size()) complain("must be hexadecimal");
        ++at_;
        return value;
    }
    Outcome outcome() {
        for (std::size_t i = 0; i < kOutcomes.size(); ++i)
            if (fields_[at_] == kOutcomes[i]) {
                ++at_;
                return static_cast<Outcome>(i);
            }
        complain("must be measured, failed or unsupported");
    }

private:
    template <class T>
    T parse(const char* allowed) {
        T value{};
        const std::string& field = fields_[at_];
        const auto result = std::from_chars(field.data(), field.data() + field.size(), value);
        if (result.ec != std::errc() || result.ptr != field.data() + field.size()) complain(allowed);
        ++at_;
        return value;
    }
    [[noreturn]] void complain(const char* allowed) const {
        throw CsvError(fmt::format("{}: {} is \"{}\", {}", place_, kColumns[at_], fields_[at_], allowed));
    }
    std::vector<std::string> fields_;
    const std::string& place_;
    std::size_t at_ = 0;
};

}  // namespace

std::string Point::key() const {
    return fmt::format("{}/{}@{}x{}i{}", scene, variant, std::lround(1 / setting.step), setting.substeps,
                       setting.iterations);
}

const char* nameOf(ReferenceKind kind) {
    switch (kind) {
        case ReferenceKind::closedForm:
            return "closed form";
        case ReferenceKind::published:
            return "published solution";
        case ReferenceKind::invariant:
            return "invariant";
        default:
            return "threshold";
    }
}

std::string csvHead() { return fmt::format("{}\n", fmt::join(kColumns, ",")); }

std::string csvLine(const Point& p, std::size_t index, std::size_t count) {
    return fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{:016x},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
        kSchema, index + 1, count, quoted(p.scene), quoted(p.quantity), quoted(p.unit), p.referenceKind, p.engine,
        quoted(p.version), p.variant, number(p.setting.step), p.setting.substeps, p.setting.iterations,
        p.isDefault ? 1 : 0, p.seed, p.digest, kOutcomes[static_cast<std::size_t>(p.outcome)], number(p.failedAt),
        number(p.value), number(p.reference), number(p.error), number(p.errorLow), number(p.errorHigh),
        number(p.selfConsistency), number(p.contacts), number(p.passes), number(p.simulated), p.repeats,
        quoted(p.reason), quoted(p.command), p.alone ? 1 : 0, number(p.cpuMs), number(p.cpuMsLow), number(p.cpuMsHigh));
}

CsvPlace parseCsvLine(std::string_view line, const std::string& place) {
    std::vector<std::string> fields = fieldsOf(line);
    if (fields[0] != kSchema)
        throw CsvError(fmt::format("{}: schema is \"{}\", must be {}", place, fields[0].substr(0, 40), kSchema));
    if (fields.size() != kColumns.size())
        throw CsvError(fmt::format("{}: has {} fields, must have {}", place, fields.size(), kColumns.size()));
    Reader read(std::move(fields), place);
    CsvPlace result;
    Point& p = result.point;
    read.text();
    result.index = read.whole<std::size_t>() - 1;
    result.count = read.whole<std::size_t>();
    for (std::string* text : {&p.scene, &p.quantity, &p.unit, &p.referenceKind, &p.engine, &p.version, &p.variant})
        *text = read.text();
    p.setting.step = read.real();
    p.setting.substeps = read.whole<int>();
    p.setting.iterations = read.whole<int>();
    p.isDefault = read.whole<int>() != 0;
    p.seed = read.whole<std::uint64_t>();
    p.digest = read.hexadecimal();
    p.outcome = read.outcome();
    for (double* value : {&p.failedAt, &p.value, &p.reference, &p.error, &p.errorLow, &p.errorHigh, &p.selfConsistency,
                          &p.contacts, &p.passes, &p.simulated})
        *value = read.real();
    p.repeats = read.whole<int>();
    p.reason = read.text();
    p.command = read.text();
    p.alone = read.whole<int>() != 0;
    for (double* value : {&p.cpuMs, &p.cpuMsLow, &p.cpuMsHigh}) *value = read.real();
    return result;
}

std::string toCsv(const Points& points) {
    std::string text = csvHead();
    for (std::size_t i = 0; i < points.size(); ++i) text += csvLine(points[i], i, points.size());
    return text;
}

Points readCsv(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) throw CsvError(file.string() + ": cannot be read");
    const std::string head = csvHead();
    if (!text.starts_with(head))
        throw CsvError(fmt::format("{}:1: does not begin with the columns of {}", file.string(), kSchema));
    Points points;
    std::size_t count = 0, line = 2;
    for (std::size_t at = head.size(); at < text.size(); ++line) {
        const std::size_t end = text.find('\n', at);
        const std::string place = fmt::format("{}:{}", file.string(), line);
        if (end == std::string::npos) throw CsvError(place + ": is cut off");
        const CsvPlace parsed = parseCsvLine(std::string_view(text).substr(at, end - at), place);
        if (parsed.index != points.size())
            throw CsvError(fmt::format("{}: is point {}, must be {}", place, parsed.index + 1, points.size() + 1));
        points.push_back(parsed.point);
        count = parsed.count;
        at = end + 1;
    }
    if (points.empty() || points.size() != count)
        throw CsvError(fmt::format("{}: is cut off after {} of {} points", file.string(), points.size(), count));
    return points;
}

void writeWhole(const std::filesystem::path& file, std::string_view text) {
    const std::filesystem::path draft = file.string() + ".part";
    errno = 0;
    std::ofstream stream(draft, std::ios::binary);
    stream << text;
    stream.close();
    std::error_code code;
    if (stream) std::filesystem::rename(draft, file, code);
    if (stream && !code) return;
    const std::string why = code ? code.message() : std::strerror(errno);
    std::filesystem::remove(draft, code);
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", file.string(), why));
}

}  // namespace ragtop::chart
