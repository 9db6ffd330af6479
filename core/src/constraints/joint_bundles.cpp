// Sorts the joints of each colour by what rows they have, N of one structure to a bundle; what has no equal in its
// colour is solved alone. Made anew only after joints came, went or changed.

#include "constraints/joint_bundles.h"

#include <algorithm>

#include "constraints/joint_ball_stops.h"

namespace ragtop {
namespace {

JointBundle structureOf(const JointSim& joint) {
    JointBundle bundle;
    bundle.kind = joint.kind;
    bundle.breakable = joint.breakable;
    const bool isBall = joint.kind == JointKind::ball;
    if (isBall) {
        bundle.features = joint.ball.features;
        bundle.swing = joint.ball.swingLimit.shape;
    } else if (joint.kind != JointKind::fixed) {
        bundle.features = joint.axis.features;
    }
    const bool stops = isBall ? (bundle.features & (BallRows::kSwing | BallRows::kTwist)) != 0
                              : (bundle.features & AxisRows::kLimit) != 0;
    bundle.rebounds = stops && (isBall ? joint.ball.stop : joint.axis.stop).restitution > 0 ? 1 : 0;
    return bundle;
}

bool isSoft(const Stop& stop) { return stop.stiffness > 0; }

}  // namespace

bool isWide(const JointSim& joint) {
    switch (joint.kind) {
        case JointKind::ball:
            return (joint.ball.swingLimit.shape == SwingShape::free ||
                    joint.ball.swingLimit.shape == SwingShape::circle) &&
                   !isSoft(joint.ball.stop) && !(joint.ball.features & BallRows::kDrives) && !isHeld(joint.ball);
        case JointKind::hinge:
        case JointKind::distance:
            return !isSoft(joint.axis.stop) && !(joint.axis.features & AxisRows::kCoupled);
        case JointKind::fixed:
            return true;
        default:
            return false;
    }
}

std::uint64_t placeInBundles(const JointSim& joint) {
    return isWide(joint) ? 1 + std::uint64_t{structureOf(joint).key()} : 0;
}

JointBundles::JointBundles(int lanes, std::pmr::memory_resource* memory)
    : lanes_(static_cast<std::size_t>(lanes)),
      colors_(memory),
      bundles_(memory),
      joints_(memory),
      statesA_(memory),
      statesB_(memory),
      singles_(memory),
      sorted_(memory),
      fields_(memory) {}

void JointBundles::build(const ConstraintGraph& graph, JointSim* const* sims) {
    bundles_.clear();
    joints_.clear();
    statesA_.clear();
    statesB_.clear();
    singles_.clear();
    fields_.clear();
    colors_.clear();
    colors_.resize(static_cast<std::size_t>(graph.listCount()), {});
    for (int c = 0; c < graph.listCount(); ++c) {
        Color& color = colors_[static_cast<std::size_t>(c)];
        color.begin = static_cast<int>(bundles_.size());
        color.firstSingle = static_cast<int>(singles_.size());
        // Those share bodies, and are solved one after the other anyway.
        if (ConstraintGraph::isSerial(c))
            for (const std::uint32_t j : graph.color(c).joints) singles_.push(j);
        else if (ConstraintGraph::isIterated(c))
            addColor(graph.color(c), sims);
        color.end = static_cast<int>(bundles_.size());
        color.endSingle = static_cast<int>(singles_.size());
    }
}

/// Within a colour the order is free: by structure, then by index.
void JointBundles::addColor(const ConstraintGraph::Color& color, JointSim* const* sims) {
    sorted_.clear();
    for (const std::uint32_t j : color.joints) {
        if (isWide(*sims[j]))
            sorted_.push(std::uint64_t{structureOf(*sims[j]).key()} << 32 | j);
        else
            singles_.push(j);
    }
    std::sort(sorted_.begin(), sorted_.end());
    for (std::size_t first = 0, next = 0; first < sorted_.size(); first = next) {
        const std::uint64_t key = sorted_[first] >> 32;
        for (next = first; next < sorted_.size() && next - first < lanes_ && sorted_[next] >> 32 == key;) ++next;
        const auto joint = static_cast<std::uint32_t>(sorted_[first]);
        if (next - first == 1)
            singles_.push(joint);
        else
            addBundle(structureOf(*sims[joint]), sims, first, next - first);
    }
}

void JointBundles::addBundle(const JointBundle& structure, JointSim* const* sims, std::size_t first,
                             std::size_t count) {
    JointBundle bundle = structure;
    bundle.fields = static_cast<std::uint32_t>(fields_.size());
    for (std::size_t lane = 0; lane < lanes_; ++lane) {
        const bool used = lane < count;
        const std::uint32_t joint = used ? static_cast<std::uint32_t>(sorted_[first + lane]) : kNoJoint;
        joints_.push(joint);
        statesA_.push(used ? sims[joint]->stateA : 0);
        statesB_.push(used ? sims[joint]->stateB : 0);
    }
    bundles_.push(bundle);
    fields_.resize(fields_.size() + static_cast<std::size_t>(joint_image::fieldCount(bundle)) * lanes_, 0.0f);
}

JointLanesView JointBundles::view(JointSim* const* sims) {
    return {bundles_.data(), joints_.data(), statesA_.data(), statesB_.data(), fields_.data(), sims, &blank_};
}

std::size_t JointBundles::bytes() const {
    return bundles_.bytes() + joints_.bytes() + statesA_.bytes() + statesB_.bytes() + singles_.bytes() +
           sorted_.bytes() + fields_.bytes() + colors_.bytes();
}

}  // namespace ragtop
