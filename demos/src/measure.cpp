#include "measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "convex_depth.h"

namespace ragtop::demos {
namespace {

using BodyPair = std::pair<BodyId, BodyId>;

BodyPair ordered(BodyId a, BodyId b) { return a < b ? BodyPair{a, b} : BodyPair{b, a}; }

double norm(const DVec3& a) { return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }

/// A shape of the world with what decides whom it may touch.
struct Piece {
    BodyId body;
    bool moves = false;
    int owner = -1;  ///< ragdoll or robot it is part of
    Filter filter;
    const Shape* shape = nullptr;
    Pose pose;
    ConvexSolid solid;  ///< empty for surfaces
    Box3 bounds;
};

/// A surface's triangles in the world.
template <class Visit>
void forEachTriangle(const Piece& piece, Visit visit) {
    const auto world = [&](const Vec3& v) { return transformPoint(piece.pose, v); };
    if (const auto* mesh = std::get_if<TriangleMesh>(piece.shape)) {
        for (const Triangle& t : mesh->triangles()) {
            visit(world(mesh->vertices()[t.a]), world(mesh->vertices()[t.b]), world(mesh->vertices()[t.c]));
        }
    }
    if (const auto* field = std::get_if<HeightField>(piece.shape)) {
        const auto at = [&](int i, int j) {
            return world({static_cast<float>(i) * field->spacing(),
                          field->heights()[static_cast<std::size_t>(j * field->columns() + i)],
                          static_cast<float>(j) * field->spacing()});
        };
        for (int j = 0; j + 1 < field->rows(); ++j) {
            for (int i = 0; i + 1 < field->columns(); ++i) {
                visit(at(i, j), at(i, j + 1), at(i + 1, j + 1));
                visit(at(i, j), at(i + 1, j + 1), at(i + 1, j));
            }
        }
    }
}

void setBounds(Piece& piece) {
    if (!piece.solid.points.empty()) {
        piece.bounds = boundsOf(piece.solid);
        return;
    }
    ConvexSolid corners;
    forEachTriangle(piece, [&](const DVec3& p, const DVec3& q, const DVec3& r) {
        corners.points.insert(corners.points.end(), {p, q, r});
    });
    if (!corners.points.empty()) piece.bounds = boundsOf(corners);
}

bool filtersMeet(const Filter& a, const Filter& b) {
    if (a.group == b.group && a.group != 0) return a.group > 0;
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

bool boundsMeet(const Box3& a, const Box3& b) {
    return a.lower.y <= b.upper.y && b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z &&
           a.lower.x <= b.upper.x && b.lower.x <= a.upper.x;
}

double surfaceDepth(const Piece& surface, const Piece& piece) {
    double deepest = 0;
    forEachTriangle(surface, [&](const DVec3& p, const DVec3& q, const DVec3& r) {
        const Box3& b = piece.bounds;
        if (std::min({p.x, q.x, r.x}) > b.upper.x || std::max({p.x, q.x, r.x}) < b.lower.x) return;
        if (std::min({p.z, q.z, r.z}) > b.upper.z || std::max({p.z, q.z, r.z}) < b.lower.z) return;
        deepest = std::max(deepest, overlapDepth(piece.solid, p, q, r));
    });
    return deepest;
}

class OverlapSurvey {
public:
    OverlapSurvey(const World& world, const Scene& scene, const SceneInstance& instance) : world_(world) {
        collectFilters(scene, instance);
        for (const BodyId body : world.bodies()) collect(body);
        for (const JointId joint : world.joints()) {
            std::visit(
                [&](const auto& kind) {
                    if (!kind.bodies.collide) joined_.insert(ordered(kind.bodies.a, kind.bodies.b));
                },
                world.def(joint));
        }
        world.forEachContact([&](const Contact& c) { touching_.insert(ordered(c.bodyA, c.bodyB)); });
    }

    std::vector<double> depths() {
        std::sort(pieces_.begin(), pieces_.end(),
                  [](const Piece& a, const Piece& b) { return a.bounds.lower.x < b.bounds.lower.x; });
        std::vector<double> all;
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            for (std::size_t j = i + 1; j < pieces_.size() && pieces_[j].bounds.lower.x <= pieces_[i].bounds.upper.x;
                 ++j) {
                if (const double depth = depthOf(pieces_[i], pieces_[j]); depth > 0) all.push_back(depth);
            }
        }
        std::sort(all.begin(), all.end());
        return all;
    }

private:
    void collectFilters(const Scene& scene, const SceneInstance& instance) {
        for (std::size_t i = 0; i < instance.bodies.size(); ++i) {
            const auto& shapes = scene.bodies[i].def.shapes;
            if (shapes.empty()) continue;
            filters_[instance.bodies[i]] = shapes[0].filter;
            if (shapes[0].sensor) sensors_.insert(instance.bodies[i]);
        }
        for (const Vehicle& vehicle : instance.vehicles) filters_[vehicle.chassis()] = vehicle.def().chassis.filter;
        for (std::size_t i = 0; i < instance.ragdolls.size(); ++i) {
            for (const BodyId body : instance.ragdolls[i].bodies()) owners_[body] = static_cast<int>(i);
        }
        const std::size_t ragdolls = instance.ragdolls.size();
        for (std::size_t i = 0; i < instance.robots.size(); ++i) {
            for (const BodyId body : instance.robots[i].bodies) owners_[body] = static_cast<int>(ragdolls + i);
        }
    }

    void collect(BodyId body) {
        if (sensors_.contains(body)) return;
        for (const ShapeId shape : world_.shapes(body)) {
            if (world_.givesWay(shape)) continue;
            Piece piece;
            piece.body = body;
            piece.moves = world_.type(body) == BodyType::dynamic;
            if (const auto owner = owners_.find(body); owner != owners_.end()) piece.owner = owner->second;
            if (const auto filter = filters_.find(body); filter != filters_.end()) piece.filter = filter->second;
            piece.shape = &world_.geometry(shape);
            piece.pose = world_.pose(body) * world_.frame(shape);
            piece.solid = solidOf(*piece.shape, piece.pose);
            setBounds(piece);
            pieces_.push_back(std::move(piece));
        }
    }

    double depthOf(const Piece& a, const Piece& b) const {
        if (a.body == b.body || !(a.moves || b.moves) || !boundsMeet(a.bounds, b.bounds)) return 0;
        if (!filtersMeet(a.filter, b.filter) || joined_.contains(ordered(a.body, b.body))) return 0;
        // Which parts of a ragdoll or robot ignore each other is its own affair; the world knows the others.
        if (a.owner >= 0 && a.owner == b.owner && !touching_.contains(ordered(a.body, b.body))) return 0;
        if (a.solid.points.empty()) return b.solid.points.empty() ? 0 : surfaceDepth(a, b);
        if (b.solid.points.empty()) return surfaceDepth(b, a);
        return overlapDepth(a.solid, b.solid);
    }

    const World& world_;
    std::map<BodyId, Filter> filters_;
    std::set<BodyId> sensors_;
    std::map<BodyId, int> owners_;
    std::set<BodyPair> joined_, touching_;
    std::vector<Piece> pieces_;
};

}  // namespace

std::vector<double> overlaps(const World& world, const Scene& scene, const SceneInstance& instance) {
    return OverlapSurvey(world, scene, instance).depths();
}

double quantile(const std::vector<double>& sorted, double q) {
    if (sorted.empty()) return 0;
    const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size())));
    return sorted[std::min(sorted.size(), std::max<std::size_t>(rank, 1)) - 1];
}

