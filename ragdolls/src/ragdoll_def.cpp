#include <vector>

#include "ragtop/body.h"
#include "ragtop/ragdoll.h"
#include "range_check.h"

namespace ragtop {
namespace {

std::string whyInvalidPart(const RagdollPart& part, std::size_t boneCount) {
    if (std::string problem = whyOutside(part); !problem.empty()) return problem;
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

bool ignoreEachOther(const RagdollDef& def, int first, int second) {
    const auto isIt = [&](int a, int b) { return (a == first && b == second) || (a == second && b == first); };
    if (!def.selfCollision) return true;
    for (const RagdollPair& pair : def.ignored)
        if (isIt(pair.first, pair.second)) return true;
    for (const RagdollJoint& joint : def.joints)
        if (isIt(joint.parent, joint.child))
            return !std::visit([](const auto& kind) { return kind.bodies.collide; }, joint.joint);
    return false;
}

std::string whyInvalid(const RagdollOptions& options) {
    if (std::string problem = whyOutside(options); !problem.empty()) return problem;
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
    const int count = static_cast<int>(def.parts.size());
    for (std::size_t i = 0; i < def.ignored.size(); ++i) {
        const RagdollPair& pair = def.ignored[i];
        if (pair.first < 0 || pair.second < 0 || pair.first >= count || pair.second >= count ||
            pair.first == pair.second)
            return "ignored[" + std::to_string(i) + "] has parts " + std::to_string(pair.first) + " and " +
                   std::to_string(pair.second) + ", must have two of " + std::to_string(count);
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
