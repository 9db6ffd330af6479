#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ragtop/id.h"
#include "ragtop/math.h"
#include "ragtop/shape.h"
#include "ragtop/tunables.h"

/// Capes, flags, skirts, nets and ropes: points that hang together and meet the shapes of a world. docs/cloth.md has the
/// model.
namespace ragtop {

class World;

/// Three or four points around a piece of cloth. Sides of faces resist stretch, diagonals of quads shear.
struct ClothFace {
    int a = 0, b = 0, c = 0;
    int d = -1;  ///< −1: a triangle
};

/// A piece of rope or seam between two points.
struct ClothLine {
    int a = 0, b = 0;
};

/// A point that goes where a body goes, and pulls at it.
struct ClothAttachment {
    int point = 0;
    BodyId body{};  ///< null: the point stays where it is made
    std::optional<Vec3> place{};  ///< m, in the body's frame; empty: where the point is when the cloth is made
};

/// How far a point may go from where an animation has it (Cloth::follow).
struct ClothSkin {
    float maxDistance = 1e6f;  ///< m; zero: it goes with the animation
    float backstop = 1e6f;     ///< m behind the animated surface, against its normal
};

/// Everything a cloth is made from. Stiffness and masses are those of the fabric, so that a finer mesh of the same cloth
/// moves alike.
struct ClothDef {
    std::vector<Vec3> points{};  ///< m, at rest, in the cloth's frame
    std::vector<ClothFace> faces{};
    std::vector<ClothLine> lines{};
    std::vector<ClothAttachment> attachments{};
    std::vector<ClothSkin> skin{};  ///< empty, or one for each point
    float density = 0.2f;           ///< kg/m², of faces
    float stretch = 2e4f;           ///< N/m, tension per strain of faces
    float shear = 500.0f;           ///< N/m, of quads
    float bending = 1e-4f;          ///< N m, moment per width and curvature; zero: none
    float lineDensity = 0.05f;      ///< kg/m, of lines
    float lineStretch = 1e5f;       ///< N, tension per strain of lines
    float damping = 0.0f;           ///< 1/s, rate at which velocity decays
    float thickness = 0.01f;        ///< m, that points keep from shapes
    float friction = 0.4f;          ///< Coulomb coefficient, combined with that of the surface
    CombineRule frictionRule = CombineRule::geometricMean;
    float airDensity = 1.225f;      ///< kg/m³; zero: no air
    float drag = 1.2f;              ///< coefficient of a face across the wind
    float lift = 0.6f;              ///< coefficient of a face aslant
    float gravityScale = 1.0f;
    int smallSteps = 4;   ///< in each substep of the world, or 1/240 s of it; fewer cost less, more bear heavier loads
    bool tethers = true;  ///< no point goes farther from the nearest attachment than it is along the cloth
    float tetherSlack = 1.0f;       ///< that distance over the one at rest
    bool allowSleep = true;
    std::uint32_t category = 1;         ///< it meets shapes whose mask has a bit of this,
    std::uint32_t mask = 0xffffffffu;   ///< and whose category has one of this
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ClothSkin*) {
    visit(Tunable{"maxDistance", "m", 0, 1e6, "farthest that a point goes from the animation"}, self.maxDistance);
    visit(Tunable{"backstop", "m", 0, 1e6, "farthest that it goes behind the animated surface"}, self.backstop);
}

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ClothDef*) {
    visit(Tunable{"density", "kg/m²", 1e-3, 1e3, "mass of faces per area"}, self.density);
    visit(Tunable{"stretch", "N/m", 1, 1e8, "tension of faces per strain"}, self.stretch);
    visit(Tunable{"shear", "N/m", 0, 1e8, "tension per shear of quads"}, self.shear);
    visit(Tunable{"bending", "N m", 0, 1e4, "moment per width and curvature"}, self.bending);
    visit(Tunable{"lineDensity", "kg/m", 1e-4, 1e4, "mass of lines per length"}, self.lineDensity);
    visit(Tunable{"lineStretch", "N", 1, 1e10, "tension of lines per strain"}, self.lineStretch);
    visit(Tunable{"damping", "1/s", 0, 1000, "rate at which velocity decays"}, self.damping);
    visit(Tunable{"thickness", "m", 1e-4, 10, "distance that points keep from shapes"}, self.thickness);
    visit(Tunable{"friction", "1", 0, 10, "Coulomb coefficient on shapes"}, self.friction);
    visit(Tunable{"frictionRule", "", 0, 0, "how the coefficient is made of two surfaces'"}, self.frictionRule);
    visit(Tunable{"airDensity", "kg/m³", 0, 2000, "of what it moves in; zero: nothing"}, self.airDensity);
    visit(Tunable{"drag", "1", 0, 10, "coefficient of a face across the wind"}, self.drag);
    visit(Tunable{"lift", "1", 0, 10, "coefficient of a face aslant"}, self.lift);
    visit(Tunable{"gravityScale", "1", -100, 100, "share of the world's gravity"}, self.gravityScale);
    visit(Tunable{"smallSteps", "", 1, 32, "steps in each substep of the world"}, self.smallSteps);
    visit(Tunable{"tethers", "", 0, 1, "points stay as near to attachments as the cloth is long"}, self.tethers);
    visit(Tunable{"tetherSlack", "1", 1, 10, "longest tether over its length at rest"}, self.tetherSlack);
    visit(Tunable{"allowSleep", "", 0, 1, "may come to rest and cost nothing"}, self.allowSleep);
    visit(Tunable{"category", "", 0, 4294967295.0, "bits of what this is"}, self.category);
    visit(Tunable{"mask", "", 0, 4294967295.0, "bits of what this collides with"}, self.mask);
}

