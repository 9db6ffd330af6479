#include "fuzz_file.h"
#include "ragtop/vehicle_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
    try {
        ragtop::loadVehicle(ragtop::fuzzFile("fuzz.car.json", bytes, count));
    } catch (const ragtop::AssetError&) {
    }
    return 0;
}
