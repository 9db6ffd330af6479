#include "shrink.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace ragtop::laws {
namespace {

/// Without the bodies from `begin` to `end`, and without what refers to them; nothing where that would leave out body 0
/// or one that is moved.
std::optional<Drawn> withoutBodies(const Drawn& drawn, std::size_t begin, std::size_t end) {
    const auto gone = [&](int body) { return body >= static_cast<int>(begin) && body < static_cast<int>(end); };
    for (const Shaker& shaker : drawn.shakers)
        if (gone(shaker.body)) return std::nullopt;
    for (const Ride& ride : drawn.rides)
        if (gone(ride.body)) return std::nullopt;
    Drawn rest = drawn;
    Scene& scene = rest.scene;
    scene.bodies.erase(scene.bodies.begin() + static_cast<std::ptrdiff_t>(begin),
                       scene.bodies.begin() + static_cast<std::ptrdiff_t>(end));
    std::erase_if(scene.joints, [&](const SceneJoint& joint) { return gone(joint.bodyA) || gone(joint.bodyB); });
    const auto renamed = [&](int body) {
        return body >= static_cast<int>(end) ? body - static_cast<int>(end - begin) : body;
    };
    for (SceneJoint& joint : scene.joints) joint.bodyA = renamed(joint.bodyA), joint.bodyB = renamed(joint.bodyB);
    for (Shaker& shaker : rest.shakers) shaker.body = renamed(shaker.body);
    for (Ride& ride : rest.rides) ride.body = renamed(ride.body);
    return rest;
}

std::optional<Drawn> withoutJoints(const Drawn& drawn, std::size_t begin, std::size_t end) {
    Drawn rest = drawn;
    std::vector<SceneJoint>& joints = rest.scene.joints;
    joints.erase(joints.begin() + static_cast<std::ptrdiff_t>(begin), joints.begin() + static_cast<std::ptrdiff_t>(end));
    return rest;
}

using Without = std::optional<Drawn> (*)(const Drawn&, std::size_t, std::size_t);

/// Leaves out parts of `first` … `count` elements, the last ones first; true when something could be left out.
bool leaveOut(Drawn& drawn, std::size_t first, std::size_t count, Without without,
              const std::function<bool(const Drawn&)>& fails, int& most) {
    bool less = false;
    for (std::size_t part = (count - first) / 2; part >= 1; part /= 2) {
        for (std::size_t end = count; end >= first + part && most > 0; end -= part) {
            if (end > count) continue;
            std::optional<Drawn> rest = without(drawn, end - part, end);
            if (!rest || (--most, !fails(*rest))) continue;
            drawn = std::move(*rest);
            count -= part;
            less = true;
        }
    }
    return less;
}

}  // namespace

Drawn shrunk(Drawn drawn, const std::function<bool(const Drawn&)>& fails, int most) {
    if (drawn.stands || drawn.falls) return drawn;  // what is left falls for want of what it stood on
    bool less = true;
    while (less && most > 0) {
        less = leaveOut(drawn, 1, drawn.scene.bodies.size(), withoutBodies, fails, most);
        less |= leaveOut(drawn, 0, drawn.scene.joints.size(), withoutJoints, fails, most);
    }
    return drawn;
}

}  // namespace ragtop::laws