/// A sheet of quads with its first point at the origin: point `row * columns + column` lies at
/// column/(columns − 1) · across + row/(rows − 1) · down.
ClothDef clothSheet(int columns, int rows, const Vec3& across, const Vec3& down);
/// A line of points from the origin along `along`.
ClothDef clothRope(int points, const Vec3& along);

/// Empty when the definition is usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const ClothDef& def);

/// A cloth in a world, for as long as the object lives; the world must live longer. It moves in the substeps of
/// World::step, is saved, restored and hashed with the world, and sleeps when it is at rest.
///
/// Each small step predicts all points and then makes lengths right line by line, as compliant constraints [Macklin et al.
/// 2019]; along a line that is not taut all lengths are solved at once. Points meet shapes as they come: what stops a point is handed to
/// the body in the same pass, so that momentum is kept. Faces between points do not collide.
class Cloth {
public:
    /// Throws std::invalid_argument that says what is wrong with the definition, and std::out_of_range for an
    /// attachment to a body that does not exist.
    Cloth(World& world, const ClothDef& def, const Pose& pose = {});
    ~Cloth();
    Cloth(Cloth&&) noexcept;
    Cloth& operator=(Cloth&&) = delete;

    const ClothDef& def() const;
    int pointCount() const;
    DVec3 point(int index) const;    ///< m, in the world; std::out_of_range beyond the points
    Vec3 velocity(int index) const;  ///< m/s
    float mass(int index) const;     ///< kg, of the cloth about it; zero where it is held, and its mass the holder's
    /// All points in the world; throws std::length_error where they are fewer or more than pointCount().
    void readPoints(std::span<DVec3> points) const;
    /// Adds to the velocity of all points, m/s; those that are attached keep theirs.
    void push(const Vec3& velocity);
    /// Air moves with this velocity from now on, m/s. Part of the state.
    void setWind(const Vec3& wind);
    Vec3 wind() const;
    /// Where the animation has the points at the end of the next step, and its normals there; needs ClothDef::skin.
    /// The first call is taken for where they are already. Throws std::invalid_argument on other sizes, numbers that
    /// are not finite, or a cloth without skin.
    void follow(std::span<const DVec3> places, std::span<const Vec3> normals);
    /// Moves the cloth as a whole, with its velocities, as when its wearer is teleported.
    void teleport(const Pose& from, const Pose& to);
    bool isAwake() const;
    void wake();
    /// Points that met a shape in the last substep.
    int contactCount() const;

private:
    std::unique_ptr<struct ClothSim> sim_;
};

}  // namespace ragtop
