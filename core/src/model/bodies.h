#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"
#include "model/records.h"
#include "solve/kernel_table.h"

namespace ragtop {

/// Where a body was when a step began.
struct StartPose {
    DVec3 center;
    Quat rotation;
};

/// The bodies of a world: a record of each, beside it what the solver streams through, in arrays of their own by the
/// same index, and the list of those that are awake. Body 0 is the world: fixed, without shapes, the other end of
/// joints to nowhere.
///
/// Between two calls all arrays are equally long, and `awake` holds each body that is awake once, at its awakeIndex.
/// Pointers to elements hold until a body is made.
class Bodies {
public:
    explicit Bodies(std::pmr::memory_resource* memory);
    void reserve(std::size_t count);

    /// A body with all values as they are declared, asleep; bodies that were released are used first.
    std::uint32_t acquire();
    /// Of a body that is asleep and has neither shapes nor constraints.
    void release(std::uint32_t body);

    std::size_t size() const { return records_.size(); }
    std::size_t bytes() const;
    /// Records that there is room for: none that is made before so many moves another one.
    std::size_t room() const { return records_.bytes() / sizeof(BodyRecord); }
    BodyRecord& operator[](std::size_t body) { return records_[body]; }
    const BodyRecord& operator[](std::size_t body) const { return records_[body]; }
    BodyRecord* begin() { return records_.begin(); }
    BodyRecord* end() { return records_.end(); }
    BodyArrays arrays() { return {states.data(), inertias.data(), dynamics.data(), histories.data()}; }

    BodyId id(std::uint32_t body) const { return {body, slots.generation(body)}; }
    bool isUsed(std::uint32_t body) const { return slots.isUsed(body); }
    /// Do forces and impulses move it?
    bool moves(std::uint32_t body) const { return records_[body].type == BodyType::dynamic && records_[body].mass > 0; }
    bool isEnabled(std::uint32_t body) const { return records_[body].options.heldBack == 0; }
    /// Also of a body that is disabled.
    BodyType typeOf(std::uint32_t body) const {
        const BodyRecord& record = records_[body];
        return record.options.heldBack == 0 ? record.type : static_cast<BodyType>(record.options.heldBack - 1);
    }
    bool isAwake(std::uint32_t body) const { return records_[body].awakeIndex != kNone; }
    /// Is its island solved directly?
    bool isDirect(std::uint32_t body) const { return records_[body].direct.steps > 0; }

    void addAwake(std::uint32_t body);
    void removeAwake(std::uint32_t body);

    /// Takes the movements that locks forbid out of a velocity that was given.
    void obeyLocks(std::uint32_t body);
    /// World inertia and momentum of a body that was turned, or given a velocity, from outside the solver.
    void refreshInertia(std::uint32_t body);
    /// The same of the inertia of a body whose turning locks restrict.
    void restrictInertia(std::uint32_t body);
    /// World inverse inertia of a body if it were turned so; what locks restrict stays as it is.
    BodyInertia inverseInertiaAt(std::uint32_t body, const Quat& rotation) const;
    /// Keeps the angular momentum that belongs to the velocity of now and to a rotation, or to that of now.
    void storeMomentum(std::uint32_t body, const Quat& rotation);
    void storeMomentum(std::uint32_t body) { storeMomentum(body, records_[body].rotation); }
    /// Gives a body that is turned the angular velocity that it had, as seen from the body, so that it keeps its
    /// energy.
    void turnVelocity(std::uint32_t body, const Quat& from, const Quat& to);
    /// No velocity, and none that was.
    void stop(std::uint32_t body);

    template <class Archive>
    void archive(Archive& archive) {
        slots.archive(archive);
        archive(records_);
        archive(states);
        archive(inertias);
        archive(dynamics);
        archive(histories);
        archive(userData);
        archive(awake);
    }

    Slots slots;
    AlignedArray<BodyState> states;
    AlignedArray<BodyInertia> inertias;
    AlignedArray<BodyDynamics> dynamics;
    AlignedArray<BodyHistory> histories;
    AlignedArray<std::uint64_t> userData;
    AlignedArray<std::uint32_t> awake;

private:
    AlignedArray<BodyRecord> records_;
};

/// Of a body's definition, in the world.
inline Pose poseOf(const BodyRecord& body) { return Pose{body.center, body.rotation} * inverse(body.local); }
/// The same, of its rotation.
inline Quat definitionRotation(const BodyRecord& body) { return body.rotation * conjugate(body.local.rotation); }

/// In the frame of the definition.
MassProperties massOf(const BodyRecord& body);
/// Mass, centre and principal axes.
void takeMass(BodyRecord& body, const MassProperties& mass);
/// Of a definition's shapes and their densities, without sensors.
MassProperties massOfShapes(const BodyDef& def);
/// Of a shape in the world.
inline Pose shapePose(const BodyRecord& body, const ShapeRecord& shape) {
    return Pose{body.center, body.rotation} * shape.frame;
}

}  // namespace ragtop
