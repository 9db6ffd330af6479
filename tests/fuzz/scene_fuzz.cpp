#include <string_view>

#include "fuzz_file.h"
#include "ragtop/scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
    // Models of packages are imported in processes of their own, of which there would be thousands.
    const std::string_view text(reinterpret_cast<const char*>(bytes), count);
    if (text.find("testmodels") != std::string_view::npos) return 0;
    try {
        ragtop::loadScene(ragtop::fuzzFile("fuzz.json", bytes, count));
    } catch (const ragtop::AssetError&) {
    }
    return 0;
}
