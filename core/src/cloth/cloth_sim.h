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
    Mat3 next{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};  ///< rotation when the small step ends
    Vec3 centerBody;                             ///< of mass, in the body
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

/// Where the chains or strips of a bundle have an attached point.
struct HeldPosition {
    std::uint32_t reaction = 0;  ///< of its x among the reactions; y and z follow N later
    int held = 0;                ///< of the held points
};

/// What LinkArrays points to.
struct Links {
    explicit Links(std::pmr::memory_resource* memory)
        : lengths(memory), inverseLengths(memory), compliances(memory), bendLengths(memory), bendStiffness(memory) {}

    AlignedArray<float> lengths, inverseLengths, compliances, bendLengths, bendStiffness;
    float bendRate = 0;  ///< 1/s², square of that of the stiffest bend
};

/// What QuadArrays points to.
struct Quads {
    explicit Quads(std::pmr::memory_resource* memory) : stiffness(memory), rests(memory) {}

    AlignedArray<float> stiffness, rests;
};

/// What TetherArrays points to.
struct Tethers {
    explicit Tethers(std::pmr::memory_resource* memory) : anchors(memory), lengths(memory), pulls(memory) {}

    AlignedArray<std::uint32_t> anchors;  ///< rows, of each point
    AlignedArray<float> lengths, pulls;
    std::vector<int> anchoredAt;  ///< held points; kNoPoint: no tether
};

/// What FaceArrays points to.
struct Faces {
    explicit Faces(std::pmr::memory_resource* memory)
        : corners(memory), shares(memory), air(memory), pointAir(memory) {}

    AlignedArray<std::uint32_t> corners;  ///< rows, four lists
    AlignedArray<float> shares;
    std::vector<std::uint32_t> ofPoint, starts;
    AlignedArray<AirRow> air, pointAir;
};

/// What a definition makes of it, in the layout of the kernels.
struct Fabric {
    explicit Fabric(std::pmr::memory_resource* memory);

    const ClothKernels* kernels = nullptr;
    AlignedArray<float> inverseMasses;  ///< 1/kg, of points that nothing holds
    std::vector<float> masses;          ///< kg; zero where they are held
    std::vector<ChainBundle> chains;
    std::vector<StripBundle> strips;
    std::vector<std::pair<int, int>> chainLayers, stripLayers;  ///< begin and end of their bundles
    AlignedArray<std::uint32_t> rows;                           ///< by position in chains and strips
    Links links;
    Quads quads;
    Tethers tethers;
    Faces faces;
    AlignedArray<float> reactions, scratch;
    AlignedArray<VectorRow> keeps, kicks;
    std::vector<HeldPosition> heldPositions;
    std::vector<int> heldOfPoint;                             ///< kNoPoint where a point is free
    std::vector<std::uint32_t> bundlesOfPoint, bundleStarts;  ///< chains, and strips after all of them
};

struct State {
    explicit State(std::pmr::memory_resource* memory)
        : points(memory), before(memory), velocities(memory), ties(memory) {}

    DVec3 origin;  ///< that places are from; whole metres
    AlignedArray<PointRow> points, before;
    AlignedArray<VectorRow> velocities;
    AlignedArray<TieRow> ties;         ///< zero but for contacts in a small step
    std::vector<std::uint8_t> leaves;  ///< 1: lengths pulled the point off what it touched in the last small step
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
    explicit Surroundings(std::pmr::memory_resource* memory)
        : pairs(memory), hits(memory), planes(memory), results(memory) {}

    std::vector<NearBody> bodies;
    std::vector<BodyId> named;
    std::vector<NearShape> shapes;
    AlignedArray<std::uint32_t> pairs, hits;  ///< rows of points; see Meeting
    AlignedArray<float> planes, results;
    std::vector<PointContact> contacts;
    std::vector<int> contactOfPoint;  ///< kNoPoint: none
    std::vector<Bounds> blocks;       ///< of kPairs points each, from the origin
    std::vector<std::uint8_t> tied;   ///< of each bundle: a point of it is tied to a body in this small step
    float fastest = 0;                ///< m/s, of the points
    float preparedFor = 0;            ///< s, small step that forces are prepared for; zero: none in this step
    int substep = 0;                  ///< of the step
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
/// The box of kPairs points each, and the fastest of all; false where any place or velocity is no number.
bool findBlocks(ClothSim& sim);

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

inline std::uint32_t rowOf(std::size_t point) { return static_cast<std::uint32_t>(point) * kRowBytes; }
inline std::size_t index(int i) { return static_cast<std::size_t>(i); }
/// From the cloth's origin, and never −0 (WidePoint).
inline Vec3 placeFrom(const DVec3& place, const DVec3& origin) { return relative(place, origin) + Vec3{0, 0, 0}; }

}  // namespace cloth
}  // namespace ragtop
