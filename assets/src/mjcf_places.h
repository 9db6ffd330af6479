#pragma once

#include <string>

#include "mjcf_text.h"
#include "ragtop/math.h"

namespace ragtop {

/// What <compiler> says about angles and more.
struct MjcfCompiler {
    bool degrees = true;
    std::string eulerOrder = "xyz";  ///< capitals turn about the parent's axes
    std::string meshFolder;
    bool massFromShapes = false;  ///< even of bodies that have an <inertial>

    double radians(double angle) const;
};

void readCompiler(const MjcfElement& element, MjcfCompiler& compiler);

/// By pos and one of quat, axisangle, euler, xyaxes, zaxis.
Frame placeOf(const MjcfElement& element, const MjcfCompiler& compiler);
/// The direction of an attribute of three numbers; throws AssetError where it has none.
Vec3 directionOf(const MjcfElement& element, const char* attribute, const Vec3& otherwise);
Vec3 pointOf(const MjcfElement& element, const char* attribute);

}  // namespace ragtop
