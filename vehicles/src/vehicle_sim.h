#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "air.h"
#include "axle_linkage.h"
#include "carriers.h"
#include "drivetrain.h"
#include "ground_body.h"
#include "nearby.h"
#include "patch_row.h"
#include "point_body.h"
#include "ragtop/module.h"
#include "ragtop/vehicle.h"
#include "ragtop/world.h"
#include "suspension.h"
#include "tire.h"
#include "vehicle_level.h"
#include "wheel_course.h"

namespace ragtop {

/// The state of a wheel beyond its rotation, which the drivetrain keeps. Saved as it is: no padding.
struct WheelState {
    GroundPlane ground;                ///< under it in the last substep
    GroundPlane ahead;                 ///< where it will be at the beginning of the next step
    std::uint64_t touching = 0;        ///< in the last substep
    float compression = 0;             ///< m above rest
    float load = 0;                    ///< N
    Vec2 force;                        ///< N on the car: forward, left
    Vec2 deflection;                   ///< m, of the bristles, when the last substep began, or ended if settleTime is 0
    Vec2 core;                         ///< m, of what of them bears
    float coreLoad = 0;                ///< N, as Tread has them
    float settleTime = 0;              ///< s for which the deflection still has to follow the slip
    float transport = 0;               ///< m/s of tread through the patch in that time
    Vec2 travel;                       ///< m/s of the contact point over the ground: forward, left
    float rotation = 0;                ///< rad about the axle
    float hubSpeed = 0;                ///< m/s along the strut
    float below = 0;                   ///< m of its course below the ground ahead, see CourseEnd
    float inclination = 0;             ///< rad, as TireGround
    float aligning = 0;                ///< N m about the ground's normal, to the left
    float sunk = 0;                    ///< m by which the ground counts as lower, see VehicleSim::sinkGround
    float squash = kPut;               ///< m of its tire when the last substep began, nothing in the air
    static constexpr float kPut = -1;  ///< somebody put the car where it is, and it has not moved since
    bool isPut() const { return squash < 0; }
    Tread tread() const { return {deflection, core, load, coreLoad}; }
    /// All of its tread alike.
    void bend(const Vec2& by) {
        deflection = core = by;
        coreLoad = load;
    }
};
static_assert(sizeof(WheelState) == 2 * 112 + 88);

/// What does not change while driving.
struct WheelSpec {
    Vec3 position, axis;  ///< in the chassis
    Vec3 steerArm;        ///< from the middle of the unsteered axle
    float radius = 0, halfWidth = 0, staticLoad = 0;
    StrutSpec strut;
    TireSpec tire;
    float barStiffness = 0;            ///< N/m, of an anti-roll bar
    std::size_t barPartner = 0;        ///< the wheel at its other end
    int linkage = -1;                  ///< VehicleSim::linkages, of a wheel that has one
    bool isRight = false;              ///< of its linkage
    std::size_t beamPartner = 0;       ///< the other wheel of a beam; itself where there is none
    std::size_t carrier = 0;           ///< VehicleSim::carriers, of a wheel that has a linkage
    Vec3 hubOnCarrier, axleOnCarrier;  ///< in its frame, as CarriedWheel
};

/// Where strut or linkage has a wheel, and the line along which its hub goes from there, in the chassis.
struct WheelLine {
    Vec3 hub, base;                ///< base: where the line would have it at no compression
    Vec3 along, axis;              ///< unit; m per m of compression
    Vec3 axle, tilting;            ///< unit, to the left; rad/m by which the axle turns, across itself
    float spinRate = 0;            ///< rad/m by which what brakes the wheel turns forward about the axle
    Vec3 crossAxis, crossTilting;  ///< the same as the other wheel of its beam rises
};

/// What a substep works with.
struct WheelPatch {
    bool touching = false;
    Vec3 normal, forward, side, axle;  ///< unit, world; axle to the left
    PatchRow normalRow, forwardRow, sideRow;
    Vec2 lean;             ///< of the strut, along forward and side
    Vec2 cross;            ///< the same of the way of its beam's other wheel
    float crossSlant = 0;  ///< and along the normal
    Vec3 arm;              ///< of the contact point from the chassis's centre of mass
    Vec3 given, turned;    ///< N s, N m s of the solve on the car, whose opposite the ground gets
    DVec3 point;
    Vec3 axis;                    ///< of the strut, unit, world
    float slant = 1;              ///< cosine of strut and normal
    float rise = 0;               ///< m that the hub would have risen on a tire that has its radius
    float squash = 0;             ///< m of the tire at the beginning of the substep
    PointBody* ground = nullptr;  ///< what it stands on, shared with the other wheels there
    TireLaw law;
    float transport = 0, spinBefore = 0;
    Vec3 speedBefore;  ///< of the chassis there over the ground: forward, left, along the normal
    TireLine line;
    Vec2 bent;             ///< m, of its bristles where its mean force is, as last found,
    bool lineDue = false;  ///< by which the line has not been taken yet
    float strutK = 0;      ///< inverse effective masses along the normal and of the patch
    Sym2 tireK;
    float way = 0;           ///< m that the strut is compressed in the substep
    Vec3 momentum, turning;  ///< at level 3: N s and N m s of its carrier about the car's centre of mass per m/s of u̇
    float inertia = 0, crossInertia = 0;  ///< kg against u̇, of its own and of the other wheel of its beam
    float wayBefore = 0, wayAfter = 0;    ///< m/s, u̇ at the beginning and the end
    float strutGive = 0;                  ///< m/s of the hub that a unit impulse along the strut makes
    float load = 0;                       ///< impulses, N s: along the normal,
    Vec2 tire;                            ///< and along the patch
    bool sliding = false;
    bool held = false;    ///< its brake holds the wheel, as last found,
    float heldShare = 0;  ///< and then by this share of the turning of what carries its pads
};

/// On the chassis, about its centre of mass.
struct CarImpulse {
    Vec3 linear, angular;  ///< N s, N m s
};

/// Energy that is not the drivetrain's, since the start, J.
struct CarLosses {
    double slip = 0, struts = 0, air = 0;
};

/// Whether somebody has moved the car between steps, and not the last bit of its rotation.
bool isElsewhere(const Pose& now, const Pose& before);

/// A car inside: definition, state, and the parts of the step. vehicle.cpp builds, saves and shows it,
/// vehicle_line.cpp says where struts and linkages have wheels, vehicle_contact.cpp where these meet the ground,
/// vehicle_step.cpp does what happens once per step, vehicle_substep.cpp the implicit solve, vehicle_carriers.cpp the
/// bodies of level 3, vehicle_pull.cpp what presses wheels besides their springs, vehicle_energy.cpp counts what it
/// takes; vehicle_level.cpp goes from one level to another, vehicle_bicycle.cpp drives level 0.
struct VehicleSim {
    VehicleSim(World& inWorld, const VehicleDef& inDef, const VehiclePlacement& placement);

