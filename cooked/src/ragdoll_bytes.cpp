#include "ragdoll_bytes.h"

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

#include "ragtop/shape_image.h"

namespace ragtop {
namespace {

template <class Enum>
Enum getEnum(FieldReader& from, Enum last) {
    const auto value = from.take<Enum>();
    if (value > last) throw std::invalid_argument("has a choice that there is not");
    return value;
}

void putShape(FieldWriter& to, const Shape& shape) {
    to.put(static_cast<std::uint8_t>(shape.index()));
    if (const auto* sphere = std::get_if<Sphere>(&shape)) {
        to.put(*sphere);
    } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
        to.put(*capsule);
    } else if (const auto* box = std::get_if<Box>(&shape)) {
        to.put(*box);
    } else if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
        const std::vector<std::byte> image = ShapeImage::of(*hull);
        to.put(static_cast<std::uint32_t>(image.size()));
        for (const std::byte byte : image) to.put(static_cast<std::uint8_t>(byte));
    } else {
        throw std::invalid_argument("a part is a mesh, height field or compound, must be convex");
    }
}

ConvexHull getHull(FieldReader& from) {
    const std::span<const std::byte> bytes = from.bytes(from.take<std::uint32_t>());
    const std::align_val_t alignment{ShapeImage::kAlignment};
    const auto free = [alignment](std::byte* at) { ::operator delete(at, alignment); };
    const std::unique_ptr<std::byte, decltype(free)> copy(
        static_cast<std::byte*>(::operator new(std::max<std::size_t>(bytes.size(), 1), alignment)), free);
    std::copy(bytes.begin(), bytes.end(), copy.get());
    return ShapeImage::hull({copy.get(), bytes.size()});
}

Shape getShape(FieldReader& from) {
    switch (from.take<std::uint8_t>()) {
        case 0:
            return from.take<Sphere>();
        case 1:
            return from.take<Capsule>();
        case 2:
            return from.take<Box>();
        case 3:
            return getHull(from);
        default:
            throw std::invalid_argument("has a kind of shape that ragdolls do not have");
    }
}

void putPart(FieldWriter& to, const RagdollPart& part) {
    to.put(part.name);
    to.put(part.role);
    to.put(part.side);
    to.put(part.bone);
    to.put(part.bind);
    to.put(part.frame);
    to.put(part);
    putShape(to, part.shape);
}

RagdollPart getPart(FieldReader& from) {
    RagdollPart part;
    from.get(part.name);
    part.role = getEnum(from, BodyRole::wing);
    part.side = getEnum(from, BodySide::right);
    from.get(part.bone);
    from.get(part.bind);
    from.get(part.frame);
    from.get(part);
    part.shape = getShape(from);
    return part;
}

/// Which bodies a joint joins is known by its parts.
template <class Archive, class Bodies, class Visit>
void forEachOf(Archive&, Bodies& bodies, Visit&& visit) {
    visit(bodies.frameA);
    visit(bodies.frameB);
    visit(bodies.collide);
    visit(bodies.breakForce);
    visit(bodies.breakTorque);
    visit(bodies.userData);
}

void putJoint(FieldWriter& to, const RagdollJoint& joint) {
    to.put(joint.parent);
    to.put(joint.child);
    to.put(static_cast<std::uint8_t>(joint.joint.index()));
    std::visit(
        [&](const auto& kind) {
            forEachOf(to, kind.bodies, [&](const auto& field) { to.put(field); });
            to.put(kind);
        },
        joint.joint);
}

template <std::size_t Kind = 0>
JointDef jointOfKind(std::size_t kind) {
    if constexpr (Kind < std::variant_size_v<JointDef>) {
        if (kind == Kind) return std::variant_alternative_t<Kind, JointDef>{};
        return jointOfKind<Kind + 1>(kind);
    } else {
        throw std::invalid_argument("has a kind of joint that there is not");
    }
}

RagdollJoint getJoint(FieldReader& from) {
    RagdollJoint joint;
    from.get(joint.parent);
    from.get(joint.child);
    joint.joint = jointOfKind(from.take<std::uint8_t>());
    std::visit(
        [&](auto& kind) {
            forEachOf(from, kind.bodies, [&](auto& field) { from.get(field); });
            from.get(kind);
        },
        joint.joint);
    return joint;
}

template <class All, class One>
void putList(FieldWriter& to, const All& all, One&& one) {
    to.put(static_cast<std::uint32_t>(all.size()));
    for (const auto& each : all) one(to, each);
}
template <class T, class One>
void getList(FieldReader& from, std::vector<T>& all, One&& one) {
    all.resize(from.count(1));
    for (T& each : all) each = one(from);
}

}  // namespace

void put(FieldWriter& to, const Skeleton& skeleton) {
    putList(to, skeleton.bones, [](FieldWriter& into, const Bone& bone) {
        into.put(bone.name);
        into.put(bone.parent);
        into.put(bone.bind);
    });
}

Skeleton getSkeleton(FieldReader& from) {
    Skeleton skeleton;
    getList(from, skeleton.bones, [](FieldReader& source) {
        Bone bone;
        source.get(bone.name);
        source.get(bone.parent);
        source.get(bone.bind);
        return bone;
    });
    return skeleton;
}

void put(FieldWriter& to, const Clip& clip) {
    to.put(clip.name);
    to.put(clip.seconds);
    putList(to, clip.tracks, [](FieldWriter& into, const ClipTrack& track) {
        into.put(track.bone);
        into.put(track.times);
        into.put(track.keys);
    });
}

Clip getClip(FieldReader& from) {
    Clip clip;
    from.get(clip.name);
    from.get(clip.seconds);
    getList(from, clip.tracks, [](FieldReader& source) {
        ClipTrack track;
        source.get(track.bone);
        source.get(track.times);
        source.get(track.keys);
        return track;
    });
    return clip;
}

void put(FieldWriter& to, const RagdollDef& ragdoll) {
    putList(to, ragdoll.parts, putPart);
    putList(to, ragdoll.joints, putJoint);
    putList(to, ragdoll.bones, [](FieldWriter& into, const RagdollBone& bone) {
        into.put(bone.name);
        into.put(bone.parent);
        into.put(bone.part);
        into.put(bone.inPart);
    });
    to.put(ragdoll.note);
}

RagdollDef getRagdoll(FieldReader& from) {
    RagdollDef ragdoll;
    getList(from, ragdoll.parts, getPart);
    getList(from, ragdoll.joints, getJoint);
    getList(from, ragdoll.bones, [](FieldReader& source) {
        RagdollBone bone;
        source.get(bone.name);
        source.get(bone.parent);
        source.get(bone.part);
        source.get(bone.inPart);
        return bone;
    });
    from.get(ragdoll.note);
    return ragdoll;
}

}  // namespace ragtop
