#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "ragtop/asset_error.h"
#include "ragtop/character.h"
#include "ragtop/ragdoll.h"
#include "ragtop/vehicle_def.h"

/// Models to look at, cooked into files that any viewer opens and that the poses of bodies can drive.
namespace ragtop {

/// A node of a cooked model that follows a body. What it hangs on stays at the origin, so that its place in the model
/// is its place in the world: give it the pose of the part, the chassis or the wheel (WheelTelemetry::pose), and its
/// children come along.
struct VisualNode {
    std::string name{};  ///< in the file; no other node has it
    int index = -1;      ///< of a skin: the part of the ragdoll; of a car: the wheel, −1 the chassis
};

/// A model as binary glTF 2.0 that refers to no other file, in metres, at rest.
struct Visual {
    std::vector<std::byte> glb{};
    std::vector<VisualNode> nodes{};
    std::vector<std::string> warnings{};  ///< such as textures that are left out
};

/// The meshes of a rigged character, to be moved by a ragdoll made from it. Bones are joints of their names; one that
/// is simulated has the pose of its part, any other one keeps its place on the part that carries it. Bones that the
/// ragdoll does not know join the bone before them. Throws AssetError: the file is not usable, has no mesh, or none
/// of its bones is in the ragdoll.
Visual cookSkin(const std::filesystem::path& character, const RagdollDef& ragdoll,
                const CharacterOptions& options = {});

/// The model of a car that has a `visual`: a node "chassis" and, where the definition names wheels, nodes "wheel0",
/// "wheel1" … in its order, stretched to their radius and width. Throws AssetError: a file is not usable or has no
/// mesh or no such node; std::invalid_argument: the definition has no `visual`.
Visual cookCar(const VehicleDef& def);

}  // namespace ragtop
