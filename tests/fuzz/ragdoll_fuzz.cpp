#include <cstdint>
#include <string_view>

#include "described_file.h"
#include "ragtop/asset_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
    const std::string_view text(reinterpret_cast<const char*>(bytes), count);
    try {
        ragtop::readRagdoll(ragtop::JsonDocument::parse(text, "fuzz.ragdoll.json"));
    } catch (const ragtop::AssetError&) {
    }
    return 0;
}
