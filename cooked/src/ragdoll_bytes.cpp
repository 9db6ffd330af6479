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
        throw std::invalid_argument("a shape is a mesh, height field or compound, must be convex");
    }
}

ConvexHull getHull(FieldReader& from) {
    const std::span<const std::byte> bytes = from.bytes(from.take<std::uint32_t>());
    constexpr std::align_val_t alignment{ShapeImage::kAlignment};
    const auto free = [](std::byte* at) { ::operator delete(at, alignment); };
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
            throw std::invalid_argument("has a kind of shape that ragdolls and robots do not have");
    }
}

/// What is written of each struct, in its order. Which bodies a joint joins is known by its parts.
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const Bone*) {
    archive(self.name), archive(self.parent), archive(self.bind);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const Skeleton*) {
    archive(self.bones);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const ClipTrack*) {
    archive(self.bone), archive(self.times), archive(self.keys);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const Clip*) {
    archive(self.name), archive(self.seconds), archive(self.tracks);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const RagdollPart*) {
    archive(self.name), archive(self.role), archive(self.side), archive(self.bone), archive(self.bind);
    archive(self.frame), archive.described(self), archive(self.shape);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const JointBodies*) {
    archive(self.frameA), archive(self.frameB), archive(self.collide);
    archive(self.breakForce), archive(self.breakTorque), archive(self.userData);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const RagdollJoint*) {
    archive(self.parent), archive(self.child), archive(self.joint);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const RagdollBone*) {
    archive(self.name), archive(self.parent), archive(self.part), archive(self.inPart);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const RagdollPair*) {
    archive(self.first), archive(self.second);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const RagdollDef*) {
    archive(self.parts), archive(self.joints), archive(self.bones), archive(self.note);
    archive(self.selfCollision), archive(self.ignored);
}

template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const MassProperties*) {
    archive(self.mass), archive(self.center);
    archive(self.inertia.cx), archive(self.inertia.cy), archive(self.inertia.cz);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const ShapeDef*) {
    archive(self.geometry), archive(self.frame), archive(self.material);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const RobotBody*) {
    archive(self.name), archive(self.pose), archive(self.mass), archive(self.shapes), archive(self.anchored);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const RobotLink*) {
    archive(self.name), archive(self.body), archive(self.inBody);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const RobotJoint*) {
    archive(self.name), archive(self.parent), archive(self.child), archive(self.joint);
    archive(self.effort), archive(self.velocity), archive(self.home);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const RobotCoupling*) {
    archive(self.name), archive(self.joints), archive(self.follows), archive(self.coupling.count);
    for (auto& part : self.coupling.parts) archive(part.coordinate), archive(part.ratio);
    archive(self.coupling.sum);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const RobotKeyframe*) {
    archive(self.name), archive(self.coordinates);
}
template <class Archive, class Self>
void fieldsOf(Archive& archive, Self& self, const Robot*) {
    archive(self.name), archive(self.mass), archive(self.bodies), archive(self.links);
    archive(self.joints), archive(self.couplings), archive(self.keyframes);
}

template <class T>
concept HasFields = requires(T& self) {
    fieldsOf(std::declval<struct Nobody&>(), self, &std::as_const(self));
};

template <std::size_t Kind = 0>
JointDef jointOfKind(std::size_t kind) {
    if constexpr (Kind < std::variant_size_v<JointDef>) {
        if (kind == Kind) return std::variant_alternative_t<Kind, JointDef>{};
        return jointOfKind<Kind + 1>(kind);
    } else {
        throw std::invalid_argument("has a kind of joint that there is not");
    }
}

struct Putting {
    FieldWriter& to;

    template <class T>
    void operator()(const T& field) {
        if constexpr (HasFields<T>)
            fieldsOf(*this, field, &field);
        else
            to.put(field);
    }
    template <HasFields T>
    void operator()(const std::vector<T>& all) {
        to.put(static_cast<std::uint32_t>(all.size()));
        for (const T& each : all) (*this)(each);
    }
    void operator()(const Shape& shape) { putShape(to, shape); }
    void operator()(const JointDef& joint) {
        to.put(static_cast<std::uint8_t>(joint.index()));
        std::visit([&](const auto& kind) { (*this)(kind.bodies), described(kind); }, joint);
    }
    template <class T>
    void described(const T& self) {
        to.put(self);
    }
};

struct Getting {
    FieldReader& from;

    template <class T>
    void operator()(T& field) {
        if constexpr (HasFields<T>)
            fieldsOf(*this, field, &field);
        else
            from.get(field);
    }
    template <HasFields T>
    void operator()(std::vector<T>& all) {
        all.resize(from.count(1));
        for (T& each : all) (*this)(each);
    }
    void operator()(BodyRole& role) { role = getEnum(from, BodyRole::wing); }
    void operator()(BodySide& side) { side = getEnum(from, BodySide::right); }
    void operator()(Shape& shape) { shape = getShape(from); }
    void operator()(JointDef& joint) {
        joint = jointOfKind(from.take<std::uint8_t>());
        std::visit([&](auto& kind) { (*this)(kind.bodies), described(kind); }, joint);
    }
    template <class T>
    void described(T& self) {
        from.get(self);
    }
};

template <class T>
T getAll(FieldReader& from) {
    T all;
    Getting{from}(all);
    return all;
}

}  // namespace

void put(FieldWriter& to, const Skeleton& skeleton) { Putting{to}(skeleton); }
void put(FieldWriter& to, const Clip& clip) { Putting{to}(clip); }
void put(FieldWriter& to, const RagdollDef& ragdoll) { Putting{to}(ragdoll); }
void put(FieldWriter& to, const Robot& robot) { Putting{to}(robot); }
Skeleton getSkeleton(FieldReader& from) { return getAll<Skeleton>(from); }
Clip getClip(FieldReader& from) { return getAll<Clip>(from); }
RagdollDef getRagdoll(FieldReader& from) { return getAll<RagdollDef>(from); }
Robot getRobot(FieldReader& from) { return getAll<Robot>(from); }

}  // namespace ragtop
