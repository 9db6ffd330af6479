#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gltf/physics_document.h"
#include "gltf/springs.h"
#include "json_document.h"
#include "ragtop/asset_error.h"

namespace {

/// A tetrahedron for every mesh: vertices are read by the library.
std::vector<ragtop::Vec3> anyMesh(int) { return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }

template <class Read>
void refused(Read read) {
    try {
        read();
    } catch (const ragtop::AssetError&) {
    }
}

}  // namespace

/// The extensions that are read by Ragtop itself: KHR_physics_rigid_bodies with KHR_implicit_shapes, VRMC_springBone.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
    refused([&] {
        const std::string_view text(reinterpret_cast<const char*>(bytes), count);
        const ragtop::JsonDocument gltf = ragtop::JsonDocument::parse(text, "fuzz.gltf");
        ragtop::hasGltfPhysics(gltf);
        refused([&] { ragtop::readGltfRagdoll(gltf, anyMesh); });
        refused([&] { ragtop::readGltfSprings(gltf); });
    });
    return 0;
}
