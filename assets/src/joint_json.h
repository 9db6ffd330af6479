#pragma once

#include "describe_json.h"
#include "json_value.h"
#include "ragtop/joint.h"

namespace ragtop {

/// The kind of a joint is a member of its object: "ball", "hinge" and so on, holding the fields of that
/// kind. Adds these members to the schema of the object.
void addJointKinds(Json& objectSchema);
/// Throws AssetError unless the object has exactly one kind. Bodies and frames are left alone.
JointDef readJointKind(const JsonValue& object);
void writeJointKind(const JointDef& joint, Json& object);
/// What is wrong with a joint whose bodies exist only in a world: any two will do.
std::string whyInvalidKind(JointDef joint);
/// Whether ranges or targets of a hinge or universal joint go beyond a whole turn. In scenes they may, but are mostly
/// degrees; threads turn often.
bool turnsOften(const JointDef& joint);

}  // namespace ragtop
