// What is near a cloth in a step: bodies, shapes, and which points may meet them.

#include <algorithm>
#include <cmath>
#include <variant>

#include "base/four_floats.h"
#include "cloth/cloth_sim.h"
#include "ragtop/symmetric.h"
#include "shapes/geometry.h"

namespace ragtop::cloth {
namespace {

/// m/s, of the fastest body that is seen coming.
constexpr float kFastestBody = 100.0f;

Bounds grown(const Bounds& bounds, float by) {
    const Vec3 margin{by, by, by};
    return {bounds.lower - margin, bounds.upper + margin};
}

Bounds boundsOfAll(const ClothSim& sim) {
    Bounds all = sim.around.blocks.front();
    for (const Bounds& block : sim.around.blocks) all = merge(all, block);
    return all;
}

std::uint32_t nearBody(ClothSim& sim, BodyId id) {
    Surroundings& around = sim.around;
    for (std::uint32_t i = 0; i < around.bodies.size(); ++i)
        if (around.bodies[i].id == id) return i;
    NearBody body;
    body.id = id;
    body.type = sim.world->type(id);
    if (body.type == BodyType::dynamic) {
        const MassProperties mass = sim.world->mass(id);
        body.gravityScale = sim.world->gravityScale(id);
        body.inverseMass = 1 / mass.mass;
        body.inverseInertiaBody = inverseSymmetric(mass.inertia);
    }
    around.bodies.push_back(body);
    return static_cast<std::uint32_t>(around.bodies.size() - 1);
}

/// The kind of surface, and what it is made of.
void describeSurface(const Shape& geometry, Surface& surface) {
    if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
        surface.radius = sphere->radius;
    } else if (const auto* capsule = std::get_if<Capsule>(&geometry)) {
        surface.radius = capsule->radius;
        surface.halfExtents = {0, capsule->halfHeight, 0};
    } else if (const auto* box = std::get_if<Box>(&geometry)) {
        surface.kind = SurfaceKind::box;
        surface.halfExtents = box->halfExtents;
    } else if (const auto* hull = std::get_if<ConvexHull>(&geometry)) {
        static_assert(sizeof(Plane) == 4 * sizeof(float));
        surface.kind = SurfaceKind::hull;
        surface.planes = &hull->data().planes.front().normal.x;
        surface.planeCount = static_cast<int>(hull->data().planes.size());
    } else {
        surface.kind = SurfaceKind::planes;
    }
}

/// The point of a triangle that is nearest to p [Ericson 2005, 5.1.5].
Vec3 nearestOnTriangle(const TriangleView& t, const Vec3& p) {
    const Vec3 ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a;
    const float d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return t.a;
    const Vec3 bp = p - t.b;
    const float d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return t.b;
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return t.a + (d1 / (d1 - d3)) * ab;
    const Vec3 cp = p - t.c;
    const float d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return t.c;
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return t.a + (d2 / (d2 - d6)) * ac;
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return t.b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (t.c - t.b);
    const float scale = 1 / (va + vb + vc);
    return t.a + (vb * scale) * ab + (vc * scale) * ac;
}

/// The nearest front within reach of a point, as a plane; behind a face it is the face's own.
struct NearestFront {
    Vec3 point;
    float reach, depth;  ///< m before and behind
    float nearest;
    Plane plane{};
    bool found = false;

