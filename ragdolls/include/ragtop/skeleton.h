#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ragtop/math.h"

/// A tree of named bones at rest. Model space is in metres with Y up; it need not be at the origin of the world.
namespace ragtop {

struct Bone {
    std::string name{};
    int parent = -1;  ///< index of an earlier bone; −1: none
    Frame bind{};     ///< of the bone at rest, in model space
};

struct Skeleton {
    std::vector<Bone> bones{};  ///< parents before children
    /// Empty, or for each bone the vertices of the skin that follow it the most, at rest, m, in model space.
    std::vector<std::vector<Vec3>> skin{};

    /// Index of the bone of that name, −1 when there is none.
    int find(std::string_view name) const;
};

/// The corners of everything known about the skeleton at rest: its joints, and its skin where it has one.
Bounds boundsOf(const Skeleton& skeleton);

/// Empty when the skeleton is usable; otherwise names the bone, its value and what is allowed.
std::string whyInvalid(const Skeleton& skeleton);

}  // namespace ragtop
