#include "scene_merge.h"

#include <algorithm>
#include <iterator>

namespace ragtop {
namespace {

template <class T>
void append(std::vector<T>& to, std::vector<T>&& from) {
    std::move(from.begin(), from.end(), std::back_inserter(to));
}

void adoptMaterials(Scene& from, Scene& to) {
    for (const auto& [name, material] : from.materials) {
        const auto [known, isNew] = to.materials.try_emplace(name, material);
        if (isNew || known->second == material) continue;
        const std::string longer = from.name + "/" + name;
        to.materials[longer] = material;
        for (SceneBody& body : from.bodies) {
            if (body.material == name) body.material = longer;
        }
    }
}

/// Indices of what comes after that of another scene.
class Shift {
public:
    explicit Shift(const Scene& by) : by_(by) {}

    void body(int& index) const {
        if (index >= 0) index += static_cast<int>(by_.bodies.size());
    }
    void part(ScenePart& part) const {
        switch (part.owner) {
            case ScenePart::Owner::ragdoll:
                part.index += static_cast<int>(by_.ragdolls.size());
                return;
            case ScenePart::Owner::robot:
                part.index += static_cast<int>(by_.robots.size());
                return;
            case ScenePart::Owner::vehicle:
                part.index += static_cast<int>(by_.vehicles.size());
                return;
            case ScenePart::Owner::none:
                return;
        }
    }

private:
    const Scene& by_;
};

}  // namespace

void appendScene(Scene&& from, Scene& to) {
    const Shift shift(to);
    for (SceneJoint& joint : from.joints) {
        shift.body(joint.bodyA), shift.body(joint.bodyB);
        shift.part(joint.partA), shift.part(joint.partB);
    }
    for (SceneCoupling& coupling : from.couplings)
        for (std::size_t& joint : coupling.joints) joint += to.joints.size();
    for (SceneAnimation& animation : from.animated) shift.body(animation.body), shift.body(animation.carrier);
    for (SceneCloth& cloth : from.cloths)
        for (SceneClothHold& hold : cloth.holds) shift.body(hold.body), shift.part(hold.part);
    for (SceneVehicle& vehicle : from.vehicles) {
        if (vehicle.driver) vehicle.driver->road += to.roads.size();
    }
    adoptMaterials(from, to);
    append(to.bodies, std::move(from.bodies));
    append(to.joints, std::move(from.joints));
    append(to.couplings, std::move(from.couplings));
    append(to.animated, std::move(from.animated));
    append(to.roads, std::move(from.roads));
    append(to.vehicles, std::move(from.vehicles));
    append(to.ragdolls, std::move(from.ragdolls));
    append(to.robots, std::move(from.robots));
    append(to.cloths, std::move(from.cloths));
    append(to.warnings, std::move(from.warnings));
    append(to.files, std::move(from.files));
}

}  // namespace ragtop
