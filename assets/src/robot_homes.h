#pragma once

#include <string>
#include <vector>

#include "ragtop/joint_parts.h"
#include "robot_document.h"

namespace ragtop {

/// Has the joint ends within its range beyond which a spring pushes back?
bool hasSoftEnds(const ImportedRobotJoint& joint);
/// Ends of a joint, cut at what joints can have; from the soft ones where there are any.
Range hardRange(const ImportedRobotJoint& joint);
Range softRange(const ImportedRobotJoint& joint);

/// For each link that its joint follows another one: the link of that; −1: it follows none. Throws AssetError where
/// joints follow each other in a ring.
std::vector<int> followedLinks(const ImportedRobot& robot, const std::string& file, std::vector<std::string>& warnings);

/// For each link what its joint begins with, rad or m: zero where all ranges allow it, else what is nearest to it, so
/// that those that follow a joint are within their ranges too.
std::vector<float> homesOf(const ImportedRobot& robot, const std::vector<int>& followed,
                           std::vector<std::string>& warnings);

}  // namespace ragtop
