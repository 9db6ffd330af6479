#include "nearby.h"

#include <functional>

#include "ragtop/world.h"

namespace ragtop {

QueryFilter queryOf(const Filter& filter, BodyId chassis) {
    return {.category = filter.category, .mask = filter.mask, .ignore = chassis};
}

QueryFilter Nearby::among(const World& world, const QueryFilter& query, const Bounds& bounds) {
    count_ = 0;
    bool all = true;
    const auto take = [&](ShapeId shape) {
        all = count_ < kMost;
        if (all) shapes_[count_++] = shape;
        return all;
    };
    world.overlap(bounds, std::ref(take), query);  // a function of one pointer takes no memory
    QueryFilter those = query;
    if (all) those.among = std::span<const ShapeId>(shapes_).first(count_);
    return those;
}

}  // namespace ragtop
