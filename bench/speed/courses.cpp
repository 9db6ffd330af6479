#include "courses.h"

namespace ragtop::speed {
namespace {

template <int kThousands>
Course scaling() {
    return makeScaling(1000 * kThousands);
}

}  // namespace

std::span<const CourseKind> courseKinds() {
    static const std::vector<CourseKind> kinds{
        {"pyramid", {"pyramid"}, makePyramid},
        {"brick_house", {"brick_house_settle", "brick_house_smash"}, makeBrickHouse},
        {"ragdoll_pile", {"ragdoll_pile"}, makeRagdollPile},
        {"box_pile", {"box_pile"}, makeBoxPile},
        {"hull_pile", {"hull_pile"}, makeHullPile},
        {"mesh_drive", {"mesh_drive"}, makeMeshDrive},
        {"wrecking_chain", {"wrecking_chain"}, makeWreckingChain},
        {"chain_100to1", {"chain_100to1"}, makeChain100to1},
        {"many_pyramids", {"many_pyramids"}, makeManyPyramids},
        {"joint_grid", {"joint_grid"}, makeJointGrid},
        {"junkyard", {"junkyard"}, makeJunkyard},
        {"rain", {"rain"}, makeRain},
        {"sleepers", {"sleepers"}, makeSleepers},
        {"pyramid_offset", {"pyramid_offset"}, [] { return withOffsets(makePyramid(), "pyramid_offset"); }},
        {"pyramid_nudged", {"pyramid_nudged"}, [] { return withNudges(makePyramid(), "pyramid_nudged"); }},
        {"house_offset", {"house_offset"}, [] { return withOffsets(makeBrickHouse(), "house_offset"); }},
        {"house_nudged", {"house_nudged"}, [] { return withNudges(makeBrickHouse(), "house_nudged"); }},
        {"many_offset", {"many_offset"}, [] { return withOffsets(makeManyPyramids(), "many_offset"); }},
        {"many_nudged", {"many_nudged"}, [] { return withNudges(makeManyPyramids(), "many_nudged"); }},
        {"scaling_1k", {"scaling_1k"}, scaling<1>},
        {"scaling_2k", {"scaling_2k"}, scaling<2>},
        {"scaling_4k", {"scaling_4k"}, scaling<4>},
        {"scaling_8k", {"scaling_8k"}, scaling<8>},
        {"scaling_16k", {"scaling_16k"}, scaling<16>},
        {"scaling_32k", {"scaling_32k"}, scaling<32>},
        {"scaling_64k", {"scaling_64k"}, scaling<64>},
    };
    return kinds;
}

}  // namespace ragtop::speed
