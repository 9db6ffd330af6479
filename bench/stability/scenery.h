#pragma once

#include "../../tests/core/scenes.h"
#include "ragtop/scene.h"

/// Words for writing test scenes. A scene is the assets' plain description of bodies and joints, which every adapter
/// reads; of its settings only gravity counts.
namespace ragtop::stability {

using scenes::Dice;

inline constexpr double kGravity = 9.81;  ///< m/s², the default of WorldSettings

Material surface(float friction, float restitution = 0);

/// Appends a body and returns its index.
int add(Scene& scene, BodyDef def);
BodyDef fixedBody(Shape shape, const DVec3& position, const Material& material);
/// A body of uniform density with this mass, kg.
BodyDef solidBody(Shape shape, const DVec3& position, float mass, const Material& material);
/// A body with the mass and the principal moments (kg m², along its axes) given, whatever its shape.
BodyDef bodyWithMass(Shape shape, const DVec3& position, float mass, const Vec3& moments, const Material& material);
/// A slab whose top is the plane y = height.
int addFloor(Scene& scene, const Material& material, const DVec3& at = {});

/// An inclined plane through a point: y is its normal, and the fall line of angle theta has the heading given, from x
/// towards z. Its x and z axes are the world's, turned the short way.
struct Slope {
    double theta = 0, heading = 0;  ///< rad
    DVec3 at{};

    Pose pose() const;
    DVec3 down() const;  ///< of unit length, along the fall line
};
/// A slab of 200 m × 200 m with this plane as its top.
int addSlope(Scene& scene, const Slope& slope, const Material& material);
/// The same body with its pose seen from a slope.
BodyDef onSlope(const Slope& slope, BodyDef def);

/// A point and axis in the world that two bodies share (kWorld: the world), as both see it.
inline constexpr int kWorld = -1;
JointBodies jointFrames(const Scene& scene, int a, int b, const DVec3& point, const Vec3& axis = {1, 0, 0});
void addBall(Scene& scene, int a, int b, const DVec3& point);
HingeDef& addHinge(Scene& scene, int a, int b, const DVec3& point, const Vec3& axis);
SliderDef& addSlider(Scene& scene, int a, int b, const DVec3& point, const Vec3& axis);
/// A distance joint between two points of the world.
DistanceDef& addDistance(Scene& scene, int a, int b, const DVec3& pointA, const DVec3& pointB);

/// Mass, centre of mass and inertia in the body's frame.
MassProperties massOf(const BodyDef& def);

/// Up to so many metres aside along x and z.
DVec3 jitter(Dice& dice, float largest);

}  // namespace ragtop::stability
