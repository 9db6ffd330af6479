#include <gtest/gtest.h>

#include <limits>

#include "ragtop/body.h"
#include "ragtop/joint.h"
#include "ragtop/settings.h"
#include "shape_support.h"

namespace ragtop {
namespace {

const float kNan = std::numeric_limits<float>::quiet_NaN();
const char* const kUnitRotation = ", must be finite and have length 1 to within 0.001";

BodyDef ball() {
    BodyDef def;
    def.shapes.push_back({.geometry = Sphere{}});
    return def;
}

TEST(Validation, AcceptsDefaultsThatMakeSense) {
    EXPECT_EQ(whyInvalid(ball()), "");
    EXPECT_EQ(whyInvalid(Material{}), "");
    EXPECT_EQ(whyInvalid(WorldSettings{}), "");
    EXPECT_EQ(whyInvalid(BodyDef{.type = BodyType::fixed}), "");
    EXPECT_EQ(whyInvalid(BodyDef{.type = BodyType::kinematic}), "");
    JointBodies pair;
    pair.a = {1, 1};
    for (const JointDef& def : {JointDef{BallDef{pair}}, JointDef{HingeDef{pair}}, JointDef{SliderDef{pair}},
                                JointDef{FixedDef{pair}}, JointDef{DistanceDef{pair}}}) {
        EXPECT_EQ(whyInvalid(def), "");
    }
}

TEST(Validation, NamesTheNumberOfAMaterial) {
    EXPECT_EQ(whyInvalid(Material{.friction = -0.3f}), "friction is -0.3, must be in [0, 10]");
    EXPECT_EQ(whyInvalid(Material{.restitution = 2}), "restitution is 2, must be in [0, 1]");
    EXPECT_EQ(whyInvalid(Material{.rollingResistance = kNan}), "rollingResistance is nan, must be in [0, 1] m");
    EXPECT_EQ(whyInvalid(Material{.surfaceVelocity = {0, 0, 2000}}),
              "surfaceVelocity.z is 2000, must be in [-1000, 1000] m/s");
    EXPECT_EQ(whyInvalid(Material{.surface = 0xffffffffu}), "");
}

TEST(Validation, NamesTheNumberOfTheSettings) {
    WorldSettings settings;
    settings.substeps = 0;
    EXPECT_EQ(whyInvalid(settings), "substeps is 0, must be in [1, 64]");
    settings = {.solver = static_cast<SolverChoice>(3)};
    EXPECT_EQ(whyInvalid(settings), "solver is 3, must be one of automatic (0), iterative (1), direct (2)");
    settings = {.gravity = {0, kNan, 0}};
    EXPECT_EQ(whyInvalid(settings), "gravity.y is nan, must be in [-1000, 1000] m/s²");
}

TEST(Validation, NamesTheNumberOfABody) {
    BodyDef def = ball();
    def.pose.position.y = kNan;
    EXPECT_EQ(whyInvalid(def), "pose.position.y is nan, must be finite");
    def = ball();
    def.pose.rotation = {0, 0, 0, 0};
    EXPECT_EQ(whyInvalid(def), std::string("pose.rotation is (0, 0, 0, 0)") + kUnitRotation);
    def.pose.rotation = {0, 0, 0, 1.0009f};
    EXPECT_EQ(whyInvalid(def), "");
    def = ball();
    def.linearVelocity.x = 2e5f;
    EXPECT_EQ(whyInvalid(def), "linearVelocity.x is 200000, must be in [-100000, 100000] m/s");
    def = ball();
    def.angularDamping = -1;
    EXPECT_EQ(whyInvalid(def), "angularDamping is -1, must be in [0, 1000] 1/s");
}

TEST(Validation, NamesTheNumberOfABodysShape) {
    BodyDef def = ball();
    def.shapes.push_back({.geometry = Box{{1, 1, -1}}});
    EXPECT_EQ(whyInvalid(def), "shapes[1].geometry.halfExtents.z is -1, must be in [0.0001, 100000] m");
    def.shapes[1] = {.geometry = Sphere{}, .density = -5};
    EXPECT_EQ(whyInvalid(def), "shapes[1].density is -5, must be finite and at least 0 kg/m³");
    def.shapes[1] = {.material = {.friction = 11}};
    EXPECT_EQ(whyInvalid(def), "shapes[1].material.friction is 11, must be in [0, 10]");
    def.shapes[1] = {.frame = {{}, {1, 0, 0, 1}}};
    EXPECT_EQ(whyInvalid(def), std::string("shapes[1].frame.rotation is (1, 0, 0, 1)") + kUnitRotation);
    def.shapes[1] = {.frame = {{0, 0, kNan}, {}}};
    EXPECT_EQ(whyInvalid(def), "shapes[1].frame.position.z is nan, must be finite");
}

TEST(Validation, DynamicBodiesNeedMass) {
    const std::string noMass =
        "mass of all shapes is 0, must be finite and above 0 kg for a dynamic body (shapes with density, or mass "
        "given)";
    BodyDef def;
    EXPECT_EQ(whyInvalid(def), noMass);
    def = ball();
    def.shapes[0].density = 0;
    EXPECT_EQ(whyInvalid(def), noMass);
    def.mass = massOf(Sphere{}, 1);
    EXPECT_EQ(whyInvalid(def), "");
    def.mass->mass = -2;
    EXPECT_EQ(whyInvalid(def), "mass.mass is -2, must be finite and above 0 kg");
    def.mass = massOf(Sphere{}, 1);
    def.mass->center.x = kNan;
    EXPECT_EQ(whyInvalid(def), "mass.center.x is nan, must be finite");
    def.mass = massOf(Sphere{}, 1);
    def.mass->inertia.cy.x = 1;
    EXPECT_EQ(whyInvalid(def), "mass.inertia is not symmetric, must be");
    def.mass->inertia = {{1, 0, 0}, {0, 2, 0}, {0, 0, 0}};
    EXPECT_EQ(whyInvalid(def), "mass.inertia has the diagonal (1, 2, 0) and is not positive definite, must be");
    def.locks = {.rotationX = true, .rotationY = true, .rotationZ = true};
    EXPECT_EQ(whyInvalid(def), "");
}

TEST(Validation, DynamicBodiesAreSolidUnlessTheirMassIsGiven) {
    const std::vector<float> heights(4, 0.0f);
    BodyDef def = ball();
    def.shapes.push_back({.geometry = HeightField(2, 2, 1, heights)});
    EXPECT_EQ(whyInvalid(def), "shapes[1].geometry is a HeightField, which a dynamic body cannot have, must be solid");
    def.type = BodyType::fixed;
    EXPECT_EQ(whyInvalid(def), "");
    def.type = BodyType::dynamic;
    const std::vector<Vec3> vertices{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
    const std::vector<Triangle> triangles{{0, 1, 2}};
    def.shapes[1].geometry = Compound{{CompoundPart{TriangleMesh(vertices, triangles), {}}}};
    EXPECT_EQ(whyInvalid(def),
              "shapes[1].geometry has a TriangleMesh that is open at the edge of vertices 0 and 1; must be solid, or the "
              "body's mass given");
    def.mass = massOf(Sphere{}, 1);
    EXPECT_EQ(whyInvalid(def), "");
}

TEST(Validation, JointsNeedTwoEnds) {
    HingeDef def;
    EXPECT_EQ(whyInvalid(def), "bodies.a and bodies.b are both null, at least one must name a body");
    def.bodies.a = def.bodies.b = {3, 1};
    EXPECT_EQ(whyInvalid(def), "bodies.b is the same body as bodies.a, must be another one or null");
    def.bodies.b = {4, 1};
    def.bodies.frameB.rotation = {kNan, 0, 0, 1};
    EXPECT_EQ(whyInvalid(def), std::string("bodies.frameB.rotation is (nan, 0, 0, 1)") + kUnitRotation);
    def.bodies.frameB = {{0, kNan, 0}, {}};
    EXPECT_EQ(whyInvalid(def), "bodies.frameB.position.y is nan, must be finite");
}

TEST(Validation, JointRangesAreInOrderAndInBounds) {
    JointBodies pair;
    pair.a = {1, 1};
    EXPECT_EQ(whyInvalid(HingeDef{.bodies = pair, .limit = Range{1, -1}}),
              "limit.lower is 1, must be at most limit.upper, -1");
    EXPECT_EQ(whyInvalid(HingeDef{.bodies = pair, .limit = Range{-1e6f, 1}}),
              "limit.lower is -1000000, must be in [-100000, 100000] rad");
    EXPECT_EQ(whyInvalid(HingeDef{.bodies = pair, .limit = Range{-20, kPi}}), "");
    EXPECT_EQ(whyInvalid(DistanceDef{.bodies = pair, .limit = Range{-0.5f, 1}}),
              "limit.lower is -0.5, must be in [0, 100000] m");
    EXPECT_EQ(whyInvalid(DistanceDef{.bodies = pair, .limit = Range{2, 2}}), "");
    EXPECT_EQ(whyInvalid(BallDef{.bodies = pair, .swingLimit = 0.0f}), "swingLimit is 0, must be in [0.001, 3.1] rad");
    EXPECT_EQ(whyInvalid(BallDef{.bodies = pair, .target = {0, 0, 0, 3}}),
              std::string("target is (0, 0, 0, 3)") + kUnitRotation);
    EXPECT_EQ(whyInvalid(SliderDef{.bodies = pair, .motor = Motor{1, -2}}),
              "motor.maxForce is -2, must be in [0, 1e+12] N or N m");
    EXPECT_EQ(whyInvalid(SliderDef{.bodies = pair, .spring = Spring{kNan, 0}}),
              "spring.stiffness is nan, must be in [0, 1e+12] N/m or N m/rad");
}

}  // namespace
}  // namespace ragtop