    bool visit(const TriangleView& t) {
        const float height = dot(t.normal, point - t.a);
        if (height < -depth || height > reach) return true;
        const Vec3 on = nearestOnTriangle(t, point), d = point - on;
        const float distance = length(d);
        if (distance >= nearest || (height < 0 && distance > 1.001f * -height)) return true;
        nearest = distance;
        found = true;
        plane.normal = height > 1e-3f * distance && height > 0 ? (1 / distance) * d : t.normal;
        plane.offset = dot(plane.normal, on);
        return true;
    }
};

NearestFront nearestFront(const Shape& geometry, const Vec3& point, float reach, float depth) {
    NearestFront front{point, reach, depth, reach};
    const Bounds bounds = grown({point, point}, reach);
    const auto visit = [&](const TriangleView& t) { return front.visit(t); };
    if (const auto* mesh = std::get_if<TriangleMesh>(&geometry)) forEachTriangle(mesh->data(), bounds, visit);
    if (const auto* field = std::get_if<HeightField>(&geometry)) forEachTriangle(field->data(), bounds, visit);
    return front;
}

void addPair(ClothSim& sim, NearShape& shape, std::uint32_t point, const Plane& plane) {
    Surroundings& around = sim.around;
    if (shape.surface.kind == SurfaceKind::planes) {
        const std::size_t lane = shape.pairs % kPairs;
        if (lane == 0) around.planes.resize(around.planes.size() + 4 * kPairs, 0);
        float* to = around.planes.end() - 4 * kPairs + lane;
        to[0] = plane.normal.x;
        to[kPairs] = plane.normal.y;
        to[2 * kPairs] = plane.normal.z;
        to[3 * kPairs] = plane.offset;
    }
    around.pairs.push(rowOf(point));
    ++shape.pairs;
}

/// Of a block whose bounds meet those of the shape, what is within reach.
void addPairsOf(ClothSim& sim, NearShape& shape, std::size_t block, float reach) {
    const std::uint32_t first = static_cast<std::uint32_t>(block) * kPairs;
    const auto end = std::min(first + kPairs, static_cast<std::uint32_t>(sim.count));
    if (shape.surface.kind == SurfaceKind::planes) {
        const Shape& geometry = sim.world->geometry(shape.id);
        const float depth = std::max(sim.def.thickness, 0.25f * reach);
        const Frame& at = {shape.surface.position, shape.surface.rotation};
        for (std::uint32_t i = first; i < end; ++i) {
            const NearestFront front =
                nearestFront(geometry, inverseTransformPoint(at, sim.state.points[i].place), reach, depth);
            if (front.found) addPair(sim, shape, i, front.plane);
        }
        return;
    }
    alignas(64) std::uint32_t rows[kPairs];
    alignas(64) float results[kPairFloats];
    std::uint32_t hits[kPairs];
    for (std::uint32_t i = 0; i < kPairs; ++i) {
        rows[i] = rowOf(first + i);
        results[i] = reach;
    }
    sim.fabric.kernels->meet(sim.arrays, shape.surface, {rows, kPairs, reach, results, hits});
    for (std::uint32_t i = first; i < end; ++i)
        if (results[i - first] < reach && sim.fabric.heldOfPoint[i] == kNoPoint) addPair(sim, shape, i, {});
}

void addShape(ClothSim& sim, ShapeId id, float dt) {
    const World& world = *sim.world;
    const BodyId owner = world.bodyOf(id);
    NearShape shape;
    shape.id = id;
    shape.frame = world.frame(id);
    const Pose pose = world.pose(owner) * shape.frame;
    const Shape& geometry = world.geometry(id);
    const float radius = length(shape.frame.position - world.mass(owner).center) + radiusAbout(geometry, {});
    const float turning = length(world.angularVelocity(owner)) * (std::isfinite(radius) ? radius : 0);
    const float speed = length(world.linearVelocity(owner)) + turning;
    // What gravity and lengths add in a step, over what moves already.
    const float reach = 2 * sim.def.thickness + dt * (speed + 1.5f * sim.around.fastest + 10 * dt);
    const Bounds bounds = world.bounds(id);
    const Vec3 origin = toVec3(sim.state.origin);
    const Bounds seen = grown({bounds.lower - origin, bounds.upper - origin}, reach);
    describeSurface(geometry, shape.surface);
    shape.surface.position = relative(pose.position, sim.state.origin);
    shape.surface.rotation = pose.rotation;
    shape.firstPair = static_cast<std::uint32_t>(sim.around.pairs.size());
    const std::size_t firstPlane = sim.around.planes.size();
    for (std::size_t block = 0; block < sim.around.blocks.size(); ++block)
        if (overlaps(sim.around.blocks[block], seen)) addPairsOf(sim, shape, block, reach);
    if (shape.pairs == 0) return;
    while (shape.pairs % kPairs != 0) {
        sim.around.pairs.push(rowOf(index(sim.count)));
        ++shape.pairs;
    }
    shape.firstPlane = firstPlane;
    shape.body = nearBody(sim, owner);
    const Material material = world.material(id);
    shape.friction = combined(sim.def.frictionRule, sim.def.friction, material.frictionRule, material.friction);
    sim.around.shapes.push_back(shape);
}

/// Drag and lift of faces, as a force on points that falls off with their velocity.
void blowOn(ClothSim& sim) {
    if (sim.def.airDensity == 0 || sim.faces.count == 0) return;
    sim.faces.wind = sim.state.wind;
    sim.fabric.kernels->blow(sim.arrays, sim.faces);
    for (std::size_t i = 0; i < index(sim.count); ++i) {
        FourFloats sum{0, 0, 0, 0};
        for (std::uint32_t k = sim.fabric.faces.starts[i]; k < sim.fabric.faces.starts[i + 1]; ++k)
            sum += loadFour(&sim.fabric.faces.air[sim.fabric.faces.ofPoint[k]].force.x);
        storeFour(&sim.fabric.faces.pointAir[i].force.x, sum + sum[3] * loadFour(&sim.state.velocities[i].v.x));
    }
}

/// Keeps places small, so that they stay precise.
void recenter(ClothSim& sim) {
    constexpr float kFar = 4.0f;  // m
    const Bounds all = boundsOfAll(sim);
    const Vec3 middle = 0.5f * (all.lower + all.upper);
    const Vec3 shift{std::round(middle.x), std::round(middle.y), std::round(middle.z)};
    if (!(lengthSquared(shift) > kFar * kFar) || !isFinite(shift)) return;
    sim.state.origin = sim.state.origin + shift;
    for (std::size_t i = 0; i < index(sim.count); ++i) sim.state.points[i].place -= shift;
    findBlocks(sim);
}

}  // namespace

