#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cast.h"
#include "frame_encoder.h"
#include "hand.h"
#include "json.h"
#include "ragtop/body.h"
#include "ragtop/shape.h"

namespace ragtop::live {

/// "static", "kinematic" or "dynamic".
const char* typeName(BodyType type);

/// What a page draws: one node per body and per wheel, with its shapes. A body keeps its number while the world lives,
/// also when it is gone and comes back with a restored state.
class Nodes {
public:
    /// Poses are told relative to `origin`.
    Nodes(const Cast& cast, const Hand& hand, const DVec3& origin);

    /// Takes up bodies that came or went. A `nodes` message, or null when nothing changed. When `timeline` has changed,
    /// ids of bodies that are gone may come to name others.
    Json refresh(std::uint64_t timeline);

    const Json& geometries() const { return geometries_; }
    /// All nodes as they are now.
    Json describe() const;
    Json vehicles() const;
    Json ragdolls() const;
    Json visuals() const;

    std::span<const NodePose> poses();

    /// Null when the node is no body of the world now.
    BodyId body(std::uint32_t node) const;
    std::optional<std::uint32_t> node(BodyId body) const;
    /// Its name, for people.
    const std::string& name(std::uint32_t node) const { return known_[node].name; }
    std::span<const BodyId> bodies() const { return present_; }

private:
    struct Node {
        BodyId body{};
        int vehicle = -1, wheel = -1;  // of a wheel
        std::string name{};
        std::string type{};
        Color color = 0;
        Json parts = Json::array();
        bool hidden = false;
    };

    std::uint32_t add(BodyId body);
    void addWheels();
    void hide();
    void addPart(const Shape& shape, const Frame& frame, Json& parts);
    std::size_t geometry(const Shape& shape);
    Json describe(std::uint32_t node) const;
    Pose poseOf(const Node& node) const;

    const Cast& cast_;
    const Hand& hand_;
    DVec3 origin_;
    std::vector<Node> known_;                         // by number
    std::map<BodyId, std::uint32_t> numbers_;         // of bodies that are there or may come back
    std::vector<BodyId> present_;                     // as the world lists them
    std::vector<std::uint32_t> presentNodes_;         // the same
    std::vector<std::vector<std::uint32_t>> wheels_;  // by vehicle
    std::vector<NodePose> poses_;
    Json geometries_ = Json::array();
    std::map<std::string, std::size_t> geometryOf_;
    std::uint64_t timeline_ = 0;
};

}  // namespace ragtop::live
