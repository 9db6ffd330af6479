#pragma once

#include <variant>

#include "ragtop/joint.h"

namespace ragtop {

inline const JointBodies& bodiesOf(const JointDef& def) {
    return std::visit([](const auto& each) -> const JointBodies& { return each.bodies; }, def);
}

}  // namespace ragtop
