#pragma once

#include "hatchback.h"

/// Suspensions for the wheels of the hatchback.
namespace ragtop {

inline LinkageDef frontStruts() {
    LinkageDef def;
    def.axle = 0;
    def.mcPherson = McPhersonDef{.lowerFront = {0.36f, 0.205f, 1.28f},
                                 .lowerRear = {0.36f, 0.205f, 1.00f},
                                 .lowerBall = {0.68f, 0.19f, 1.265f},
                                 .strutTop = {0.56f, 0.85f, 1.235f},
                                 .strutFoot = {0.61f, 0.45f, 1.245f}};
    def.tieRod = TieRodDef{.inner = {0.34f, 0.245f, 1.12f}, .outer = {0.66f, 0.235f, 1.12f}};
    def.spring = RodDef{.chassis = {0.56f, 0.85f, 1.235f}, .carrier = {0.61f, 0.45f, 1.245f}};
    def.mass = 15;
    return def;
}

inline LinkageDef rearArms() {
    LinkageDef def;
    def.axle = 1;
    def.trailingArm = TrailingArmDef{.inner = {0.45f, 0.30f, -0.85f}, .outer = {0.62f, 0.30f, -0.85f}};
    def.spring = RodDef{.chassis = {0.55f, 0.62f, -1.18f}, .carrier = {0.55f, 0.28f, -1.20f}};
    def.mass = 12;
    return def;
}

/// Arms and tie rod alike, level and across the car.
inline LinkageDef parallelWishbones() {
    LinkageDef def;
    def.axle = 0;
    def.doubleWishbone = DoubleWishboneDef{.lowerFront = {0.35f, 0.20f, 1.40f},
                                           .lowerRear = {0.35f, 0.20f, 1.12f},
                                           .lowerBall = {0.67f, 0.20f, 1.26f},
                                           .upperFront = {0.35f, 0.42f, 1.40f},
                                           .upperRear = {0.35f, 0.42f, 1.12f},
                                           .upperBall = {0.67f, 0.42f, 1.26f}};
    def.tieRod = TieRodDef{.inner = {0.35f, 0.30f, 1.12f}, .outer = {0.67f, 0.30f, 1.12f}};
    return def;
}

/// Of unlike lengths and slopes.
inline LinkageDef raceWishbones() {
    LinkageDef def = parallelWishbones();
    DoubleWishboneDef& arms = *def.doubleWishbone;
    arms.lowerFront.y = arms.lowerRear.y = 0.22f;
    arms.lowerBall = {0.70f, 0.18f, 1.27f};
    arms.upperFront = {0.42f, 0.41f, 1.36f};
    arms.upperRear = {0.42f, 0.40f, 1.10f};
    arms.upperBall = {0.65f, 0.44f, 1.24f};
    def.tieRod = TieRodDef{.inner = {0.36f, 0.25f, 1.13f}, .outer = {0.68f, 0.24f, 1.13f}};
    def.spring = RodDef{.chassis = {0.45f, 0.60f, 1.26f}, .carrier = {0.62f, 0.24f, 1.26f}};
    return def;
}

/// Three rods along and one across.
inline LinkageDef beamOnRods() {
    LinkageDef def;
    def.axle = 1;
    def.solidAxle = SolidAxleDef{};
    for (const float side : {0.45f, -0.45f})
        def.solidAxle->rods.push_back({{side, 0.26f, -0.76f}, {side, 0.26f, -1.26f}});
    def.solidAxle->rods.push_back({{0, 0.42f, -0.90f}, {0, 0.42f, -1.24f}});
    def.solidAxle->rods.push_back({{0.50f, 0.34f, -1.34f}, {-0.50f, 0.30f, -1.34f}});
    def.mass = 30;
    return def;
}

inline VehicleDef withLinkages(const std::vector<LinkageDef>& linkages) {
    VehicleDef def = hatchback();
    def.linkages = linkages;
    return def;
}

}  // namespace ragtop
