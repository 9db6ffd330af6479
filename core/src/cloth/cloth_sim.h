#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <utility>
#include <vector>

#include "base/aligned_array.h"
#include "cloth/cloth_kernels.h"
#include "cloth/cloth_plan.h"
#include "ragtop/cloth.h"
#include "ragtop/world.h"

namespace ragtop {
namespace cloth {

/// A body near the cloth, as it is in one small step.
struct NearBody {
    BodyId id;
    BodyType type = BodyType::fixed;
    float gravityScale = 1;
    float inverseMass = 0;
    Mat3 inverseInertiaBody{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};  ///< 1/(kg m²), body axes
    Mat3 inverseInertia{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};      ///< world axes
    Frame pose;                 ///< from the cloth's origin
    Vec3 center;                ///< of mass, likewise
    Vec3 linear, angular;       ///< displacement in the small step, gravity included, m and rad
    Vec3 push, spin;            ///< N s and N m s of this small step, about the centre
    Vec3 pushed, spun;          ///< of those before in the substep
    Vec3 movedMore, turnedMore; ///< by what the cloth gave it, m and rad
    int contacts = 0;           ///< points that share the body in this substep
    int held = 0;               ///< points that are attached
};

/// A shape near the cloth in a step, and the points that may meet it.
struct NearShape {
    ShapeId id;
    std::uint32_t body = 0;  ///< of the near bodies
    Frame frame;             ///< in the body
    Surface surface;
    float friction = 0;
    std::size_t firstPlane = 0;  ///< among the floats of planes
    std::uint32_t firstPair = 0, pairs = 0;  ///< pairs in whole blocks of kPairs; points beyond are the dummy
};

/// A point that a surface stops.
struct PointContact {
    std::uint32_t point = 0, shape = 0;
    Vec3 normal, arm;     ///< out of the surface; from the centre of mass
    float gap = 0, end = 0;  ///< m, when the substep begins, and where it would end
    float shareOfBody = 0;   ///< inverse mass of the body's share, 1/kg
    float impulse = 0;       ///< N s²
    float lead = 0;          ///< m along the normal, of the point over the body without the cloth
};

/// A point that a body or the world holds.
struct HeldPoint {
    int point = 0;
    BodyId id;               ///< null: the world
    std::uint32_t body = 0;  ///< of the near bodies, in a step
    Vec3 place;   ///< in the body
    DVec3 fixed;  ///< in the world
};

/// Where the chains of a bundle have an attached point.
struct HeldPosition {
    std::uint32_t reaction = 0;  ///< of its x among the reactions; y and z follow N later
    int held = 0;                ///< of the held points
};

/// What a definition makes of it, in the layout of the kernels.
struct Fabric {
    explicit Fabric(std::pmr::memory_resource* memory);

    const ClothKernels* kernels = nullptr;
    std::vector<float> inverseMasses;            ///< 1/kg, of points that nothing holds
    std::vector<ChainBundle> bundles;
    std::vector<std::pair<int, int>> layers;     ///< begin and end of their bundles
    AlignedArray<std::uint32_t> numbers;
    AlignedArray<float> lengths, compliances, bendLengths, bendCompliances, reactions, scratch;
    AlignedArray<std::uint32_t> tethered, anchors;
    AlignedArray<float> tetherLengths, tetherPulls;
    std::vector<HeldPosition> heldPositions;
    std::vector<int> heldOfPoint;                ///< kNoPoint where a point is free
    AlignedArray<std::uint32_t> corners;         ///< of faces, three lists
    std::vector<std::uint32_t> facesOfPoint, faceStarts;
    AlignedArray<float> faceForces;              ///< four lists
    AlignedArray<float> drive;                   ///< three forces and the resistance of points
};

struct State {
    explicit State(std::pmr::memory_resource* memory) : points(memory), motions(memory) {}

    DVec3 origin;  ///< that places are from; whole metres
    AlignedArray<PointRow> points;
    AlignedArray<MotionRow> motions;
    std::vector<HeldPoint> held;
    Vec3 wind;
    float quiet = 0;  ///< s at rest
    bool awake = true;
    bool follows = false;                 ///< has been told where the animation is
    std::vector<DVec3> skinFrom, skinTo;  ///< where the animation had and has the points
    std::vector<Vec3> skinNormals;
};

/// What is near in a step.
struct Surroundings {
    explicit Surroundings(std::pmr::memory_resource* memory) : pairs(memory), planes(memory), results(memory) {}

    std::vector<NearBody> bodies;
    std::vector<BodyId> named;
    std::vector<NearShape> shapes;
    AlignedArray<std::uint32_t> pairs;
    AlignedArray<float> planes, results;
    std::vector<PointContact> contacts;
    std::vector<int> contactOfPoint;  ///< kNoPoint: none
    std::vector<Bounds> blocks;       ///< of kPairs points each, from the origin
    float fastest = 0;                ///< m/s, of the points
    int smallStep = 0;                ///< number of those done in the step
    std::uint64_t fixedSeen = 0;
};

}  // namespace cloth

/// A cloth while it moves: the data of cloth.h.
struct ClothSim {
    ClothSim(World& world, const ClothDef& def, const Pose& pose);
    ClothSim(const ClothSim&) = delete;
    ClothSim& operator=(const ClothSim&) = delete;
    ~ClothSim();

    World* world;
    ClothDef def;
    StepModule module;
    std::uint64_t digest = 0;
    int count = 0;  ///< of points
    cloth::Fabric fabric;
    cloth::State state;
    cloth::Surroundings around;
    cloth::ClothArrays arrays;
    cloth::FaceArrays faces;
};

namespace cloth {

// cloth_build.cpp
void build(ClothSim& sim, const Pose& pose);

// cloth_surroundings.cpp
/// What is near, before a step; the bodies to name.
void lookAround(ClothSim& sim, float dt);
bool mustWake(const ClothSim& sim);
/// The box of kPairs points each, and the fastest of all.
void findBlocks(ClothSim& sim);

// cloth_contacts.cpp
/// Where bodies are, and where they would go without the cloth.
void readBodies(ClothSim& sim, float h);
void findContacts(ClothSim& sim);
void endContacts(ClothSim& sim, float inverseH);
/// To the next small step, with what the cloth gave them in this one.
void advanceBodies(ClothSim& sim, float h);
/// Gives them what all small steps of a substep come to.
void pushBodies(ClothSim& sim);

// cloth_step.cpp
StepModule moduleOf(ClothSim& sim);
void moveHeld(ClothSim& sim);

inline std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace cloth
}  // namespace ragtop
