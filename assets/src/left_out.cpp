#include "left_out.h"

#include <algorithm>

namespace ragtop {

void LeftOut::note(const std::string& list, const Json& element) {
    if (list == "include") anything_ = true;
    if (!element.is_object()) return;
    const bool repeats = element.contains("body") && element.at("body").is_object();
    const Json& named = repeats ? element.at("body") : element;
    const bool isGenerator = list == "walls" || list == "houses" || list == "towers" || list == "stairs";
    const bool isGrid = !repeats && element.contains("count");  // of "dog": "dog 1", "dog 2"
    for (const auto& member : named.items()) {
        // The name itself may be misspelled.
        const bool isName = member.key() == "name" || !named.contains("name");
        if (!isName || !member.value().is_string()) continue;
        const std::string name = member.value().get<std::string>();
        if (isGenerator || isGrid) beginnings_.insert(name + " ");
        if (!isGenerator) names_[list == "joints" ? kJoints : kBodies].insert(name);
        if (list == "roads") names_[kRoads].insert(name);
    }
}

void LeftOut::noteMember(const std::string& key, const Json& value) {
    static const std::set<std::string> lists{"include", "materials", "bodies", "repeat", "walls",
                                             "houses",  "towers",    "stairs", "roads",  "joints"};
    if (value.is_structured() || lists.contains(key)) anything_ = true;
}

bool LeftOut::mayHave(const std::string& kind, const std::string& name) const {
    if (anything_ || count(kind, name) > 0) return true;
    const auto begins = [&](const std::string& one) { return name.starts_with(one); };
    return kind == kBodies && std::any_of(beginnings_.begin(), beginnings_.end(), begins);
}

std::size_t LeftOut::count(const std::string& kind, const std::string& name) const {
    const auto found = names_.find(kind);
    return found == names_.end() ? 0 : found->second.count(name);
}

}  // namespace ragtop
