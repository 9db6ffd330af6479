#pragma once

#include <array>
#include <string_view>

namespace ragtop {

enum class Allowed { any, notNegative, positive };

/// A number, or several separated by blanks, in an attribute.
struct NumberRule {
    std::string_view element, attribute, unit;
    int count;
    Allowed allowed;
    bool required;
};

inline constexpr std::array kNumberRules{
    NumberRule{"mass", "value", "kg", 1, Allowed::notNegative, true},
    NumberRule{"inertia", "ixx", "kg m2", 1, Allowed::notNegative, true},
    NumberRule{"inertia", "iyy", "kg m2", 1, Allowed::notNegative, true},
    NumberRule{"inertia", "izz", "kg m2", 1, Allowed::notNegative, true},
    NumberRule{"inertia", "ixy", "kg m2", 1, Allowed::any, true},
    NumberRule{"inertia", "ixz", "kg m2", 1, Allowed::any, true},
    NumberRule{"inertia", "iyz", "kg m2", 1, Allowed::any, true},
    NumberRule{"origin", "xyz", "m", 3, Allowed::any, false},
    NumberRule{"origin", "rpy", "rad", 3, Allowed::any, false},
    NumberRule{"box", "size", "m", 3, Allowed::positive, true},
    NumberRule{"sphere", "radius", "m", 1, Allowed::positive, true},
    NumberRule{"cylinder", "radius", "m", 1, Allowed::positive, true},
    NumberRule{"cylinder", "length", "m", 1, Allowed::positive, true},
    NumberRule{"capsule", "radius", "m", 1, Allowed::positive, true},
    NumberRule{"capsule", "length", "m", 1, Allowed::notNegative, true},
    NumberRule{"mesh", "scale", "", 3, Allowed::any, false},
    NumberRule{"axis", "xyz", "", 3, Allowed::any, true},
    NumberRule{"limit", "lower", "rad or m", 1, Allowed::any, false},
    NumberRule{"limit", "upper", "rad or m", 1, Allowed::any, false},
    NumberRule{"limit", "effort", "N m or N", 1, Allowed::notNegative, true},
    NumberRule{"limit", "velocity", "rad/s or m/s", 1, Allowed::notNegative, true},
    NumberRule{"dynamics", "damping", "N m s/rad or N s/m", 1, Allowed::notNegative, false},
    NumberRule{"dynamics", "friction", "N m or N", 1, Allowed::notNegative, false},
    NumberRule{"safety_controller", "soft_lower_limit", "rad or m", 1, Allowed::any, false},
    NumberRule{"safety_controller", "soft_upper_limit", "rad or m", 1, Allowed::any, false},
    NumberRule{"safety_controller", "k_position", "1/s", 1, Allowed::notNegative, false},
    NumberRule{"safety_controller", "k_velocity", "N m s/rad or N s/m", 1, Allowed::notNegative, true},
    NumberRule{"mimic", "multiplier", "", 1, Allowed::any, false},
    NumberRule{"mimic", "offset", "rad or m", 1, Allowed::any, false},
};

}  // namespace ragtop
