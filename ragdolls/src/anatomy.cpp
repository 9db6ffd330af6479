#include "ragtop/anatomy.h"

#include <stdexcept>

#include "body_plan.h"
#include "segments.h"

namespace ragtop {
namespace {

KnownRoles knownRoles(const Skeleton& skeleton, std::span<const BoneRole> roles) {
    KnownRoles known;
    known.of.resize(skeleton.bones.size());
    for (std::size_t i = 0; i < roles.size(); ++i) {
        const int bone = skeleton.find(roles[i].bone);
        if (bone < 0)
            throw std::invalid_argument("roles[" + std::to_string(i) + "].bone is \"" + roles[i].bone +
                                        "\", must be the name of a bone of the skeleton");
        known.of[static_cast<std::size_t>(bone)] = roles[i];
        if (roles[i].role == BodyRole::head) known.head = bone;
    }
    return known;
}

/// Every role of the map was found, or the first that was not is told.
void checkRoles(const Skeleton& skeleton, std::span<const BoneRole> roles, const Anatomy& anatomy) {
    for (std::size_t i = 0; i < roles.size(); ++i) {
        const BoneRole& wanted = roles[i];
        bool found = wanted.role == BodyRole::other;
        for (const Segment& segment : anatomy.segments)
            found = found || (segment.role == wanted.role && segment.bone == skeleton.find(wanted.bone) &&
                              (wanted.side == BodySide::middle || wanted.side == segment.side));
        if (found) continue;
        const std::string side = wanted.side == BodySide::middle ? "" : std::string(nameOf(wanted.side)) + " ";
        throw std::invalid_argument("roles[" + std::to_string(i) + "]: bone \"" + wanted.bone + "\" cannot be the " +
                                    side + std::string(nameOf(wanted.role)) + " of " +
                                    (anatomy.plan == BodyPlan::other ? "a body without limbs that were found"
                                                                     : "this " + std::string(nameOf(anatomy.plan))));
    }
}

}  // namespace

int Anatomy::find(BodyRole role, BodySide side) const {
    for (std::size_t i = 0; i < segments.size(); ++i)
        if (segments[i].role == role && segments[i].side == side) return static_cast<int>(i);
    return -1;
}

Anatomy recognise(const Skeleton& skeleton, std::span<const BoneRole> roles) {
    if (const std::string problem = whyInvalid(skeleton); !problem.empty())
        throw std::invalid_argument("skeleton: " + problem);
    const KnownRoles known = knownRoles(skeleton, roles);
    const BoneTree tree(skeleton);
    const LimbSearch search(tree, known);
    const PlanChoice choice = choosePlan(tree, search, known);
    Anatomy anatomy;
    anatomy.plan = choice.plan;
    anatomy.confidence = choice.confidence;
    if (choice.plan == BodyPlan::other) {
        segmentOther(tree, anatomy);
        anatomy.note = "no known body: " + choice.missing;
    } else {
        orient(skeleton, tree, known, choice, anatomy);
        segmentBody(skeleton, tree, known, choice, anatomy);
        if (!choice.missing.empty()) anatomy.note += (anatomy.note.empty() ? "" : "; ") + choice.missing;
    }
    checkRoles(skeleton, roles, anatomy);
    return anatomy;
}

}  // namespace ragtop
