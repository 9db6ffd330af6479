#pragma once

#include <string>
#include <vector>

#include "gltf/physics_format.h"
#include "ragtop/joint.h"

namespace ragtop {

/// A joint of the kind that has the freedoms which the limits leave.
struct JointFromGltf {
    JointDef joint{};  ///< without bodies
    Quat turn{};       ///< of its frames in those of the file: its x axis is the hinge, slide or cone axis
    std::vector<std::string> lost{};  ///< what it does not do as the file says, as "has …"
};

JointFromGltf jointFromGltf(const GltfJoint& from);

/// The same joint seen from its other body.
GltfJoint reversed(GltfJoint joint);

/// What of a joint the extension can say: its freedoms, ranges, soft ends and springs, of reach polygons and ellipses
/// the widest cone. Threads, curves, motors and friction are left to who writes the file.
GltfJoint gltfFromJoint(const JointDef& joint);

}  // namespace ragtop
