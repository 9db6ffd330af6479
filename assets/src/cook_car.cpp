#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "ragtop/visual.h"
#include "visual_builder.h"

namespace ragtop {
namespace {

/// A model file in metres with Y up, and its frame put where the definition wants it.
struct Model {
    ImportedScene scene;
    std::vector<Affine> places;  ///< of its nodes
};

Model loadModel(const std::string& file, const Frame& frame, float scale) {
    Model model{importScene(file, ImportedDetail::looks), {}};
    const UpAxis up = model.scene.upAxis < 0 ? UpAxis::y : static_cast<UpAxis>(model.scene.upAxis);
    const double unit = model.scene.unitScale > 0 ? model.scene.unitScale : 1.0;
    Affine inChassis{
        {rotate(frame.rotation, {1, 0, 0}), rotate(frame.rotation, {0, 1, 0}), rotate(frame.rotation, {0, 0, 1})},
        frame.position};
    inChassis = inChassis * uprightScaling(up, static_cast<float>(unit) * scale);
    for (const Affine& place : globalTransforms(model.scene)) model.places.push_back(inChassis * place);
    return model;
}

constexpr int kBodywork = -1;

/// For each node the wheel that it belongs to, with all below it; kBodywork for the others.
std::vector<int> wheelsOfNodes(const Model& model, const VehicleVisualDef& visual) {
    const auto& names = visual.wheelNodes;
    std::vector<int> wheels(model.scene.nodes.size(), kBodywork);
    std::vector<bool> found(names.size(), false);
    for (std::size_t i = 0; i < wheels.size(); ++i) {
        const ImportedNode& node = model.scene.nodes[i];
        if (node.parent >= 0) wheels[i] = wheels[static_cast<std::size_t>(node.parent)];
        const auto named = std::find(names.begin(), names.end(), node.name);
        if (named == names.end()) continue;
        wheels[i] = static_cast<int>(named - names.begin());
        found[static_cast<std::size_t>(wheels[i])] = true;
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!found[i])
            throw AssetError(visual.chassis, "", fmt::format("has no node '{}', a wheel of the vehicle", names[i]));
    }
    return wheels;
}

/// The surfaces of those meshes that `wanted` says by node.
template <class Wanted>
std::vector<VisualSurface> surfacesOf(const Model& model, Wanted wanted) {
    std::vector<VisualSurface> surfaces = emptySurfaces(model.scene);
    for (const ImportedMesh& mesh : model.scene.meshes) {
        for (const std::int32_t node : mesh.nodes) {
            const auto at = static_cast<std::size_t>(node);
            if (wanted(at)) surfaceFor(mesh, surfaces).append(mesh, model.places[at]);
        }
    }
    return surfaces;
}

/// Moves the middle of a wheel to the origin and stretches it to unit radius and width. False when it is flat.
bool makeUnitWheel(std::vector<VisualSurface>& surfaces) {
    std::vector<Vec3> corners;
    for (const VisualSurface& surface : surfaces)
        corners.insert(corners.end(), surface.vertices.begin(), surface.vertices.end());
    if (corners.empty()) return false;
    Vec3 lower = corners[0], upper = corners[0];
    for (const Vec3& p : corners) lower = min(lower, p), upper = max(upper, p);
    const Vec3 size = upper - lower, middle = 0.5f * (lower + upper);
    if (!(size.x > 0 && size.y > 0 && size.z > 0)) return false;
    const Vec3 scale{1 / size.x, 2 / size.y, 2 / size.z};
    for (VisualSurface& surface : surfaces) {
        for (Vec3& p : surface.vertices)
            p = {scale.x * (p.x - middle.x), scale.y * (p.y - middle.y), scale.z * (p.z - middle.z)};
        for (Vec3& n : surface.normals) n = normalized({n.x / scale.x, n.y / scale.y, n.z / scale.z}, {0, 1, 0});
    }
    return true;
}

class CarCooker {
public:
    explicit CarCooker(const VehicleDef& def) : def_(def), visual_(*def.visual) {}

    Visual cook() {
        const Model model = loadModel(visual_.chassis, visual_.frame, visual_.scale);
        const std::vector<int> wheels = wheelsOfNodes(model, visual_);
        const int materials = addMaterials(model);
        const int chassis =
            builder_.addMesh(surfacesOf(model, [&](std::size_t n) { return wheels[n] == kBodywork; }), materials);
        if (chassis < 0) throw AssetError(visual_.chassis, "", "has no mesh to look at");
        result_.nodes.push_back({builder_.nameOf(builder_.addNode("chassis", {}, chassis)), kBodywork});
        for (std::size_t i = 0; i < visual_.wheelNodes.size(); ++i) {
            const auto ofWheel = [&](std::size_t n) { return wheels[n] == static_cast<int>(i); };
            addWheel(i, addWheelMesh(visual_.chassis, surfacesOf(model, ofWheel), materials), {});
        }
        if (!visual_.wheel.empty()) addEqualWheels();
        result_.glb = builder_.finish(visual_.chassis);
        return std::move(result_);
    }

private:
    int addMaterials(const Model& model) {
        result_.warnings.insert(result_.warnings.end(), model.scene.warnings.begin(), model.scene.warnings.end());
        return builder_.addMaterials(model.scene);
    }

    int addWheelMesh(const std::string& file, std::vector<VisualSurface> surfaces, int materials) {
        if (!makeUnitWheel(surfaces)) throw AssetError(file, "", "has a wheel without a mesh of some width");
        return builder_.addMesh(surfaces, materials);
    }

    /// All wheels from one model; those on the right are turned, so that its outside is outside there too.
    void addEqualWheels() {
        const Model model = loadModel(visual_.wheel, {}, 1);
        const int mesh =
            addWheelMesh(visual_.wheel, surfacesOf(model, [](std::size_t) { return true; }), addMaterials(model));
        const Quat halfTurn{0, 1, 0, 0};
        for (std::size_t i = 0; i < def_.wheels.size(); ++i) {
            addWheel(i, mesh, def_.wheels[i].position.x < 0 ? halfTurn : Quat{});
        }
    }

    void addWheel(std::size_t i, int mesh, const Quat& turn) {
        const WheelDef& wheel = def_.wheels[i];
        const int node = builder_.addNode(fmt::format("wheel{}", i), {wheel.position, {}});
        builder_.addChild(node, "(wheel)", {{}, turn}, mesh, {wheel.width, wheel.radius, wheel.radius});
        result_.nodes.push_back({builder_.nameOf(node), static_cast<int>(i)});
    }

    const VehicleDef& def_;
    const VehicleVisualDef& visual_;
    VisualBuilder builder_;
    Visual result_;
};

}  // namespace

Visual cookCar(const VehicleDef& def) {
    if (!def.visual) throw std::invalid_argument("visual is absent, must name the model of the car");
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) throw std::invalid_argument(wrong);
    return CarCooker(def).cook();
}

}  // namespace ragtop
