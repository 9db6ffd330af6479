#pragma once

#include <vector>

#include "describe_json.h"
#include "ragtop/math.h"

namespace ragtop {

using Names = std::vector<const char*>;

/// Where a thing stands: turned by `rotation`, then by `heading` about y.
struct PlaceInFile {
    DVec3 position{};
    Quat rotation{};
    float heading = 0;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const PlaceInFile*) {
    visit(Tunable{"position", "m", -1e9, 1e9, "where it stands"}, self.position);
    visit(Tunable{"rotation", "", 0, 0, "how it is turned"}, self.rotation);
    visit(Tunable{"heading", "rad", -kWholeTurn, kWholeTurn, "turn about y after that; 0 looks along +z"},
          self.heading);
}

}  // namespace ragtop