    void setDef(const VehicleDef& next);
    void setLevel(VehicleLevel level);
    void place(const VehiclePlacement& placement);
    void setVelocity(const Vec3& linear, const Vec3& angular);

    bool swings() const;
    void beforeStep(double dt);
    std::span<const BodyId> look(double dt);
    void beforeSubstep(float h);
    void afterStep();

    std::size_t saveSize() const;
    void save(std::span<std::byte> into) const;
    bool fits(std::span<const std::byte> from) const;
    void restore(std::span<const std::byte> from);
    std::uint64_t hash() const;
    const VehicleTelemetry& tell();
    void refreshTelemetry();
    void tellMotion(const Pose& pose);
    void tellWheel(std::size_t i, const Pose& pose);

    // What a sleeping car is asked for in every step lies together.
    World* world = nullptr;  ///< follows a world that is moved, with every call of the module
    BodyId chassis;
    bool active = true;                         ///< the chassis is awake
    std::atomic<bool> stale{false};             ///< telemetry is of an earlier state
    std::optional<std::uint64_t> restsOnFixed;  ///< World::fixedVersion of when it was seen to stand where it stood
    struct Driver {
        float throttle = 0, brake = 0, steer = 0, handbrake = 0, clutch = 0, differentialLock = 0;
        std::int32_t gear = 0, gearGiven = 0;
        std::array<float, 16> wheelTorques{};
        Vec3 wind;
        /// Whether it keeps a car in the gear that it is in from resting.
        bool drives(std::int32_t inGear) const;
        bool operator==(const Driver&) const = default;
    };
    static Driver driverOf(const VehicleInput& input);
    VehicleInput inputAtRest;  ///< with which it was seen so
    Driver driver;             ///< the input of the last step, within its ranges
    VehicleInput input;
    StepModule module;
    std::vector<BodyId> touched;  ///< what this step may push: the chassis, and what moves under its wheels
    VehicleDef def;
    std::vector<WheelSpec> specs;
    std::vector<AxleLinkage> linkages;
    std::vector<CarrierSpec> carrierSpecs;
    std::vector<LiftPoint> lifts;
    std::vector<float> loadsAtRest;
    MassProperties carMass;       ///< of all of it, in the frame of the chassis
    float mass = 0, gravity = 0;  ///< kg; m/s², at creation
    Mat3 inverseInertia;          ///< chassis axes
    BicycleSpec ride;             ///< of level 0
    float meanRadius = 0;         ///< of the driven wheels
    std::uint64_t digest = 0;     ///< of the definition, and of the gravity of its springs

