#include "trees.h"

#include <algorithm>

namespace ragtop::stability {
namespace {

bool isFixed(const PeerBodies& bodies, int body) { return body == kWorld || bodies.def(body).type == BodyType::fixed; }

}  // namespace

Trees::Trees(const Scene& scene, const PeerBodies& bodies) : Trees(bodies) {
    std::vector<bool> reached(nodes_.size());
    std::vector<int> front{kWorld};
    for (int i = 0; i < bodies.count(); ++i)
        if (isFixed(bodies, i)) front.push_back(i);
    grow(scene, bodies, std::move(front), reached);
    for (int i = 0; i < bodies.count(); ++i)
        if (!isFixed(bodies, i) && !reached[static_cast<std::size_t>(i)]) grow(scene, bodies, {i}, reached);
}

void Trees::grow(const Scene& scene, const PeerBodies& bodies, std::vector<int> front, std::vector<bool>& reached) {
    const auto mark = [&](int body) { reached[static_cast<std::size_t>(body)] = true; };
    for (const int body : front)
        if (body != kWorld) mark(body);
    for (std::size_t k = 0; k < front.size(); ++k)
        for (std::size_t i = 0; i < scene.joints.size(); ++i) {
            const SceneJoint& joint = scene.joints[i];
            if (joint.bodyA != front[k] && joint.bodyB != front[k]) continue;
            const int other = joint.bodyA == front[k] ? joint.bodyB : joint.bodyA;
            if (isFixed(bodies, other) || reached[static_cast<std::size_t>(other)]) continue;
            mark(other);
            TreeNode& hung = nodes_[static_cast<std::size_t>(other)];
            hung.parent = front[k];
            hung.joint = static_cast<int>(i);
            if (front[k] != kWorld) nodes_[static_cast<std::size_t>(front[k])].children.push_back(other);
            front.push_back(other);
        }
}

bool Trees::has(int joint) const {
    return std::ranges::any_of(nodes_, [joint](const TreeNode& each) { return each.joint == joint; });
}

std::vector<int> Trees::parentsFirst() const {
    std::vector<int> order;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
        if (nodes_[i].parent == kWorld) order.push_back(static_cast<int>(i));
    for (std::size_t k = 0; k < order.size(); ++k) {
        const std::vector<int>& children = node(order[k]).children;
        order.insert(order.end(), children.begin(), children.end());
    }
    return order;
}

bool isFree(const BallDef& ball) {
    return !ball.swingLimit && !ball.swingEllipse && !ball.swingPyramid && !ball.reach && !ball.twistLimit &&
           !ball.spring && ball.friction == 0 && !ball.bearing;
}

bool isFree(const HingeDef& hinge) {
    return !hinge.limit && !hinge.spring && !hinge.motor && hinge.friction == 0 && isPlain(hinge);
}

}  // namespace ragtop::stability
