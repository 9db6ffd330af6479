#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ragtop/anatomy.h"

namespace ragtop {

/// A part that gets a share of the mass.
struct MassPart {
    BodyRole role = BodyRole::other;
    BodySide side = BodySide::middle;
    double volume = 0;  ///< m³, of its shape
};

struct MassWish {
    bool human = false;
    double femaleShare = 0;
    double bodyMassIndex = 0;        ///< kg/m², for the mass of a human that is not given
    double height = 0;               ///< m
    std::optional<double> bodyMass;  ///< kg
};

struct Masses {
    std::vector<double> mass;  ///< kg, one per part
    double departure = 0;      ///< 0: by the table of humans, 1: by volume
    std::string note;          ///< where not all densities are within bounds
};

/// How a body's mass is shared among its parts: of human proportions by the table, more by volume the more it departs
/// from them, of others by volume; and no part lighter or heavier for its volume than flesh and what it may wear.
/// The sum is that asked for, up to rounding.
Masses shareMass(std::span<const MassPart> parts, const MassWish& wish);

}  // namespace ragtop
