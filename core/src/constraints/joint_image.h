#pragma once

#include <cstddef>
#include <type_traits>

#include "constraints/joint_sim.h"

/// The memory of joints in lanes: bundles of N joints of equal structure, each a transposed copy of a part of JointSim,
/// N floats per field. It lasts for one step: loaded from the joints when it begins and stored into them when it ends.
namespace ragtop {

/// What all joints of a bundle have in common.
struct JointBundle {
    JointKind kind = JointKind::none;
    std::uint32_t features = 0;  ///< of AxisRows or BallRows
    SwingShape swing = SwingShape::free;
    std::uint32_t rebounds = 0;  ///< 1: stops with restitution
    std::uint32_t breakable = 0;
    std::uint32_t fields = 0;  ///< where its fields begin, in floats

    std::uint32_t key() const {
        return static_cast<std::uint32_t>(kind) | features << 8 | static_cast<std::uint32_t>(swing) << 16 |
               rebounds << 24 | breakable << 25;
    }
};

namespace joint_image {

inline constexpr std::size_t kFirst = offsetof(JointSim, centerOffset), kAxis = offsetof(JointSim, axis),
                             kBall = offsetof(JointSim, ball), kBallEnd = offsetof(JointSim, ball.swingLimit.corners);
static_assert(kAxis == offsetof(JointSim, block) + sizeof(RigidBlock) && kBall == kAxis + sizeof(AxisRows));

/// The field of a member at `offset` bytes: what all joints have, then the axis or, in its stead, the ball's rows.
constexpr int field(std::size_t offset) {
    return static_cast<int>((offset < kBall ? offset - kFirst : offset - kBall + kAxis - kFirst) / sizeof(float));
}
inline constexpr int kCommonFields = field(kAxis), kAxisFields = sizeof(AxisRows) / sizeof(float),
                     kBallFields = (kBallEnd - kBall) / sizeof(float);
constexpr int fieldCount(const JointBundle& bundle) {
    const bool axis = bundle.kind == JointKind::hinge || bundle.kind == JointKind::distance;
    return kCommonFields + (axis                                                     ? kAxisFields
                            : bundle.kind == JointKind::ball && bundle.features != 0 ? kBallFields
                                                                                     : 0);
}

}  // namespace joint_image

/// The field of a member of JointSim; a constant, so that kernels call nothing for it.
#define RAGTOP_JOINT_FIELD(member) \
    (::std::integral_constant<int, ::ragtop::joint_image::field(offsetof(::ragtop::JointSim, member))>::value)

/// Bundles with the memory and the joints that they are made of; `lanes` entries per bundle in the lists.
struct JointLanesView {
    const JointBundle* bundles = nullptr;
    const std::uint32_t* joints = nullptr;  ///< indices into sims; beyond the last one those of a blank joint
    const std::uint32_t* statesA = nullptr;
    const std::uint32_t* statesB = nullptr;
    float* fields = nullptr;
    JointSim* const* sims = nullptr;
    const JointSim* blank = nullptr;  ///< stands in lanes without a joint
};

/// Stands for no joint in a list.
inline constexpr std::uint32_t kNoJoint = 0xffffffffu;

}  // namespace ragtop
