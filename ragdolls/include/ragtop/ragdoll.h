#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/anatomy.h"
#include "ragtop/id.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "ragtop/shape.h"
#include "ragtop/skeleton.h"
#include "ragtop/tunables.h"

namespace ragtop {

class World;

/// How a ragdoll is made from a skeleton.
struct RagdollOptions {
    std::optional<float>
        bodyMass{};                 ///< kg, of all parts together; a human's is by its height, others' by their volume
    float bodyMassIndex = 24.49f;   ///< kg/m²: build of a human whose mass is not given; 75 kg at 1.75 m
    float femaleShare = 0.0f;       ///< blends the segment masses of men (0) and women (1)
    float jointFriction = 0.15f;    ///< friction torque over the weight beyond the joint times its part's reach
    float containedShare = 0.92f;   ///< of the skin vertices of a part that its shape encloses
    float limitScale = 1.0f;        ///< all ranges of motion, times this
    bool selfCollision = true;      ///< parts that do not overlap at rest collide with each other
    std::vector<BoneRole> roles{};  ///< what is known about bones; the others are recognised
    Material material{.friction = 0.8f};
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RagdollOptions*) {
    visit(Tunable{"bodyMass", "kg", 1e-3, 1e6, "mass of all parts together"}, self.bodyMass);
    visit(Tunable{"bodyMassIndex", "kg/m2", 8, 80, "build of a human whose mass is not given"}, self.bodyMassIndex);
    visit(Tunable{"femaleShare", "1", 0, 1, "blends the segment masses of men and women"}, self.femaleShare);
    visit(Tunable{"jointFriction", "1", 0, 10, "friction torque over the torque of the weight beyond the joint"},
          self.jointFriction);
    visit(Tunable{"containedShare", "1", 0.5, 1, "share of a part's skin that its shape encloses"},
          self.containedShare);
    visit(Tunable{"limitScale", "1", 0.05, 1.5, "scales all ranges of motion"}, self.limitScale);
    visit(Tunable{"selfCollision", "", 0, 1, "parts that do not overlap at rest collide"}, self.selfCollision);
    visit(Tunable{.name = "roles", .meaning = "what is known about bones; the others are recognised"}, self.roles);
    visit(Tunable{"material", "", 0, 0, "surface of all parts"}, self.material);
}

/// A rigid part of a ragdoll; its body has the pose of its bone.
struct RagdollPart {
    std::string name{};
    BodyRole role = BodyRole::other;
    BodySide side = BodySide::middle;
    int bone = -1;   ///< the bone it moves with
    Frame bind{};    ///< of that bone at rest, in model space
    Shape shape{};   ///< a capsule, a box or a hull
    Frame frame{};   ///< of the shape in the bone
    float mass = 1;  ///< kg
    Material material{};
};

/// Joins two parts. The bodies of `joint` are left null; its frames are in the bones of the parts, and at rest every
/// angle of it is within its limits, that of a hinge and the twist of a ball zero.
struct RagdollJoint {
    int parent = -1, child = -1;  ///< indices of parts
    JointDef joint{};
};

/// A bone of the skeleton and the part that carries it.
struct RagdollBone {
    std::string name{};
    int parent = -1;
    int part = -1;
    Frame inPart{};  ///< in the bone of the part
};

/// Two parts that pass through each other, as those that overlap at rest.
struct RagdollPair {
    int first = -1, second = -1;  ///< indices of parts
};

/// Everything a ragdoll is made from.
struct RagdollDef {
    std::vector<RagdollPart> parts{};  ///< parents before children; the first is the root
    std::vector<RagdollJoint> joints{};
    std::vector<RagdollBone> bones{};
    bool selfCollision = true;           ///< parts collide with each other but for those that are joined or ignored
    std::vector<RagdollPair> ignored{};  ///< beside those that are joined
    std::string note{};                  ///< what was guessed in making it
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RagdollPart*) {
    visit(Tunable{"mass", "kg", 1e-6, 1e9, "mass of the part"}, self.mass);
    visit(Tunable{"material", "", 0, 0, "its surface"}, self.material);
}

/// Fits capsules and boxes, masses, joints and limits to a skeleton; fingers, toes, twist bones and other small ones
/// join the part before them. A human gets 16 parts. Throws std::invalid_argument on a bad skeleton or option,
/// or where a part would be too small, large or light for a shape or a body.
RagdollDef makeRagdoll(const Skeleton& skeleton, const RagdollOptions& options = {});

/// Do two parts pass through each other?
bool ignoreEachOther(const RagdollDef& def, int first, int second);

/// Empty when the definition is usable; otherwise names the part or joint, its value and what is allowed.
std::string whyInvalid(const RagdollDef& def);
std::string whyInvalid(const RagdollOptions& options);

/// A joint that is where its limits do not let it be.
struct BeyondLimit {
    int joint = -1;  ///< of the definition
    float by = 0;    ///< rad or m
};

/// A ragdoll in a world: its bodies and joints live as long as it does. The world must outlive it and stay where
/// it is.
class Ragdoll {
public:
    /// At rest, with the origin of model space at `placement`, all moving at `velocity` (m/s). Throws
    /// std::invalid_argument on a bad definition.
    Ragdoll(World& world, const RagdollDef& def, const Pose& placement = {}, const Vec3& velocity = {});
    /// In the pose of an animation: one world pose per bone, all moving at `velocity`. Parts turn as their bones do,
    /// and are where their joints have them, also where the animation stretches a bone. What is beyond a limit begins
    /// there, is told by beyondLimits(), and is moved back without a gain of energy (docs/adr/0038).
    Ragdoll(World& world, const RagdollDef& def, std::span<const Pose> bones, const Vec3& velocity = {});
    /// Thrown out of an animation: in its pose of now, each part moving and turning as its bone did since the frame
    /// before, dt seconds ago. Throws std::invalid_argument also where dt is not above zero and finite.
    Ragdoll(World& world, const RagdollDef& def, std::span<const Pose> before, std::span<const Pose> now, double dt);
    ~Ragdoll();
    Ragdoll(Ragdoll&& other) noexcept;
    Ragdoll& operator=(Ragdoll&& other) noexcept;