    // State, with the driver.
    float steerAngle = 0;  ///< rad, positive to the left
    Drivetrain drivetrain;
    std::vector<WheelState> wheels;
    std::vector<float> peakLoads;  ///< N, of the last step
    CarLosses lost;
    CarImpulse carried;             ///< of the last substep, which the chassis has not got yet
    std::vector<Carrier> carriers;  ///< of linkages; bodies at level 3
    Pose endPose;                   ///< of the chassis at the end of the last step
    Quat substepRotation;           ///< of it at the beginning of the last substep
    float unseen = 0;               ///< m that level 0 has gone since it looked for the ground

    // Working memory.
    std::mutex telling;  ///< of those that ask for it at once
    std::vector<WheelPatch> patches;
    std::vector<WheelWay> ways;
    Nearby nearby;  ///< of a step
    std::vector<WheelCourse> courses;
    std::vector<WheelCurve> curves;   ///< of a step: along which linkages guide their wheels, as it steers
    std::vector<WheelLine> lines;     ///< of now
    std::vector<Vec3> aheads;         ///< of a step: where wheels roll to, unit, in the chassis
    int substep = 0;                  ///< of the step
    int parts = 1, part = 0;          ///< of a substep in which a wheel goes over an edge
    int together = 1, inOne = 1;      ///< substeps that share a solve, of the step and in the present one
    float substepLength = 0;          ///< s, at level 3
    float gripTrusted = 1;            ///< share of what tires answer in the next visit that shafts count on, of a solve
    PointBody unforced, solved;       ///< of a substep at level 3: how the car goes by gravity alone; by all
    CarImpulse whole;                 ///< of the substeps that share a solve
    DriveWork workBefore;             ///< when the step began, as what was
    CarLosses lostBefore;             ///< lost
    Vec3 endVelocity, endTurning;     ///< of a step, at level 0
    std::vector<GroundBody> grounds;  ///< of the first wheel that stands there
    std::vector<std::size_t> groundOfWheel;  ///< which of them
    std::vector<float> resistances;          ///< N m
    VehicleTelemetry telemetry;
    std::vector<WheelTelemetry> wheelTelemetry;

private:
    void takeDef();
    void takeBar(const AntiRollBarDef& bar);
    void start(float speed);
    bool mayRest(const Driver& wanted);
    void seekGround(std::size_t i, const QueryFilter& query);
    void seekPoint(std::size_t i, const QueryFilter& query);
    void findGuides();
    void steerWheels();
    const SuspensionCurves& curvesOf(std::size_t i) const;
    float otherOf(std::size_t i) const;
    WheelCurve curveOf(std::size_t i) const;
    WheelLine lineOf(std::size_t i, const Vec3& ahead, const WheelCurve& curve) const;
    void takeLine(std::size_t i);
    Vec3 headingOf(std::size_t i) const;
    WheelLine lineNow(std::size_t i) const;
    Pose wheelFrame(std::size_t i, const Pose& pose) const;
    void placeShapes();

