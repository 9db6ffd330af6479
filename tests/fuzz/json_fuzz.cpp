#include <cstdint>
#include <string>
#include <string_view>

#include "json_document.h"
#include "ragtop/asset_error.h"

namespace {

/// Each value has a place and can be told, as in a complaint about it.
void tellAll(const ragtop::JsonDocument& document, const ragtop::Json& value, const std::string& pointer) {
    document.complaint(pointer, "is " + ragtop::shown(value));
    if (value.is_object())
        for (const auto& item : value.items())
            tellAll(document, item.value(), pointer + ragtop::pointerStep(item.key()));
    if (value.is_array())
        for (std::size_t i = 0; i < value.size(); ++i) tellAll(document, value[i], pointer + "/" + std::to_string(i));
}

}  // namespace

/// What all JSON files go through before anything is made of them: text, places, `extends` and overrides.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
    const std::string_view text(reinterpret_cast<const char*>(bytes), count);
    // What comes before the first line that says so extends what comes after it.
    constexpr std::string_view kBetween = "\n// extends\n";
    const std::size_t border = text.find(kBetween);
    try {
        ragtop::JsonDocument document = ragtop::JsonDocument::parse(text.substr(0, border), "fuzz.json");
        tellAll(document, document.root(), "");
        if (border != std::string_view::npos)
            document.layOver(ragtop::JsonDocument::parse(text.substr(border + kBetween.size()), "base.json"));
        tellAll(document, document.root(), "");
        document.set("bodies.0.name", "fuzz", "--set");
        tellAll(document, document.root(), "");
    } catch (const ragtop::AssetError&) {
    }
    return 0;
}
