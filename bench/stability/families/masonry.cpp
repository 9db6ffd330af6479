#include "masonry.h"

#include <span>

#include "../extremes.h"
#include "../families.h"

namespace ragtop::stability {

int Masonry::addStone(const std::vector<std::vector<DVec3>>& parts, float density) {
    if (scene.bodies.empty()) addFloor(scene, material);
    // Hulls are in single precision: their corners are relative to the middle of the stone.
    DVec3 middle;
    double corners = 0;
    for (const auto& part : parts)
        for (const DVec3& corner : part) {
            middle = middle + corner;
            ++corners;
        }
    middle = (1 / corners) * middle;
    BodyDef def;
    def.pose.position = middle;
    for (const auto& part : parts) {
        std::vector<Vec3> local;
        for (const DVec3& corner : part) local.push_back(relative(corner, middle));
        def.shapes.push_back({.geometry = ConvexHull{local}, .density = density, .material = material});
    }
    const MassProperties mass = massOf(def);
    limit.addBlock(kGravity * static_cast<double>(mass.mass), middle + mass.center);
    stones.push_back(add(scene, std::move(def)));
    return static_cast<int>(stones.size()) - 1;
}

int Masonry::addSlab(const std::vector<DVec3>& corners, double depth) {
    std::vector<DVec3> solid;
    for (const DVec3& corner : corners)
        for (const double z : {-depth / 2, depth / 2}) solid.push_back({corner.x, corner.y, z});
    return addStone({solid});
}

std::vector<DVec3> edgeJoint(const DVec3& p, const DVec3& q, double depth) {
    std::vector<DVec3> points;
    for (const DVec3& end : {p, q})
        for (const double z : {-depth / 2, depth / 2}) points.push_back({end.x, end.y, z});
    return points;
}

Survival survive(Run& run, const std::vector<int>& stones, double seconds, double limit) {
    Survival result;
    run.advance(seconds, [&] {
        for (const int stone : stones) result.moved = larger(result.moved, run.moved(stone));
        if (!(result.moved < limit)) return false;
        result.time = run.time();
        return true;
    });
    return result;
}

Family masonry() {
    Family family{"masonry", {}};
    addArchCases(family);
    addDomeCases(family);
    addCardCases(family);
    return family;
}

}  // namespace ragtop::stability
