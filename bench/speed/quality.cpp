#include "quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "../stability/extremes.h"
#include "../stability/scenery.h"
#include "convex_depth.h"

namespace ragtop::speed {
namespace {

using demos::ConvexSolid;
using stability::Engine;
using stability::larger;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double distance(const DVec3& a, const DVec3& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }

void keepLarger(std::optional<double>& worst, double value) { worst = worst ? larger(*worst, value) : value; }

Pose poseOf(const Scene& scene, const Engine& engine, int body) {
    const BodyDef& def = scene.bodies[static_cast<std::size_t>(body)].def;
    return def.type == BodyType::fixed ? def.pose : engine.motion(body).pose;
}

bool isSomewhere(const Pose& pose) { return isFinite(pose.position) && isFinite(pose.rotation); }

/// A body of one convex shape where it is now.
struct Solid {
    const BodyDef* def;
    ConvexSolid shape;
    demos::Box3 bounds;
};

using Corners = std::array<DVec3, 3>;

/// Everything that may overlap, and the triangles of what does not move.
struct Survey {
    std::vector<Solid> solids;
    std::vector<Corners> triangles;
    bool lost = false;  ///< a body is nowhere

    Survey(const Scene& scene, const Engine& engine) {
        for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
            const BodyDef& def = scene.bodies[i].def;
            const Shape& shape = def.shapes[0].geometry;
            const Pose pose = poseOf(scene, engine, static_cast<int>(i));
            if (!isSomewhere(pose)) {
                lost = true;
            } else if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
                const auto corner = [&](std::uint32_t v) { return transformPoint(pose, mesh->vertices()[v]); };
                for (const Triangle& t : mesh->triangles()) triangles.push_back({corner(t.a), corner(t.b), corner(t.c)});
            } else {
                Solid solid{&def, demos::solidOf(shape, pose), {}};
                solid.bounds = demos::boundsOf(solid.shape);
                solids.push_back(std::move(solid));
            }
        }
        std::ranges::sort(solids, {}, [](const Solid& solid) { return solid.bounds.lower.x; });
    }
};

bool mayMeet(const BodyDef& a, const BodyDef& b) {
    if (a.type == BodyType::fixed && b.type == BodyType::fixed) return false;
    const std::int32_t group = a.shapes[0].filter.group;
    return group == 0 || group != b.shapes[0].filter.group;
}

bool anyMayMeet(const Survey& survey) {
    if (!survey.triangles.empty() && !survey.solids.empty()) return true;
    for (const Solid& a : survey.solids)
        for (const Solid& b : survey.solids)
            if (&a != &b && mayMeet(*a.def, *b.def)) return true;
    return false;
}

bool meet(double lowerA, double upperA, double lowerB, double upperB) { return lowerA <= upperB && lowerB <= upperA; }

double depthInTriangles(const Survey& survey, const Solid& solid) {
    const demos::Box3& b = solid.bounds;
    double deepest = 0;
    for (const auto& [p, q, r] : survey.triangles) {
        if (std::min({p.x, q.x, r.x}) > b.upper.x || std::max({p.x, q.x, r.x}) < b.lower.x) continue;
        if (std::min({p.z, q.z, r.z}) > b.upper.z || std::max({p.z, q.z, r.z}) < b.lower.z) continue;
        deepest = larger(deepest, overlapDepth(solid.shape, p, q, r));
    }
    return deepest;
}

std::vector<double> overlapsOf(const Survey& survey) {
    const std::vector<Solid>& solids = survey.solids;
    std::vector<double> overlaps;
    const auto add = [&](double depth) {
        if (depth > 0) overlaps.push_back(depth);
    };
    for (std::size_t i = 0; i < solids.size(); ++i) {
        const demos::Box3& a = solids[i].bounds;
        if (solids[i].def->type == BodyType::dynamic) add(depthInTriangles(survey, solids[i]));
        for (std::size_t j = i + 1; j < solids.size() && solids[j].bounds.lower.x <= a.upper.x; ++j) {
            const demos::Box3& b = solids[j].bounds;
            if (!meet(a.lower.y, a.upper.y, b.lower.y, b.upper.y) || !meet(a.lower.z, a.upper.z, b.lower.z, b.upper.z))
                continue;
            if (mayMeet(*solids[i].def, *solids[j].def)) add(demos::overlapDepth(solids[i].shape, solids[j].shape));
        }
    }
    std::ranges::sort(overlaps);
    return overlaps;
}

/// How far (m) straight above a point the triangle is; negative where it is below, or not over the point.
double heightAbove(const Corners& triangle, const DVec3& p) {
    const DVec3 a = triangle[0] - p, b = triangle[1] - p, c = triangle[2] - p;
    // Areas of the corners as seen from above.
    const double u = b.z * c.x - b.x * c.z, v = c.z * a.x - c.x * a.z, w = a.z * b.x - a.x * b.z;
    if (u < 0 || v < 0 || w < 0 || !(u + v + w > 0)) return -1;
    return (u * a.y + v * b.y + w * c.y) / (u + v + w);
}

std::optional<double> belowOf(const Scene& scene, const Engine& engine) {
    const bool hasMesh = std::ranges::any_of(scene.bodies, [](const SceneBody& body) {
        return std::holds_alternative<TriangleMesh>(body.def.shapes[0].geometry);
    });
    if (!hasMesh) return {};
    const Survey survey(scene, engine);
    double deepest = survey.lost ? kNaN : 0;
    for (const Solid& solid : survey.solids) {
        if (solid.def->type != BodyType::dynamic) continue;
        const demos::Box3& box = solid.bounds;
        const DVec3 center = 0.5 * (box.lower + box.upper);
        for (const Corners& triangle : survey.triangles) deepest = larger(deepest, heightAbove(triangle, center));
    }
    return deepest;
}

double gapOf(const Scene& scene, const SceneJoint& joint, const Engine& engine) {
    const JointBodies& frames = std::visit([](const auto& def) -> const JointBodies& { return def.bodies; }, joint.def);
    const auto anchor = [&](int body, const Frame& frame) {
        if (body == stability::kWorld) return DVec3{frame.position};
        return transformPoint(poseOf(scene, engine, body), frame.position);
    };
    return distance(anchor(joint.bodyA, frames.frameA), anchor(joint.bodyB, frames.frameB));
}

}  // namespace

void addQualityOnTheWay(const Scene& scene, const Engine& engine, Quality& worst) {
    for (const SceneJoint& joint : scene.joints) keepLarger(worst.gap, gapOf(scene, joint, engine));
    if (const auto below = belowOf(scene, engine)) keepLarger(worst.below, *below);
}

Quality measureQuality(const Scene& scene, const Engine& engine) {
    Quality quality;
    addQualityOnTheWay(scene, engine, quality);
    if (const Survey survey(scene, engine); survey.lost) {
        quality.overlapP99 = quality.overlapMax = kNaN;
    } else if (anyMayMeet(survey)) {
        const std::vector<double> overlaps = overlapsOf(survey);
        const auto last = static_cast<double>(overlaps.size()) - 1;
        quality.overlapP99 = overlaps.empty() ? 0 : overlaps[static_cast<std::size_t>(0.99 * last)];
        quality.overlapMax = overlaps.empty() ? 0 : overlaps.back();
    }
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyDef& def = scene.bodies[i].def;
        if (def.type != BodyType::dynamic) continue;
        const DVec3 now = engine.motion(static_cast<int>(i)).pose.position;
        keepLarger(quality.moved, distance(now, def.pose.position));
    }
    return quality;
}

}  // namespace ragtop::speed
