#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "base/aligned_array.h"
#include "direct/tree_layout.h"
#include "scenes.h"

/// Trees of joints without a world: random bodies whose joints have small gaps, side by side in groups of lanes.
namespace ragtop::test {

class TreeRig {
public:
    /// Joints of `topology` with a little of everything: offsets, spins, gaps. `spread` is the largest mass ratio.
    TreeRig(const direct::TreeKernels& kernels, std::vector<direct::TreeLink> topology, int trees, float spread = 4)
        : kernels_(kernels),
          links_(std::move(topology)),
          trees_(trees),
          states_(std::pmr::get_default_resource()),
          inertias_(std::pmr::get_default_resource()),
          dynamics_(std::pmr::get_default_resource()),
          histories_(std::pmr::get_default_resource()),
          rows_(std::pmr::get_default_resource()),
          impulses_(std::pmr::get_default_resource()),
          memory_(std::pmr::get_default_resource()) {
        const std::size_t bodies = 1 + 2 * links_.size() * static_cast<std::size_t>(trees);
        states_.resize(bodies, {});
        inertias_.resize(bodies, {});
        dynamics_.resize(bodies, {});
        histories_.resize(bodies, {});
        rows_.resize(paddedRows(), {});
        impulses_.resize(paddedRows(), {});
        memory_.resize(static_cast<std::size_t>(groupCount()) * links_.size() * kernels_.linkBytes, std::byte{0});
        index_.assign(paddedRows(), 0);
        anchors_.assign(static_cast<std::size_t>(groupCount() * kernels_.lanes), 0);
        for (int tree = 0; tree < trees; ++tree) fill(tree, spread);
        start_.assign(states_.begin(), states_.end());
        for (int g = 0; g < groupCount(); ++g) groups_.push_back(group(g));
    }

