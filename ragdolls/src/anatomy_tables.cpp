#include "ragtop/anatomy.h"

namespace ragtop {

std::string_view nameOf(BodyRole role) {
    switch (role) {
        case BodyRole::other:
            break;
        case BodyRole::pelvis:
            return "pelvis";
        case BodyRole::abdomen:
            return "abdomen";
        case BodyRole::chest:
            return "chest";
        case BodyRole::head:
            return "head";
        case BodyRole::upperArm:
            return "upper arm";
        case BodyRole::forearm:
            return "forearm";
        case BodyRole::hand:
            return "hand";
        case BodyRole::thigh:
            return "thigh";
        case BodyRole::shank:
            return "shank";
        case BodyRole::foot:
            return "foot";
        case BodyRole::neck:
            return "neck";
        case BodyRole::tail:
            return "tail";
        case BodyRole::wing:
            return "wing";
    }
    return "other";
}

std::string_view nameOf(BodyPlan plan) {
    switch (plan) {
        case BodyPlan::other:
            break;
        case BodyPlan::human:
            return "human";
        case BodyPlan::quadruped:
            return "quadruped";
        case BodyPlan::bird:
            return "bird";
        case BodyPlan::hexapod:
            return "hexapod";
    }
    return "other";
}

std::string_view nameOf(BodySide side) {
    return side == BodySide::left ? "left" : side == BodySide::right ? "right" : "middle";
}

/// Per cent of the body's mass, men and women [de Leva, Adjustments to Zatsiorsky-Seluyanov's segment inertia
/// parameters, J. Biomechanics 29, 1996, table 4]. Each column sums to 100 with both sides counted; pelvis, abdomen
/// and chest are its lower, middle and upper trunk.
double massShare(BodyRole role, double femaleShare) {
    const auto blended = [&](double male, double female) { return 0.01 * (male + femaleShare * (female - male)); };
    switch (role) {
        case BodyRole::other:
        case BodyRole::neck:
        case BodyRole::tail:
        case BodyRole::wing:
            break;
        case BodyRole::pelvis:
            return blended(11.17, 12.47);
        case BodyRole::abdomen:
            return blended(16.33, 14.65);
        case BodyRole::chest:
            return blended(15.96, 15.45);
        case BodyRole::head:
            return blended(6.94, 6.68);
        case BodyRole::upperArm:
            return blended(2.71, 2.55);
        case BodyRole::forearm:
            return blended(1.62, 1.38);
        case BodyRole::hand:
            return blended(0.61, 0.56);
        case BodyRole::thigh:
            return blended(14.16, 14.78);
        case BodyRole::shank:
            return blended(4.33, 4.81);
        case BodyRole::foot:
            return blended(1.37, 1.29);
    }
    return 0;
}

}  // namespace ragtop
