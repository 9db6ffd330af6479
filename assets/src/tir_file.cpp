// Tire property files (.tir): sections in brackets, NAME = value, comments after $ or !.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "ragtop/tire_file.h"

namespace ragtop {
namespace {

struct Entry {
    std::string text;
    int line = 0;
};

std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

std::string inCapitals(std::string text) {
    for (char& letter : text) {
        if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
    }
    return text;
}

std::string text(double value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 7);
    return {digits.data(), end.ptr};
}

std::optional<double> numberOf(std::string_view value) {
    if (value.starts_with('+')) value.remove_prefix(1);
    double number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || end != value.data() + value.size() || !std::isfinite(number)) return {};
    return number;
}

/// A file, and all that is wrong in it.
class TirFile {
public:
    explicit TirFile(const std::filesystem::path& path) : path_(path.string()) {
        std::ifstream file(path, std::ios::binary);
        if (!file) throw AssetError(path_, "", "cannot be read");
        std::string line;
        for (int number = 1; std::getline(file, line); ++number) take(line, number);
        if (file.bad()) throw AssetError(path_, "", "cannot be read to its end");
    }

    const std::string& path() const { return path_; }
    bool has(const std::string& name) const { return entries_.contains(name); }
    const std::map<std::string, Entry>& entries() const { return entries_; }

    void complain(int line, const std::string& message) {
        if (!complaints_.empty()) complaints_ += '\n';
        complaints_ += path_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " + message;
    }
    void throwIfAny() const {
        if (!complaints_.empty()) throw AssetError(complaints_);
    }

    /// A number in its range; empty, with a complaint where it is there and none.
    std::optional<float> number(const Tunable& wanted) {
        const auto at = entries_.find(std::string(wanted.name));
        if (at == entries_.end()) return {};
        used_.insert(at->first);
        const auto [value, line] = at->second;
        const std::optional<double> number = numberOf(value);
        if (number && *number >= wanted.minimum && *number <= wanted.maximum) return static_cast<float>(*number);
        const std::string unit = wanted.unit.empty() || wanted.unit == "1" ? "" : " " + std::string(wanted.unit);
        complain(line, at->first + " is " + (number ? text(*number) + unit : value) + ", must be " +
                           (number ? "" : "a number ") + "in [" + text(wanted.minimum) + ", " + text(wanted.maximum) +
                           "]");
        return {};
    }

    /// One of some words, where it is there.
    void word(const std::string& name, const std::vector<std::string>& allowed) {
        const auto at = entries_.find(name);
        if (at == entries_.end()) return;
        used_.insert(name);
        if (std::find(allowed.begin(), allowed.end(), inCapitals(at->second.text)) != allowed.end()) return;
        std::string list;
        for (const std::string& one : allowed) list += (list.empty() ? "" : ", ") + one;
        complain(at->second.line, name + " is '" + at->second.text + "', must be one of " + list);
    }

    /// Names of numbers that nobody asked for, and that are not 0.
    std::vector<std::string> unused() const {
        std::vector<std::string> names;
        for (const auto& [name, entry] : entries_) {
            const std::optional<double> number = numberOf(entry.text);
            const bool isScale = name.starts_with('L') && number == 1.0;
            if (!used_.contains(name) && number && *number != 0 && !isScale) names.push_back(name);
        }
        return names;
    }

private:
    void take(std::string_view line, int number) {
        line = line.substr(0, line.find_first_of("$!"));
        const std::string whole = trimmed(line);
        if (whole.empty() || whole.front() == '{') return;
        if (whole.front() == '[') {
            if (whole.back() != ']') complain(number, whole + " is a section without its end, must have ]");
            return;
        }
        const auto sign = whole.find('=');
        if (sign == std::string::npos) {
            // A row of a table, as that of the section SHAPE.
            if (whole.find_first_not_of("0123456789+-.eE \t") == std::string::npos) return;
            complain(number, "'" + whole + "' is no line of this format, must be NAME = value");
            return;
        }
        const std::string name = inCapitals(trimmed(whole.substr(0, sign)));
        std::string value = trimmed(whole.substr(sign + 1));
        if (value.size() >= 2 && (value.front() == '\'' || value.front() == '"') && value.back() == value.front())
            value = trimmed(value.substr(1, value.size() - 2));
        if (name.empty() || value.empty()) {
            complain(number, "'" + whole + "' lacks a name or a value, must be NAME = value");
            return;
        }
        const auto [at, isNew] = entries_.try_emplace(name, Entry{value, number});
        if (!isNew)
            complain(number, name + " is given again, must be in one line: line " + std::to_string(at->second.line) +
                                 " has it");
    }

