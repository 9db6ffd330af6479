#include "role_names.h"

namespace ragtop {

const std::vector<std::string>& enumNames(BodyRole) {
    static const std::vector<std::string> names{"other", "pelvis", "abdomen", "chest", "head", "upperArm", "forearm",
                                                "hand",  "thigh",  "shank",   "foot",  "neck", "tail",     "wing"};
    return names;
}

const std::vector<std::string>& enumNames(BodySide) {
    static const std::vector<std::string> names{"middle", "left", "right"};
    return names;
}

}  // namespace ragtop
