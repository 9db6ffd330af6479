#include "draped.h"

#include <utility>

namespace ragtop::live {
namespace {

constexpr Color kFabric = 0x8c2f39;

}  // namespace

Draped::Draped(const Cast& cast, const DVec3& origin) : cast_(cast), origin_(origin) {}

Json Draped::describe() const {
    std::vector<Vec3> all;
    readPoints(all);
    Json cloths = Json::array();
    std::size_t first = 0;
    for (const CastCloth& each : cast_.cloths) {
        const ClothDef& def = each.cloth->def();
        Json positions = Json::array(), indices = Json::array(), lines = Json::array();
        for (std::size_t i = 0; i < def.points.size(); ++i)
            for (int axis = 0; axis < 3; ++axis) positions.push_back(number(all[first + i][axis]));
        for (const ClothFace& face : def.faces) {
            for (const int corner : {face.a, face.b, face.c}) indices.push_back(corner);
            if (face.d < 0) continue;
            for (const int corner : {face.a, face.c, face.d}) indices.push_back(corner);
        }
        for (const ClothLine& line : def.lines) lines.push_back(line.a), lines.push_back(line.b);
        first += def.points.size();
        cloths.push_back({{"name", each.name},
                          {"color", each.color.value_or(kFabric)},
                          {"positions", std::move(positions)},
                          {"indices", std::move(indices)},
                          {"lines", std::move(lines)}});
    }
    return cloths;
}

void Draped::update(std::uint32_t step) {
    if (cast_.cloths.empty()) return;
    std::vector<Vec3> now;
    readPoints(now);
    if (now == points_) return;
    points_ = std::move(now);
    ++sequence_;
    frame_ = encodePoints(points_, step);
}

void Draped::readPoints(std::vector<Vec3>& all) const {
    std::vector<DVec3> places;
    for (const CastCloth& each : cast_.cloths) {
        places.resize(static_cast<std::size_t>(each.cloth->pointCount()));
        each.cloth->readPoints(places);
        for (const DVec3& place : places) all.push_back(relative(place, origin_));
    }
}

}  // namespace ragtop::live
