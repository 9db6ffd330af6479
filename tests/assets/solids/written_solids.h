#pragma once

#include <string>
#include <vector>

#include "ragtop/shape.h"

/// Solids written down as closed surfaces, for what takes meshes apart or makes them simpler.
namespace ragtop::written {

struct Solid {
    std::string name;
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;

    TriangleMesh mesh() const { return TriangleMesh(vertices, triangles); }
};

/// Twenty: letters and furniture with flat faces, turned bodies, tubes, gears; 0.1 to 1 m large.
std::vector<Solid> twenty();
Solid byName(const std::string& name);

/// A ring of the radius, thick by the other; `around` by `across` corners.
Solid torus(double radius, double thick, int around, int across);
/// Open at the top: inner radius, wall, height, and as many sides.
Solid cup(double radius, double wall, double height, int sides);
/// A plate with teeth that become narrower, root and tip as far from its axis, with a hole or none (0).
Solid gear(int teeth, double root, double tip, double hole);
/// Turned by an angle about an axis that is nobody's, and scaled.
Solid turned(Solid solid, float angle, float scale = 1);

}  // namespace ragtop::written
