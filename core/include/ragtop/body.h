#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ragtop/id.h"
#include "ragtop/math.h"
#include "ragtop/shape.h"
#include "ragtop/tunables.h"

namespace ragtop {

enum class BodyType : std::uint8_t {
    fixed,      ///< never moves
    kinematic,  ///< moves by its velocity; pushes and is not pushed
    dynamic,    ///< moves by forces and impulses
};

/// A shape on a body.
struct ShapeDef {
    Shape geometry{};
    Frame frame{};              ///< of the shape in the body
    float density = 1000.0f;  ///< kg/m³
    Material material{};
    Filter filter{};
    bool sensor = false;         ///< reports overlaps and has no contacts
    bool reportsMotion = false;  ///< emits impact, slide and roll events (sound, skid marks)
    /// Gives way along y of its frame, as a wheel whose axle is x on its strut: contacts that are 6 degrees and more below
    /// its middle, seen from there, are left to who moves it with World::setFrame, but for pushes along x.
    bool givesWay = false;
    std::uint64_t userData = 0;  ///< the caller's
};

/// Movements that a body does not make, in world axes. A game in the x-y plane locks translation along z and rotation
/// about x and y.
struct AxisLocks {
    bool translationX = false, translationY = false, translationZ = false;
    bool rotationX = false, rotationY = false, rotationZ = false;
    bool operator==(const AxisLocks&) const = default;
};

/// Everything a body is made from.
struct BodyDef {
    BodyType type = BodyType::dynamic;
    std::vector<ShapeDef> shapes{};
    Pose pose{};
    Vec3 linearVelocity{};          ///< m/s, of the centre of mass
    Vec3 angularVelocity{};         ///< rad/s, world axes
    float linearDamping = 0.0f;   ///< 1/s
    float angularDamping = 0.0f;  ///< 1/s
    float gravityScale = 1.0f;
    AxisLocks locks{};
    bool continuous = true;     ///< does not pass through fixed shapes at any speed
    bool bullet = false;        ///< nor through moving ones
    bool allowSleep = true;
    std::optional<MassProperties> mass{};  ///< in the body's frame; empty: from shapes and densities
    std::uint64_t userData = 0;
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const BodyDef*) {
    visit(Tunable{"linearVelocity", "m/s", -1e5, 1e5, "velocity of the centre of mass"}, self.linearVelocity);
    visit(Tunable{"angularVelocity", "rad/s", -1e5, 1e5, "in world axes"}, self.angularVelocity);
    visit(Tunable{"linearDamping", "1/s", 0, 1000, "rate at which velocity decays"}, self.linearDamping);
    visit(Tunable{"angularDamping", "1/s", 0, 1000, "rate at which rotation decays"}, self.angularDamping);
    visit(Tunable{"gravityScale", "1", -100, 100, "share of the world's gravity"}, self.gravityScale);
    visit(Tunable{"continuous", "", 0, 1, "does not pass through static shapes at any speed"}, self.continuous);
    visit(Tunable{"bullet", "", 0, 1, "does not pass through moving shapes either"}, self.bullet);
    visit(Tunable{"allowSleep", "", 0, 1, "may come to rest and cost nothing"}, self.allowSleep);
}

/// A body of one shape that never moves.
struct StaticBody {
    Shape shape{};
    DVec3 position{};
    Quat rotation{};
    Material material{};
    Filter filter{};
    std::uint64_t userData = 0;
};

/// A body of one shape that moves by forces.
struct DynamicBody {
    Shape shape{};
    float density = 1000.0f;  ///< kg/m³
    DVec3 position{};
    Quat rotation{};
    Vec3 linearVelocity{};   ///< m/s
    Vec3 angularVelocity{};  ///< rad/s
    Material material{};
    Filter filter{};
    std::uint64_t userData = 0;
};

/// Empty when the definition is usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const BodyDef& def);
std::string whyInvalid(const Material& material);

}  // namespace ragtop
