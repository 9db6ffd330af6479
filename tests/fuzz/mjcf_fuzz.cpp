#include "fuzz_file.h"
#include "ragtop/asset_error.h"
#include "robot_document.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
    try {
        // Without the process of its own that robots are read in otherwise.
        ragtop::readRobot(ragtop::fuzzFile("fuzz.xml", bytes, count));
    } catch (const ragtop::AssetError&) {
    }
    return 0;
}