bool findBlocks(ClothSim& sim) {
    FourFloats strange{0, 0, 0, 0};  // zero as long as all are numbers
    float fastest = 0;
    const std::size_t last = index(sim.count) - 1;
    for (std::size_t block = 0; block < sim.around.blocks.size(); ++block) {
        const std::size_t first = block * kPairs;
        // The rows beyond the points are at the last of them.
        FourFloats lower = loadFour(&sim.state.points[std::min(first, last)].place.x), upper = lower;
        for (std::size_t i = first; i < std::min(first + kPairs, last + 1); ++i) {
            const FourFloats place = loadFour(&sim.state.points[i].place.x);
            const FourFloats v = loadFour(&sim.state.velocities[i].v.x), squared = v * v;
            lower = place < lower ? place : lower;
            upper = place > upper ? place : upper;
            fastest = std::max(fastest, squared[0] + squared[1] + squared[2]);
            strange += 0.0f * place + 0.0f * squared;
        }
        sim.around.blocks[block] = {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
    }
    sim.around.fastest = std::sqrt(fastest);
    return strange[0] == 0 && strange[1] == 0 && strange[2] == 0;
}

void lookAround(ClothSim& sim, float dt) {
    Surroundings& around = sim.around;
    recenter(sim);
    std::copy(sim.state.points.begin(), sim.state.points.end(), sim.state.before.begin());
    around.preparedFor = 0;
    around.bodies.clear();
    around.shapes.clear();
    around.pairs.clear();
    around.planes.clear();
    for (HeldPoint& held : sim.state.held) {
        if (held.id.isNull()) continue;
        if (sim.world->isValid(held.id)) {
            held.body = nearBody(sim, held.id);
        } else {  // it stays where it lost its holder
            held.id = {};
            held.fixed = sim.state.origin + sim.state.points[index(held.point)].place;
        }
    }
    const Bounds all = boundsOfAll(sim);
    const Vec3 origin = toVec3(sim.state.origin);
    const float reach = 2 * sim.def.thickness + dt * (kFastestBody + around.fastest);
    const Bounds seen = grown({all.lower + origin, all.upper + origin}, reach);
    QueryFilter filter;
    filter.category = sim.def.category;
    filter.mask = sim.def.mask;
    const auto visit = [&sim, dt](ShapeId id) {
        addShape(sim, id, dt);
        return true;
    };
    sim.world->overlap(seen, visit, filter);
    // Planes may have moved as their array grew.
    for (NearShape& shape : around.shapes)
        if (shape.surface.kind == SurfaceKind::planes)
            shape.surface.pairPlanes = around.planes.data() + shape.firstPlane;
    around.results.resizeForOverwrite(around.pairs.size() / kPairs * kPairFloats);
    around.hits.resizeForOverwrite(around.pairs.size());
    around.named.assign(1, BodyId{});
    for (const NearBody& body : around.bodies) around.named.push_back(body.id);
    around.fixedSeen = sim.world->fixedVersion();
    around.substep = 0;
    blowOn(sim);
}

bool mustWake(const ClothSim& sim) {
    constexpr float kStandsBelow = 0.02f;  // m/s, and rad/s
    if (sim.around.fixedSeen != sim.world->fixedVersion()) return true;
    const Bounds all = boundsOfAll(sim);
    const Vec3 origin = toVec3(sim.state.origin);
    bool meets = false;
    const auto moves = [&](BodyId id) {
        return sim.world->type(id) != BodyType::fixed &&
               length(sim.world->linearVelocity(id)) + length(sim.world->angularVelocity(id)) > kStandsBelow;
    };
    for (const HeldPoint& held : sim.state.held)
        if (!held.id.isNull() && (!sim.world->isValid(held.id) || moves(held.id))) return true;
    QueryFilter filter;
    filter.category = sim.def.category;
    filter.mask = sim.def.mask;
    const auto visit = [&](ShapeId id) {
        meets = moves(sim.world->bodyOf(id));
        return !meets;
    };
    sim.world->overlap(grown({all.lower + origin, all.upper + origin}, 2 * sim.def.thickness), visit, filter);
    return meets;
}

}  // namespace ragtop::cloth
