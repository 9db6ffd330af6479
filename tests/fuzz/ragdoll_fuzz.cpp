#include "fuzz_file.h"
#include "ragtop/ragdoll_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
    try {
        ragtop::loadRagdoll(ragtop::fuzzFile("fuzz.ragdoll.json", bytes, count));
    } catch (const ragtop::AssetError&) {
    }
    return 0;
}
