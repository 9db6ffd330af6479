#include "overlaps.h"

#include <algorithm>

namespace ragtop::laws {
namespace {

std::pair<std::size_t, std::size_t> inOrder(std::size_t a, std::size_t b) { return std::minmax(a, b); }

bool meet(double lowerA, double upperA, double lowerB, double upperB) { return lowerA <= upperB && lowerB <= upperA; }

bool passes(const Filter& a, const Filter& b) {
    if (a.group != 0 && a.group == b.group) return a.group > 0;
    return (a.mask & b.category) != 0 && (b.mask & a.category) != 0;
}

}  // namespace

Overlaps::Overlaps(const Scene& scene, const stability::Engine& engine) : scene_(scene) {
    for (const SceneJoint& joint : scene.joints) {
        const JointBodies& bodies =
            std::visit([](const auto& def) -> const JointBodies& { return def.bodies; }, joint.def);
        if (!bodies.collide && joint.bodyA >= 0 && joint.bodyB >= 0)
            ignored_.insert(inOrder(static_cast<std::size_t>(joint.bodyA), static_cast<std::size_t>(joint.bodyB)));
    }
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        for (std::size_t shape = 0; shape < scene.bodies[body].def.shapes.size(); ++shape)
            parts_.push_back({body, shape, {}, {}});
    place(engine);
    std::vector<std::pair<std::size_t, std::size_t>> together;
    forEachOverlap([&](const Part& a, const Part& b, double) { together.push_back(inOrder(a.body, b.body)); });
    ignored_.insert(together.begin(), together.end());
}

double Overlaps::deepest(const stability::Engine& engine) {
    place(engine);
    double depth = 0;
    forEachOverlap([&](const Part&, const Part&, double each) { depth = std::max(depth, each); });
    return depth;
}

double Overlaps::held(const stability::Engine& engine) {
    place(engine);
    double sum = 0;
    forEachOverlap([&](const Part& a, const Part& b, double depth) {
        sum += depth * engine.normalForce(static_cast<int>(a.body), static_cast<int>(b.body));
    });
    return sum;
}

void Overlaps::place(const stability::Engine& engine) {
    for (Part& part : parts_) {
        const BodyDef& def = scene_.bodies[part.body].def;
        const Pose pose = def.type == BodyType::fixed ? def.pose : engine.motion(static_cast<int>(part.body)).pose;
        const ShapeDef& shape = def.shapes[part.shape];
        part.solid = demos::solidOf(shape.geometry,
                                    {transformPoint(pose, shape.frame.position), pose.rotation * shape.frame.rotation});
        part.bounds = demos::boundsOf(part.solid);
    }
    std::ranges::sort(parts_, {}, [](const Part& part) { return part.bounds.lower.x; });
}

bool Overlaps::mayMeet(const Part& a, const Part& b) const {
    const BodyDef &defA = scene_.bodies[a.body].def, &defB = scene_.bodies[b.body].def;
    if (a.body == b.body || a.solid.points.empty() || b.solid.points.empty()) return false;
    if (defA.type != BodyType::dynamic && defB.type != BodyType::dynamic) return false;
    return passes(defA.shapes[a.shape].filter, defB.shapes[b.shape].filter) &&
           !ignored_.contains(inOrder(a.body, b.body));
}

template <class Visit>
void Overlaps::forEachOverlap(Visit&& visit) const {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const demos::Box3& a = parts_[i].bounds;
        for (std::size_t j = i + 1; j < parts_.size() && parts_[j].bounds.lower.x <= a.upper.x; ++j) {
            const demos::Box3& b = parts_[j].bounds;
            if (!meet(a.lower.y, a.upper.y, b.lower.y, b.upper.y) || !meet(a.lower.z, a.upper.z, b.lower.z, b.upper.z))
                continue;
            if (!mayMeet(parts_[i], parts_[j])) continue;
            if (const double depth = demos::overlapDepth(parts_[i].solid, parts_[j].solid); depth > 0)
                visit(parts_[i], parts_[j], depth);
        }
    }
}

}  // namespace ragtop::laws