double largestJointGap(const World& world) {
    float largest = 0;
    for (const JointId joint : world.joints()) largest = std::max(largest, world.state(joint).gap);
    return static_cast<double>(largest);
}

double largestDisplacement(const World& world, const Scene& scene, const SceneInstance& instance) {
    double largest = 0;
    for (std::size_t i = 0; i < instance.bodies.size(); ++i) {
        if (!scene.bodies[i].masonry) continue;
        largest = std::max(largest, norm(world.pose(instance.bodies[i]).position - scene.bodies[i].def.pose.position));
    }
    return largest;
}

double largestSpeed(const World& world) {
    float largest = 0;
    for (const BodyId body : world.bodies()) largest = std::max(largest, length(world.linearVelocity(body)));
    return static_cast<double>(largest);
}

bool allFinite(const World& world) {
    for (const BodyId body : world.bodies()) {
        const Pose pose = world.pose(body);
        if (!isFinite(pose.position) || !isFinite(pose.rotation) || !isFinite(world.linearVelocity(body)) ||
            !isFinite(world.angularVelocity(body))) {
            return false;
        }
    }
    return true;
}

bool allFinite(const SceneInstance& instance) {
    for (const Cloth& cloth : instance.cloths)
        for (int i = 0; i < cloth.pointCount(); ++i)
            if (!isFinite(cloth.point(i)) || !isFinite(cloth.velocity(i))) return false;
    return true;
}

}  // namespace ragtop::demos
