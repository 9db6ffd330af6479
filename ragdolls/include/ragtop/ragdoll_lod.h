#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/ragdoll.h"
#include "ragtop/tunables.h"

/// Ragdolls that are far away, in less detail.
namespace ragtop {

/// How much of a ragdoll moves by itself.
enum class RagdollLevel : std::uint8_t {
    full,     ///< each part
    reduced,  ///< a few groups of parts, each of them stiff
    single,   ///< all parts as one body
    asleep,   ///< as that, taken out of the world with the velocity that it has
};

/// "full", "reduced", "single" or "asleep".
std::string_view nameOf(RagdollLevel level);

/// When a ragdoll has which level.
struct RagdollLodOptions {
    int groups = 6;         ///< of who is reduced
    float reduced = 0.15f;  ///< of the height of the screen, below which it is reduced
    float single = 0.06f;   ///< the same, one body
    float asleep = 0.01f;   ///< the same, out of the world
    float slack = 1.25f;    ///< times these, above which it is in more detail again
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RagdollLodOptions*) {
    visit(Tunable{"groups", "", 1, 128, "stiff groups of parts of who is reduced"}, self.groups);
    visit(Tunable{"reduced", "1", 0, 1e3, "height on the screen below which it is reduced"}, self.reduced);
    visit(Tunable{"single", "1", 0, 1e3, "height on the screen below which it is one body"}, self.single);
    visit(Tunable{"asleep", "1", 0, 1e3, "height on the screen below which it is out of the world"}, self.asleep);
    visit(Tunable{"slack", "1", 1, 10, "times these heights, above which it is in more detail again"}, self.slack);
}

/// Empty when the options are usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const RagdollLodOptions& options);

/// The group of each part when joints go stiff one after the other, until no more than `most` groups are left or no
/// joint: first those that move least, by the inertias I₁, I₂ about the joint of what it joins, as I₁ I₂/(I₁ + I₂).
std::vector<int> stiffGroups(const RagdollDef& def, int most);

/// Changes a ragdoll between levels as it moves. Parts that go stiff do so as in a plastic impact: where they are, with
/// the momentum and angular momentum that they had together, which takes what they moved against each other; parts that
/// come loose move as the group did. So momentum stays, energy never rises, and no bone moves at the change
/// (docs/adr/0086). Joints between groups, and those by which parts hold other bodies, are joints of the groups
/// meanwhile; muscles reach no joint of less than full detail, and the parts of a group do not meet each other.
///
/// World and ragdoll must outlive it and stay where they are; it is no part of a world's saved state. Changes allocate;
/// while a level lasts there is nothing to call.
class RagdollLod {
public:
    /// Of full detail. Throws std::invalid_argument on bad options.
    RagdollLod(World& world, const Ragdoll& ragdoll, const RagdollLodOptions& options = {});
    /// Back to full detail.
    ~RagdollLod();
    RagdollLod(const RagdollLod&) = delete;
    RagdollLod& operator=(const RagdollLod&) = delete;

    void setLevel(RagdollLevel level);
    /// By its height on the screen over that of the screen; 0 where it is not seen.
    void setHeightOnScreen(float share);
    RagdollLevel level() const { return level_; }

    /// The bodies that move now: those of the ragdoll, or one for each group.
    std::span<const BodyId> bodies() const { return bodies_; }
    /// Where the parts are in the world now, at any level.
    Pose partPose(int part) const;
    /// Where each bone is in the world now, into memory of the caller, one entry per bone; more are left alone.
    void pose(std::span<Pose> into) const;

private:
    struct Part;
    struct Motion;

    Motion motionOf(std::size_t part) const;
    void regroup(const std::vector<int>& groups);
    void makeGroup(const std::vector<std::size_t>& members, const std::vector<Motion>& motions);
    void joinGroups();
    void dissolve();

    World* world_;
    const Ragdoll* ragdoll_;
    RagdollLodOptions options_;
    RagdollLevel level_ = RagdollLevel::full;
    std::vector<int> reduced_;  ///< group of each part of who is reduced
    std::vector<Part> parts_;
    std::vector<BodyId> bodies_;   ///< by group
    std::vector<BodyId> merged_;   ///< those of them that are no part's own
    std::vector<JointId> joints_;  ///< in place of those of parts that are in a group
};

}  // namespace ragtop
