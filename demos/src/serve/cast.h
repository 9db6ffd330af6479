#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ragtop/cloth.h"
#include "ragtop/debug_draw.h"
#include "ragtop/id.h"
#include "ragtop/math.h"
#include "ragtop/ragdoll.h"
#include "ragtop/vehicle.h"

namespace ragtop {
class World;
}

/// The live session that a page watches and drives.
namespace ragtop::live {

/// How a body is called and drawn.
struct Look {
    std::string name{};
    std::optional<Color> color{};  ///< empty: by its type
};

struct CastVehicle {
    std::string name{};
    Vehicle* vehicle = nullptr;
    VehiclePlacement start{};  ///< where a reset puts it
};

struct CastRagdoll {
    std::string name{};
    const Ragdoll* ragdoll = nullptr;
};

struct CastCloth {
    std::string name{};
    const Cloth* cloth = nullptr;
    std::optional<Color> color{};
};

/// A model that is drawn instead of bodies and wheels.
struct CastVisual {
    enum class Kind { skin, car } kind = Kind::skin;
    std::string file{};                  ///< its name under /visual/
    std::size_t index = 0;               ///< of the ragdoll or vehicle
    std::map<std::string, int> nodes{};  ///< name in the file: the part of the ragdoll; the wheel, −1 the chassis
};

/// The centre line of a road.
struct CastRoad {
    std::string name{};
    bool closed = true;
    float width = 0;
    std::vector<DVec3> line{};
};

struct CastCamera {
    DVec3 target{}, eye{};
};

/// A world and who plays in it.
struct Cast {
    World* world = nullptr;
    double step = 1.0 / 60;  ///< s
    std::string name{}, description{};
    std::vector<std::string> warnings{};
    std::vector<CastVehicle> vehicles{};
    std::vector<CastRagdoll> ragdolls{};
    std::vector<CastCloth> cloths{};
    std::vector<CastVisual> visuals{};
    std::vector<CastRoad> roads{};
    std::function<Look(BodyId)> look{};
    std::optional<CastCamera> camera{};
    /// Before each step; vehicles that are true in `driven` are left alone. Depends on the world alone, or seeking back
    /// is not exact.
    std::function<void(const std::vector<bool>& driven)> beforeStep{};
};

}  // namespace ragtop::live