    Filter filterOf(std::size_t shape) const;
    void takeFilters();
    void takeLevel();
    void leaveBicycle();
    void standOnGround();
    void seekBelow(const Pose& pose);
    void rideBicycle(float h);
    BicycleRoad roadBelow(const Pose& pose, const Vec3& velocity, float h) const;
    float pushAlong(const BicycleRoad& road, float speed, float h);
    LateralMotion<float> steerAlong(const BicycleRoad& road, const LateralMotion<float>& from, float speed,
                                    float acceleration, float h) const;
    void leadTo(const Vec3& velocity, const Vec3& turning);
    void rollWheels(float speed, float h);

    bool isThere() const;
    bool hasCarriers() const { return def.level == VehicleLevel::linkages; }
    Frame carrierFrame(std::size_t k) const;
    void takeCarrier(std::size_t i, WheelLine& line) const;
    void readCarriers();
    void followJoints();
    float rackOf(const CarrierSpec& spec) const;
    void steerCarriers();
    CarrierPlace placeOf(const CarrierSpec& spec, LinkageCoordinates& at) const;
    void createCarrier(std::size_t k, const Pose& pose);
    void makeCarriers();
    void removeCarriers();
    void followPose(const Pose& pose);
    void bringCarriers(const Pose& pose);
    void takeInertia(std::size_t i, const Pose& pose, const DVec3& center);
    void addInertia(std::size_t i, const PointBody& body, float h, BarPull& pull) const;
    void swing(std::size_t i, float way, PointBody& body);
    void actOnCarriers(float h);
    void giveToCarrier(std::size_t k, const Pose& pose, CarImpulse& sum);

    PointBody bodyAt(const Pose& pose) const;
    bool standsOnWhatMoves() const;
    bool standsEvenly() const;
    int substepsTogether(float dt) const;
    void actTogether(float h);
    void pushGrounds(float share);
    void act(const Pose& pose, const DVec3& center, PointBody body, float h, CarImpulse& sum);
    int partsOfSubstep(float dt) const;
    void preparePatch(std::size_t i, const Pose& pose, const DVec3& center, const PointBody& body,
                      const PointBody& moved, float h);
    WheelWay wayOf(std::size_t i, const Pose& pose, float dt) const;
    bool placePatch(std::size_t i, const Pose& pose, const DVec3& center);
    void takePiece(std::size_t i, const DVec3& hub);
    void findGrounds();
    void beginGrounds();
    void takeGround(std::size_t i, const PointBody& body);
    bool sinkGround(std::size_t i, const PointBody& body, float h);
    float closing(std::size_t i, const PointBody& body, float h) const;
    float comeDown(std::size_t i, const PointBody& body, float h) const;
    void letFall(std::size_t i, float h);
    float visitFree(std::size_t i, PointBody& body, float h);
    BarPull barOf(std::size_t i) const;
    BarPull pullOn(std::size_t i, const PointBody& body, float h) const;
    void takeCross(std::size_t i, const Pose& pose);
    void carryPads(std::size_t i, float h);
    bool holdOnPads(std::size_t i, float h, float taken);
    void addHeldSpin(std::size_t i, float h, BarPull& pull) const;
    float pushTire(std::size_t i, PointBody& body, float h);
    TireGround groundOf(std::size_t i) const;
    float resistanceOf(std::size_t i) const;
    void settleTire(std::size_t i, const PointBody& moved);
    void pushPatch(std::size_t i, PointBody& body, float load, const Vec2& tire);
    void takeHeights();
    Vec3 solve(PointBody& body, float h);
    Vec3 expectTire(std::size_t i, const PointBody& body, float h);
    float visitWheel(std::size_t i, PointBody& body, float h);
    void finishWheel(std::size_t i, const PointBody& body, float h, Vec3& linear, Vec3& angular);
    Vec3 patchSpeed(std::size_t i, const PointBody& body) const;
    void countPatch(std::size_t i, const PointBody& body, float hubSpeed, float otherSpeed);
    void countBody(const PointBody& before, const PointBody& after, const CarImpulse& air, const Vec3& turned);
    double elasticEnergy() const;
    double treadEnergy(std::size_t i) const;
    double carriedEnergy() const;
    void tellEnergy();
    bool holds(const Vec3& linear, const Vec3& angular) const;
    void forgetMotion();
    /// Calls visit(value) for every part of the state, each free of padding.
    template <class Self, class Visit>
    static void visitState(Self& self, Visit&& visit);
};

}  // namespace ragtop
