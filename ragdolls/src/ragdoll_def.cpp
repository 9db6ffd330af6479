#include <cmath>
#include <cstdio>
#include <type_traits>
#include <vector>

#include "ragtop/body.h"
#include "ragtop/ragdoll.h"

namespace ragtop {
namespace {

/// Collects the first field outside of its range.
struct RangeCheck {
    std::string problem{};

    template <class Field>
    void operator()(const Tunable& tunable, const Field& field) {
        if constexpr (std::is_same_v<Field, float>) {
            if (!problem.empty() || (field >= tunable.minimum && field <= tunable.maximum)) return;
            char text[160];
            std::snprintf(text, sizeof text, " is %g %.*s, must be in [%g, %g]", static_cast<double>(field),
                          static_cast<int>(tunable.unit.size()), tunable.unit.data(), tunable.minimum, tunable.maximum);
            problem = std::string(tunable.name) + text;
        }
    }
};

template <class T>
std::string checked(const T& value) {
    RangeCheck check;
    describe(check, value, static_cast<const T*>(nullptr));
    return check.problem;
}

bool isRotation(const Quat& q) {
    const float norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    return isFinite(q) && norm > 0.99f && norm < 1.01f;
}

std::string whyInvalidPart(const RagdollPart& part, std::size_t boneCount) {
    if (std::string problem = checked(part); !problem.empty()) return problem;
    if (std::string problem = whyInvalid(part.material); !problem.empty()) return "material." + problem;
    if (!std::holds_alternative<Capsule>(part.shape) && !std::holds_alternative<Box>(part.shape) &&
        !std::holds_alternative<Sphere>(part.shape) && !std::holds_alternative<ConvexHull>(part.shape))
        return "shape is of another kind, must be a capsule, box, sphere or hull";
    if (std::string problem = whyInvalid(part.shape); !problem.empty()) return "shape." + problem;
    if (part.bone < 0 || static_cast<std::size_t>(part.bone) >= boneCount)
        return "bone is " + std::to_string(part.bone) + ", must be an index of bones";
    for (const Frame& frame : {part.bind, part.frame})
        if (!isFinite(frame.position) || !isRotation(frame.rotation))
            return "has a frame that is not finite or whose rotation has not length 1";
    return {};
}

std::string whyInvalidJoint(const RagdollJoint& joint, const std::vector<bool>& carried) {
    const int count = static_cast<int>(carried.size());
    if (joint.parent < 0 || joint.child >= count || joint.parent >= joint.child)
        return "joins parts " + std::to_string(joint.parent) + " and " + std::to_string(joint.child) +
               ", must join a part to a later one of " + std::to_string(count);
    if (carried[static_cast<std::size_t>(joint.child)])
        return "carries part " + std::to_string(joint.child) + ", which another joint carries already";
    JointDef complete = joint.joint;
    // Any two bodies will do: those of the parts exist only in a world.
    std::visit(
        [](auto& def) {
            def.bodies.a = {0, 1};
            def.bodies.b = {1, 1};
        },
        complete);
    return whyInvalid(complete);
}

}  // namespace

std::string whyInvalid(const RagdollOptions& options) {
    if (std::string problem = checked(options); !problem.empty()) return problem;
    if (std::string problem = whyInvalid(options.material); !problem.empty()) return "material." + problem;
    return {};
}

std::string whyInvalid(const RagdollDef& def) {
    if (def.parts.empty()) return "parts is empty, must have at least one";
    for (std::size_t i = 0; i < def.parts.size(); ++i)
        if (const std::string problem = whyInvalidPart(def.parts[i], def.bones.size()); !problem.empty())
            return "parts[" + std::to_string(i) + "] (" + def.parts[i].name + ")." + problem;
    std::vector<bool> carried(def.parts.size(), false);
    for (std::size_t i = 0; i < def.joints.size(); ++i) {
        if (const std::string problem = whyInvalidJoint(def.joints[i], carried); !problem.empty())
            return "joints[" + std::to_string(i) + "]." + problem;
        carried[static_cast<std::size_t>(def.joints[i].child)] = true;
    }
    for (std::size_t i = 0; i < def.bones.size(); ++i) {
        const RagdollBone& bone = def.bones[i];
        const std::string name = "bones[" + std::to_string(i) + "] (" + bone.name + ").";
        if (bone.part < 0 || static_cast<std::size_t>(bone.part) >= def.parts.size())
            return name + "part is " + std::to_string(bone.part) + ", must be an index of parts";
        if (bone.parent < -1 || bone.parent >= static_cast<int>(i))
            return name + "parent is " + std::to_string(bone.parent) + ", must be an earlier bone or -1";
        if (!isFinite(bone.inPart.position) || !isRotation(bone.inPart.rotation))
            return name + "inPart is not finite or its rotation has not length 1";
    }
    return {};
}

}  // namespace ragtop
