#pragma once

#include <vector>

#include "json_value.h"
#include "left_out.h"
#include "ragtop/scene.h"
#include "scene_file.h"

namespace ragtop {

/// What a driver does; fails where an action comes before the one before it.
std::vector<DriverAction> scriptOf(const std::vector<ActionInFile>& in, const JsonValue& at);

/// Fails, with the reason, where the body cannot be a puppet.
void needStanding(const RagdollDef& def, const JsonValue& at);

/// Fails where the body cannot stand, or has no such part as the pose turns.
void needParts(const RagdollDef& def, const std::vector<PartAngles>& pose, const JsonValue& at);

/// Fails where the world would refuse it.
void needUsable(const SceneCoupling& coupling, const JsonValue& at);

/// What strikes a ragdoll; fails where it has no such part or a blow comes before the one before it.
std::vector<SceneBlow> blowsOf(const std::vector<BlowInFile>& in, const RagdollDef& def, const JsonValue& at);

/// The number of a part of that name; fails where there is none.
int partNamed(const RagdollDef& def, const std::string& name, const JsonValue& at);

/// The part of a ragdoll, link of a robot or chassis that `name` means, as "ragdoll/part", "robot/link" or "vehicle";
/// none where it could only be a body. Fails where there is no such part.
ScenePart partOfScene(const Scene& scene, const std::string& name, const LeftOut& left, const JsonValue& at);

/// Where a part is at the start.
Pose placeOf(const Scene& scene, const ScenePart& part);

}  // namespace ragtop
