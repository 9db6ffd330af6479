#include "json_text.h"

#include <fmt/format.h>

#include <cmath>

namespace ragtop::demos {

std::string jsonNumber(double value) { return std::isfinite(value) ? fmt::format("{:.9g}", value) : "null"; }

std::string jsonString(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (static_cast<unsigned char>(c) < 0x20)
            out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
        else
            out += c;
    }
    return out + "\"";
}

}  // namespace ragtop::demos
