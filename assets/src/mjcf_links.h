#pragma once

#include <map>
#include <string>
#include <vector>

#include "mjcf_geoms.h"
#include "mjcf_places.h"
#include "mjcf_text.h"
#include "robot_document.h"

namespace ragtop {

/// What a coordinate is of those that the file counts with: x = sign-free difference from what it calls home.
struct MjcfJoint {
    int link = -1;
    double reference = 0;  ///< rad or m that the file calls the coordinate where the bodies stand as they are written
    int positions = 1;     ///< numbers that a keyframe has of it
    bool isTurn = true;    ///< rad
};

/// The tree of bodies as links, and what other elements refer to by name.
struct MjcfTree {
    std::map<std::string, int> bodies;          ///< link by name of body
    std::map<std::string, std::size_t> byName;  ///< joint by name
    std::vector<MjcfJoint> joints;              ///< in the order of the file
    std::map<std::string, std::string> meshFiles;
    int armatures = 0, meshesWithoutMass = 0;
};

/// Adds the links of all bodies below <worldbody> to `robot`, whose first link is the world.
void readBodies(MjcfText& text, const MjcfCompiler& compiler, MjcfTree& tree, ImportedRobot& robot);

}  // namespace ragtop