    std::string path_, complaints_;
    std::map<std::string, Entry> entries_;
    std::set<std::string> used_;
};

void requireFormat(TirFile& file) {
    file.word("LENGTH", {"METER", "METRE", "M"});
    file.word("FORCE", {"NEWTON", "N"});
    file.word("ANGLE", {"RADIAN", "RADIANS", "RAD"});
    file.word("MASS", {"KG", "KILOGRAM"});
    file.word("TIME", {"SECOND", "SEC", "S"});
    file.word("PROPERTY_FILE_FORMAT", {"PAC2002", "MF-TYRE", "MF-SWIFT", "MF_05", "MF52", "MF61", "MF62", "USER"});
    file.word("FITTYP", {"5", "6", "21", "51", "52", "60", "61", "62"});
    for (const char* name : {"FNOMIN", "PCX1", "PDX1", "PKX1", "PCY1", "PDY1", "PKY1", "PKY2"}) {
        if (!file.has(name)) file.complain(0, std::string(name) + " is not given, must be");
    }
}

MagicFormulaDef coefficientsOf(TirFile& file) {
    MagicFormulaDef def;
    for (std::size_t i = 0; i < def.values.size(); ++i) {
        const auto& [tunable, standard] = kMagicCoefficients[i];
        const bool isScale = tunable.name.front() == 'L', isPlain = tunable.unit == "1" && !isScale;
        const bool isOff = isPlain && tunable.minimum <= 0 && tunable.maximum >= 0;
        def.values[i] = file.number(tunable).value_or(isOff ? 0 : standard);
    }
    if (!file.has("FITTYP")) def.values[magicIndex("FITTYP")] = 52;
    // One pressure alone is both.
    if (!file.has("INFLPRES")) def.values[magicIndex("INFLPRES")] = def.values[magicIndex("NOMPRES")];
    if (!file.has("NOMPRES")) def.values[magicIndex("NOMPRES")] = def.values[magicIndex("INFLPRES")];
    return def;
}

/// σ = PTY1 sin(2 atan(1/PTY2)) R₀ at the nominal load; with t = 1/PTY2 the sine is 2 t/(1 +
/// t²).
void takeRelaxation(TirFile& file, float radius, TireDef& tire) {
    const auto size = file.number({"PTY1", "1", 0, 1e3, ""}), place = file.number({"PTY2", "1", 1e-3, 1e3, ""});
    if (!size || !place || !(*size > 0)) return;
    const float t = 1 / *place;
    tire.relaxationLength = std::max(*size * 2 * t / (1 + t * t) * radius, 1e-3f);
}

}  // namespace

TireFile loadTire(const std::filesystem::path& path) {
    TirFile file(path);
    requireFormat(file);
    TireFile read;
    read.tire.magicFormula = coefficientsOf(file);
    takeRelaxation(file, read.tire.magicFormula->values[magicIndex("UNLOADED_RADIUS")], read.tire);
    read.tire.radialStiffness = file.number({"VERTICAL_STIFFNESS", "N/m", 1, 1e12, ""});
    if (const auto rolling = file.number({"QSY1", "1", 0, 1, ""})) read.tire.rollingResistance = *rolling;
    file.throwIfAny();
    read.leftOut = file.unused();
    return read;
}

}  // namespace ragtop