    int groupCount() const { return (trees_ + kernels_.lanes - 1) / kernels_.lanes; }
    int linkCount() const { return static_cast<int>(links_.size()); }
    BodyArrays arrays() { return {states_.data(), inertias_.data(), dynamics_.data(), histories_.data()}; }
    void begin() {
        for (direct::TreeGroup& g : groups_) kernels_.begin(g, arrays());
    }
    void solve(const direct::TreeSubstep& substep) {
        for (direct::TreeGroup& g : groups_) kernels_.solve(g, arrays(), substep);
    }
    void factor() {
        for (direct::TreeGroup& g : groups_) kernels_.factor(g);
    }
    void relax(const direct::TreeSubstep& substep) {
        for (direct::TreeGroup& g : groups_) kernels_.relax(g, arrays(), substep);
    }
    /// Makes the present the beginning.
    void keep() { start_.assign(states_.begin(), states_.end()); }
    /// Velocities as they were at the beginning.
    void reset() {
        for (std::size_t i = 0; i < start_.size(); ++i) states_[i] = start_[i];
    }
    std::uint32_t bodyOf(int tree, int link) const { return static_cast<std::uint32_t>(1 + tree * linkCount() + link); }
    BodyState& state(int tree, int link) { return states_[bodyOf(tree, link)]; }
    const BodyState& before(int tree, int link) const { return start_[bodyOf(tree, link)]; }
    BodyInertia& inertia(int tree, int link) { return inertias_[bodyOf(tree, link)]; }
    direct::TreeJointRow& joint(int tree, int link) { return rows_[at(tree, link)]; }
    const direct::TreeImpulse& impulse(int tree, int link) const { return impulses_[at(tree, link)]; }
    const direct::TreeGroup& groupOf(int tree) const {
        return groups_[static_cast<std::size_t>(tree / kernels_.lanes)];
    }
    const std::vector<direct::TreeLink>& links() const { return links_; }

private:
    std::size_t paddedRows() const { return static_cast<std::size_t>(groupCount() * kernels_.lanes) * links_.size(); }
    std::size_t at(int tree, int link) const {
        const int w = kernels_.lanes;
        return static_cast<std::size_t>((tree / w * linkCount() + link) * w + tree % w);
    }
    direct::TreeGroup group(int g) {
        const int w = kernels_.lanes;
        const std::size_t first = static_cast<std::size_t>(g * w) * links_.size();
        direct::TreeGroup to;
        to.links = links_.data();
        to.linkCount = linkCount();
        to.used = trees_ - g * w < w ? trees_ - g * w : w;
        for (int l = 0; l < to.linkCount; ++l)  // lanes without a tree repeat the first
            for (int i = to.used; i < w; ++i) {
                const std::size_t row = first + static_cast<std::size_t>(l * w);
                index_[row + static_cast<std::size_t>(i)] = index_[row];
                rows_[row + static_cast<std::size_t>(i)] = rows_[row];
            }
        to.anchors = anchors_.data() + g * w;
        to.states = index_.data() + first;
        to.joints = rows_.data() + first;
        to.impulses = impulses_.data() + first;
        to.memory = memory_.data() + static_cast<std::size_t>(g) * links_.size() * kernels_.linkBytes;
        return to;
    }
    void fill(int tree, float spread) {
        scenes::Dice dice(static_cast<std::uint64_t>(tree + 1));
        const auto vector = [&](float size) {
            return size * Vec3{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)};
        };
        for (int l = 0; l < linkCount(); ++l) {
            const std::uint32_t body = bodyOf(tree, l);
            const float mass = dice.between(1, spread);
            BodyState& s = states_[body];
            s.invMass = 1 / mass;
            s.v = vector(2);
            s.w = vector(5);
            s.dp = vector(0.01f);
            const Vec3 turn = vector(0.02f);
            s.dq = normalized(Quat{turn.x, turn.y, turn.z, 1});
            const Vec3 axis = normalized(vector(1));
            const float k = 40 / mass, c = 0.5f * k;  // E k − c a aᵀ: a thin body along a
            BodyInertia& i = inertias_[body];
            i.xx = k + c * axis.x * axis.x, i.xy = c * axis.x * axis.y, i.xz = c * axis.x * axis.z;
            i.yy = k + c * axis.y * axis.y, i.yz = c * axis.y * axis.z, i.zz = k + c * axis.z * axis.z;
            index_[at(tree, l)] = body;
            direct::TreeJointRow& row = rows_[at(tree, l)];
            const auto put = [](float* to, const Vec3& v) { to[0] = v.x, to[1] = v.y, to[2] = v.z; };
            const Vec3 anchorC = vector(0.3f), anchorP = vector(0.3f);
            put(row.anchorC, anchorC);
            put(row.anchorP, anchorP);
            put(row.offset, anchorP - anchorC + vector(0.002f));
            const Vec3 a = vector(0.7f), b = vector(0.005f);
            const Quat q = normalized(Quat{a.x, a.y, a.z, 1}), p = normalized(Quat{b.x, b.y, b.z, 1} * q);
            const float frames[2][4] = {{q.x, q.y, q.z, q.w}, {p.x, p.y, p.z, p.w}};
            for (int k4 = 0; k4 < 4; ++k4) row.frameC[k4] = frames[0][k4], row.frameP[k4] = frames[1][k4];
        }
    }

    const direct::TreeKernels& kernels_;
    std::vector<direct::TreeLink> links_;
    int trees_;
    AlignedArray<BodyState> states_;
    AlignedArray<BodyInertia> inertias_;
    AlignedArray<BodyDynamics> dynamics_;
    AlignedArray<BodyHistory> histories_;
    AlignedArray<direct::TreeJointRow> rows_;
    AlignedArray<direct::TreeImpulse> impulses_;
    AlignedArray<std::byte> memory_;
    std::vector<std::uint32_t> index_, anchors_;
    std::vector<BodyState> start_;
    std::vector<direct::TreeGroup> groups_;
};

inline std::vector<direct::TreeLink> limbed(std::vector<direct::TreeLink> links) {
    direct::markBallChains(links.data(), links.size());
    return links;
}

/// A body from which `limbs` limbs of balls grow, each of `length` links: 16 joints for 4 × 4.
inline std::vector<direct::TreeLink> figure(int limbs, int length) {
    std::vector<direct::TreeLink> links(1);
    for (int i = 0; i < limbs; ++i)
        for (int k = 0; k < length; ++k) {
            const int parent = k == 0 ? 0 : static_cast<int>(links.size()) - 1;
            links.push_back({parent, direct::TreeJoint::ball, 1, {0, 0}});
        }
    return links;
}

}  // namespace ragtop::test