    const RagdollDef& def() const { return def_; }
    /// Changes masses and surfaces of the parts and limits, friction, springs and motors of the joints while it moves.
    /// Parts, their shapes, joints and bones stay as many and where they are. Throws std::invalid_argument that says
    /// which field is wrong, and changes nothing then.
    void setDef(const RagdollDef& def);
    /// One per part.
    std::span<const BodyId> bodies() const { return bodies_; }
    /// One per joint of the definition.
    std::span<const JointId> joints() const { return joints_; }
    /// The body that carries a bone; null when there is no bone of that name.
    BodyId body(std::string_view bone) const;
    /// Joints that are beyond their limits by more than `tolerance` (rad or m) now.
    std::vector<BeyondLimit> beyondLimits(float tolerance = 1e-3f) const;

    /// Where the parts are in the world now, into memory of the caller, one entry per part; more are left alone.
    void partPoses(std::span<Pose> into) const;
    /// Where each bone is in the world now.
    std::vector<Pose> pose() const;
    /// The same into memory of the caller, one entry per bone; more are left alone.
    void pose(std::span<Pose> into) const;
    Pose pose(int bone) const;

private:
    struct PartMotion;
    std::vector<Pose> partsOf(std::span<const Pose> bones) const;
    void spawn(std::span<const PartMotion> parts);
    void ignore();
    void release();
    JointDef placed(const RagdollJoint& joint) const;

    World* world_;
    RagdollDef def_;
    std::vector<BodyId> bodies_;
    std::vector<JointId> joints_;
};

}  // namespace ragtop
