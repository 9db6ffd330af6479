#include <fmt/format.h>

#include <variant>

#include "ragtop/character.h"
#include "ragtop/joint.h"

namespace ragtop {
namespace {

constexpr float kDegrees = 180.0f / kPi;

std::string describeShape(const Shape& shape) {
    if (const auto* capsule = std::get_if<Capsule>(&shape))
        return fmt::format("capsule r {:.3f} m, l {:.3f} m", capsule->radius, 2 * capsule->halfHeight);
    if (const auto* box = std::get_if<Box>(&shape))
        return fmt::format("box {:.3f} x {:.3f} x {:.3f} m", 2 * box->halfExtents.x, 2 * box->halfExtents.y,
                           2 * box->halfExtents.z);
    if (const auto* sphere = std::get_if<Sphere>(&shape)) return fmt::format("sphere r {:.3f} m", sphere->radius);
    if (const auto* hull = std::get_if<ConvexHull>(&shape))
        return fmt::format("hull of {} points", hull->vertices().size());
    return "shape";
}

std::string describeRange(const std::optional<Range>& range) {
    if (!range) return "free";
    return fmt::format("{:.0f} to {:.0f} deg", range->lower * kDegrees, range->upper * kDegrees);
}

std::string describeJoint(const JointDef& joint) {
    if (const auto* ball = std::get_if<BallDef>(&joint))
        return fmt::format("ball, swing {}, twist {}, friction {:.2f} N m",
                           ball->swingLimit ? fmt::format("{:.0f} deg", *ball->swingLimit * kDegrees) : "free",
                           describeRange(ball->twistLimit), ball->friction);
    if (const auto* hinge = std::get_if<HingeDef>(&joint))
        return fmt::format("hinge {}, friction {:.2f} N m", describeRange(hinge->limit), hinge->friction);
    return "joint";
}

/// The plan, and of the parts how sure they are.
std::string describeBody(const Anatomy& anatomy, const Skeleton& skeleton) {
    if (anatomy.plan == BodyPlan::other) return "  body      of no plan that is known\n";
    std::string text = fmt::format("  body      {}, {:.0f} % sure\n", nameOf(anatomy.plan), 100 * anatomy.confidence);
    for (const Segment& segment : anatomy.segments)
        text += fmt::format("    {:<24} {:<6} {:<9} {:3.0f} % sure\n",
                            skeleton.bones[static_cast<std::size_t>(segment.bone)].name,
                            segment.side == BodySide::middle ? "" : nameOf(segment.side), nameOf(segment.role),
                            100 * segment.confidence);
    return text;
}

const char* axisName(UpAxis axis) { return axis == UpAxis::x ? "x" : axis == UpAxis::y ? "y" : "z"; }

}  // namespace

std::string describeAsset(const Character& character) {
    std::string text =
        fmt::format("{}\n  format    {}\n  units     {:g} m per unit\n  up axis   {} in the file\n", character.file,
                    character.format, character.metersPerUnit, axisName(character.upAxis));
    const SkinInfo& skin = character.skin;
    text += fmt::format(
        "  height    {:.3f} m\n  bones     {} ({} left out)\n"
        "  skin      {} vertices, {} triangles in {} meshes, at most {} bones each\n  clips     {}\n",
        character.height, character.skeleton.bones.size(), character.droppedBones.size(), skin.vertices, skin.triangles,
        skin.meshes, skin.influences, character.clips.size());
    if (!character.springs.chains.empty())
        text += fmt::format("  springs   {} bones, {} colliders\n", character.springs.chains.size(),
                            character.springs.colliders.size());
    text += describeBody(recognise(character.skeleton), character.skeleton);
    for (const std::string& warning : character.warnings) text += "  warning   " + warning + "\n";
    return text;
}

std::string describeAsset(const RagdollDef& ragdoll) {
    double mass = 0;
    for (const RagdollPart& part : ragdoll.parts) mass += static_cast<double>(part.mass);
    std::string text =
        fmt::format("  ragdoll   {} parts, {} joints, {:.3f} kg\n", ragdoll.parts.size(), ragdoll.joints.size(), mass);
    for (const RagdollPart& part : ragdoll.parts)
        text += fmt::format("    {:<24} {:<6} {:<9} {:7.3f} kg  {}\n", part.name,
                            part.side == BodySide::middle ? "" : nameOf(part.side), nameOf(part.role), part.mass,
                            describeShape(part.shape));
    for (const RagdollJoint& joint : ragdoll.joints)
        text += fmt::format("    {:<24} {}\n", ragdoll.parts[static_cast<std::size_t>(joint.child)].name,
                            describeJoint(joint.joint));
    if (!ragdoll.note.empty()) text += "  note      " + ragdoll.note + "\n";
    return text;
}

}  // namespace ragtop
