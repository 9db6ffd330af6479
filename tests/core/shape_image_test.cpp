#include "ragtop/shape_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <new>

#include "shapes/geometry.h"

namespace ragtop {
namespace {

TriangleMesh waves(std::uint32_t cells) {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    const std::uint32_t row = cells + 1;
    for (std::uint32_t i = 0; i < row * row; ++i) {
        const float x = static_cast<float>(i % row), z = static_cast<float>(i / row);
        vertices.push_back({x, std::sin(x + z), z});
    }
    for (std::uint32_t i = 0; i < cells; ++i)
        for (std::uint32_t at = i * row; at < i * row + cells; ++at) {
            triangles.push_back({at, at + row, at + 1});
            triangles.push_back({at + 1, at + row, at + row + 1});
        }
    return TriangleMesh(vertices, triangles);
}

/// What is said about the image of a mesh whose tree was changed; empty where it is read.
std::string complaintAbout(const TriangleMesh& mesh, const std::function<void(std::span<MeshBranch>)>& change) {
    std::vector<MeshBranch> branches(mesh.data().branches.begin(), mesh.data().branches.end());
    change(branches);
    const std::vector<std::byte> sound = ShapeImage::of(mesh);
    constexpr std::align_val_t kAlignment{ShapeImage::kAlignment};
    const std::unique_ptr<std::byte, void (*)(std::byte*)> image(
        static_cast<std::byte*>(::operator new(sound.size(), kAlignment)),
        [](std::byte* at) { ::operator delete(at, kAlignment); });
    std::copy(sound.begin(), sound.end(), image.get());
    std::uint64_t table = 0;
    std::memcpy(&table, sound.data() + 7 * 16, sizeof table);
    std::memcpy(image.get() + table, branches.data(), branches.size() * sizeof(MeshBranch));
    try {
        ShapeImage::mesh({image.get(), sound.size()}, nullptr);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return {};
}

/// A chain deeper than any that is built would end beyond the stack of a walk; branches that several lead to would be
/// walked again and again, 4ⁿ times in a chain of n.
TEST(ShapeImage, RefusesTreesThatNoWalkEndsIn) {
    const TriangleMesh mesh = waves(60);
    const std::string refused = "image of a shape has a branch of the tree out of range";
    EXPECT_EQ(complaintAbout(mesh, [](std::span<MeshBranch>) {}), "");
    const auto chain = [](std::span<MeshBranch> branches, int children) {
        for (std::uint32_t i = 0; i + 1 < branches.size(); ++i)
            for (int k = 0; k < MeshBranch::kWidth; ++k) {
                branches[i].first[k] = k < children ? i + 1 : 0;
                branches[i].count[k] = 0;
            }
    };
    ASSERT_GT(mesh.data().branches.size(), static_cast<std::size_t>(kMeshTreeDepth) + 1);
    for (const int children : {1, 2, 4})
        EXPECT_EQ(complaintAbout(mesh, [&](std::span<MeshBranch> branches) { chain(branches, children); }), refused);
}

TEST(ShapeImage, RefusesTreesOfOtherTrianglesThanThereAre) {
    const TriangleMesh mesh = waves(8);
    const auto firstLeaf = [](std::span<MeshBranch> branches) -> std::uint32_t& {
        for (MeshBranch& branch : branches)
            for (std::uint32_t& count : branch.count)
                if (count > 0) return count;
        throw std::logic_error("no leaf");
    };
    for (const int more : {-1, 1, 1'000'000})
        EXPECT_EQ(
            complaintAbout(
                mesh, [&](std::span<MeshBranch> branches) { firstLeaf(branches) += static_cast<std::uint32_t>(more); }),
            "image of a shape has a branch of the tree out of range");
}

}  // namespace
}  // namespace ragtop
