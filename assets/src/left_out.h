#pragma once

#include <map>
#include <set>
#include <string>

#include "json_document.h"

namespace ragtop {

/// Names of the parts of a scene file that are left out because something about them is wrong. Who refers to them has
/// no fault of its own.
class LeftOut {
public:
    /// Kinds of things whose names others refer to.
    static constexpr const char* kBodies = "named bodies";
    static constexpr const char* kJoints = "named joints";
    static constexpr const char* kRoads = "roads";

    /// An element of a list of the scene.
    void note(const std::string& list, const Json& element);
    /// A member of the scene that may have named things, all of which are left out.
    void noteMember(const std::string& key, const Json& value);

    bool isAnything() const { return anything_; }
    bool mayHave(const std::string& kind, const std::string& name) const;
    std::size_t count(const std::string& kind, const std::string& name) const;

private:
    bool anything_ = false;
    std::map<std::string, std::multiset<std::string>> names_;
    std::set<std::string> beginnings_;  ///< of names of bodies
};

}  // namespace ragtop
