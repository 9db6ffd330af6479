#include "look.h"

#include <cstdint>
#include <iterator>

namespace ragtop::live {
namespace {

constexpr Color kBricks[] = {0xa8452f, 0xb5523a, 0x9c3f2b, 0xbd5f45};
constexpr Color kShirts[] = {0x3f7cac, 0xc8553d, 0x588157, 0xe0a458, 0x7b5ea7, 0xd9d4c7};
constexpr Color kTrousers[] = {0x2f3e56, 0x5b4a3b, 0x4a4e55};
constexpr Color kLinks[] = {0xd8dadc, 0x5c6670, 0xe07b30};  ///< painted steel, castings, covers
constexpr Color kVehicle = 0x2a6fdb, kSkin = 0xe8c39e, kShoes = 0x33302c;

/// A hash; the walls of a house are built in turns, so that a plain remainder would give each wall one tint.
std::uint32_t scatter(std::size_t i) {
    std::uint32_t x = static_cast<std::uint32_t>(i) * 0x9e3779b9u;
    x = (x ^ (x >> 15)) * 0x85ebca6bu;
    return x >> 16;
}

/// Clothes, other ones for each person.
Color colorOf(BodyRole role, std::size_t person) {
    switch (role) {
        case BodyRole::abdomen:
        case BodyRole::chest:
        case BodyRole::upperArm:
            return kShirts[scatter(person) % std::size(kShirts)];
        case BodyRole::pelvis:
        case BodyRole::thigh:
        case BodyRole::shank:
            return kTrousers[scatter(person + 1000) % std::size(kTrousers)];
        case BodyRole::foot:
            return kShoes;
        default:
            return kSkin;
    }
}

}  // namespace

std::map<BodyId, Look> looksOf(const Scene& scene, const SceneInstance& instance) {
    std::map<BodyId, Look> looks;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        Look& look = looks[instance.bodies[i]];
        look.name = scene.bodies[i].name;
        look.color = scene.bodies[i].color;
        if (!look.color && scene.bodies[i].masonry) look.color = kBricks[scatter(i) % std::size(kBricks)];
    }
    for (std::size_t i = 0; i < instance.vehicles.size(); ++i) {
        looks[instance.vehicles[i].chassis()] = {scene.vehicles[i].name, kVehicle};
    }
    for (std::size_t i = 0; i < instance.ragdolls.size(); ++i) {
        const Ragdoll& ragdoll = instance.ragdolls[i];
        for (std::size_t p = 0; p < ragdoll.bodies().size(); ++p) {
            const RagdollPart& part = ragdoll.def().parts[p];
            looks[ragdoll.bodies()[p]] = {scene.ragdolls[i].name + " " + part.name, colorOf(part.role, i)};
        }
    }
    for (std::size_t i = 0; i < instance.robots.size(); ++i) {
        const Robot& robot = *scene.robots[i].robot;
        for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
            looks[instance.robots[i].bodies[b]] = {scene.robots[i].name + " " + robot.bodies[b].name,
                                                   kLinks[b % std::size(kLinks)]};
        }
    }
    return looks;
}

}  // namespace ragtop::live
