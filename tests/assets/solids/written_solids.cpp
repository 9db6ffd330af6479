#include "written_solids.h"

#include <cmath>
#include <functional>
#include <map>
#include <stdexcept>
#include <tuple>

namespace ragtop::written {
namespace {

constexpr double kTurn = 6.283185307179586;

Vec3 at(double x, double y, double z) { return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}; }

void quad(Solid& s, std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
    const auto i = [](std::size_t v) { return static_cast<std::uint32_t>(v); };
    s.triangles.push_back({i(a), i(b), i(c)});
    s.triangles.push_back({i(a), i(c), i(d)});
}

/// A grid of corners that closes both ways: (u, v) with normals along ∂u × ∂v.
Solid closedGrid(std::string name, int us, int vs, const std::function<Vec3(double, double)>& place) {
    Solid s{std::move(name), {}, {}};
    for (int u = 0; u < us; ++u)
        for (int v = 0; v < vs; ++v) s.vertices.push_back(place(kTurn * u / us, kTurn * v / vs));
    const auto index = [&](int u, int v) { return static_cast<std::size_t>(u % us * vs + v % vs); };
    for (int u = 0; u < us; ++u)
        for (int v = 0; v < vs; ++v) quad(s, index(u, v), index(u + 1, v), index(u + 1, v + 1), index(u, v + 1));
    return s;
}

/// Turned about y: a profile of (radius, height), its solid on the left of the way along it; ends may lie on the axis.
Solid lathe(std::string name, const std::vector<std::pair<double, double>>& profile, int sides, bool closed) {
    Solid s{std::move(name), {}, {}};
    for (const auto& [r, y] : profile)
        for (int k = 0; k < sides; ++k)
            s.vertices.push_back(at(r * std::cos(kTurn * k / sides), y, r * std::sin(kTurn * k / sides)));
    const auto n = profile.size(), m = static_cast<std::size_t>(sides);
    for (std::size_t i = 0; i + (closed ? 0 : 1) < n; ++i)
        for (std::size_t k = 0; k < m; ++k) {
            const std::size_t j = (i + 1) % n, l = (k + 1) % m;
            quad(s, i * m + k, j * m + k, j * m + l, i * m + l);
        }
    return s;
}

/// Cells of a grid, of which letters are full; lines along x, rows along y from the top, layers along z.
Solid cells(std::string name, const std::vector<std::vector<std::string>>& layers, const std::vector<double>& xs,
            const std::vector<double>& ys, const std::vector<double>& zs) {
    Solid s{std::move(name), {}, {}};
    const int nx = static_cast<int>(xs.size()) - 1, ny = static_cast<int>(ys.size()) - 1,
              nz = static_cast<int>(zs.size()) - 1;
    const auto full = [&](int x, int y, int z) {
        if (x < 0 || y < 0 || z < 0 || x >= nx || y >= ny || z >= nz) return false;
        const auto& rows = layers[layers.size() == 1 ? 0 : static_cast<std::size_t>(z)];
        return rows[static_cast<std::size_t>(ny - 1 - y)][static_cast<std::size_t>(x)] != ' ';
    };
    std::map<std::tuple<int, int, int>, std::size_t> corner;
    const auto index = [&](int x, int y, int z) {
        const auto [found, fresh] = corner.try_emplace({x, y, z}, s.vertices.size());
        if (fresh)
            s.vertices.push_back(
                at(xs[static_cast<std::size_t>(x)], ys[static_cast<std::size_t>(y)], zs[static_cast<std::size_t>(z)]));
        return found->second;
    };
    for (int x = 0; x < nx; ++x)
        for (int y = 0; y < ny; ++y)
            for (int z = 0; z < nz; ++z) {
                if (!full(x, y, z)) continue;
                const auto c = [&](int i, int j, int k) { return index(x + i, y + j, z + k); };
                if (!full(x - 1, y, z)) quad(s, c(0, 0, 0), c(0, 0, 1), c(0, 1, 1), c(0, 1, 0));
                if (!full(x + 1, y, z)) quad(s, c(1, 0, 0), c(1, 1, 0), c(1, 1, 1), c(1, 0, 1));
                if (!full(x, y - 1, z)) quad(s, c(0, 0, 0), c(1, 0, 0), c(1, 0, 1), c(0, 0, 1));
                if (!full(x, y + 1, z)) quad(s, c(0, 1, 0), c(0, 1, 1), c(1, 1, 1), c(1, 1, 0));
                if (!full(x, y, z - 1)) quad(s, c(0, 0, 0), c(0, 1, 0), c(1, 1, 0), c(1, 0, 0));
                if (!full(x, y, z + 1)) quad(s, c(0, 0, 1), c(1, 0, 1), c(1, 1, 1), c(0, 1, 1));
            }
    return s;
}

Solid letter(std::string name, const std::vector<std::string>& rows) {
    std::vector<double> xs, ys;
    for (std::size_t i = 0; i <= rows[0].size(); ++i) xs.push_back(0.1 * static_cast<double>(i));
    for (std::size_t i = 0; i <= rows.size(); ++i) ys.push_back(0.1 * static_cast<double>(i));
    return cells(std::move(name), {rows}, xs, ys, {0, 0.15});
}

/// Between two closed lines of as many points each, the outer counter-clockwise, drawn along z.
Solid ringPlate(std::string name, const std::vector<std::pair<double, double>>& outer,
                const std::vector<std::pair<double, double>>& inner, double thick) {
    Solid s{std::move(name), {}, {}};
    const std::size_t n = outer.size();
    for (const double z : {0.0, thick}) {
        for (const auto& [x, y] : outer) s.vertices.push_back(at(x, y, z));
        for (const auto& [x, y] : inner) s.vertices.push_back(at(x, y, z));
    }
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t j = (i + 1) % n;
        quad(s, i, j, 2 * n + j, 2 * n + i);                  // outside
        quad(s, n + j, n + i, 3 * n + i, 3 * n + j);          // of the hole
        quad(s, n + i, n + j, j, i);                          // below
        quad(s, 2 * n + i, 2 * n + j, 3 * n + j, 3 * n + i);  // above
    }
    return s;
}

/// A plate whose outline goes in and out.
Solid star(int points, double far, double near) {
    std::vector<std::pair<double, double>> outline, middle;
    for (int i = 0; i < 2 * points; ++i) {
        const double a = kTurn * i / (2 * points), r = i % 2 ? near : far;
        outline.emplace_back(r * std::cos(a), r * std::sin(a));
        middle.emplace_back(0, 0);
    }
    return ringPlate("star", outline, middle, 0.1);
}

/// A round tube along a line, with flat ends.
Solid tube(std::string name, int steps, int sides, double radius, const std::function<DVec3(double)>& line) {
    Solid s{std::move(name), {}, {}};
    const auto unit = [](const DVec3& v) { return (1 / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z)) * v; };
    const auto product = [](const DVec3& a, const DVec3& b) {
        return DVec3{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    };
    for (int i = 0; i <= steps; ++i) {
        const double t = static_cast<double>(i) / steps;
        const DVec3 along = unit(line(t + 1e-5) - line(t - 1e-5));
        const DVec3 u = unit(product({0, 1, 0}, along)), v = product(along, u);
        for (int k = 0; k < sides; ++k) {
            const double a = kTurn * k / sides;
            const DVec3 p = line(t) + radius * std::cos(a) * u + radius * std::sin(a) * v;
            s.vertices.push_back(at(p.x, p.y, p.z));
        }
    }
    const auto m = static_cast<std::size_t>(sides), n = static_cast<std::size_t>(steps);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < m; ++k)
            quad(s, i * m + k, i * m + (k + 1) % m, (i + 1) * m + (k + 1) % m, (i + 1) * m + k);
    for (std::size_t k = 1; k + 1 < m; ++k) {
        const auto i = [](std::size_t v) { return static_cast<std::uint32_t>(v); };
        s.triangles.push_back({0, i(k + 1), i(k)});
        s.triangles.push_back({i(n * m), i(n * m + k), i(n * m + k + 1)});
    }
    return s;
}

std::vector<std::pair<double, double>> halfRound(double radius, int steps, bool inwards) {
    std::vector<std::pair<double, double>> points;
    for (int i = 0; i <= steps; ++i) {
        const double a = kTurn / 2 * (inwards ? i : steps - i) / steps;
        points.emplace_back(i % steps == 0 ? 0 : radius * std::sin(a), radius * std::cos(a));
    }
    return points;
}

Solid shell(double outer, double inner) {
    Solid s = lathe("shell", halfRound(outer, 12, false), 24, false);
    const Solid hollow = lathe("", halfRound(inner, 12, true), 24, false);
    const auto first = static_cast<std::uint32_t>(s.vertices.size());
    s.vertices.insert(s.vertices.end(), hollow.vertices.begin(), hollow.vertices.end());
    for (const Triangle& t : hollow.triangles) s.triangles.push_back({first + t.a, first + t.b, first + t.c});
    return s;
}

Solid chair() {
    const std::vector<std::string> legs{"L L", "   ", "L L"}, seat{"SSS", "SSS", "SSS"}, back{"BBB", "   ", "   "};
    Solid s = cells("chair", {legs, seat, back}, {0, 0.05, 0.4, 0.45}, {0, 0.05, 0.4, 0.45}, {0, 0.42, 0.47, 0.95});
    return s;
}

Solid table() {
    const std::vector<std::string> legs{"L L", "   ", "L L"}, top{"TTT", "TTT", "TTT"};
    return cells("table", {legs, top}, {0, 0.08, 0.92, 1}, {0, 0.08, 0.52, 0.6}, {0, 0.7, 0.74});
}

Solid cross3() {
    const std::vector<std::string> one{"   ", " X ", "   "}, three{" X ", "XXX", " X "};
    return cells("cross", {one, three, one}, {0, 0.4, 0.6, 1}, {0, 0.4, 0.6, 1}, {0, 0.4, 0.6, 1});
}

Solid dumbbell() {
    return lathe("dumbbell",
                 {{0, -0.3},
                  {0.12, -0.3},
                  {0.15, -0.27},
                  {0.15, -0.23},
                  {0.12, -0.2},
                  {0.03, -0.2},
                  {0.03, 0.2},
                  {0.12, 0.2},
                  {0.15, 0.23},
                  {0.15, 0.27},
                  {0.12, 0.3},
                  {0, 0.3}},
                 20, false);
}

}  // namespace

Solid torus(double radius, double thick, int around, int across) {
    return closedGrid("torus", around, across, [&](double u, double v) {
        const double r = radius + thick * std::cos(v);
        return at(r * std::cos(u), -thick * std::sin(v), r * std::sin(u));
    });
}

Solid gear(int teeth, double root, double tip, double hole) {
    std::vector<std::pair<double, double>> outer, inner;
    for (int i = 0; i < teeth; ++i)
        for (const auto& [part, radius] :
             {std::pair{0.0, root}, std::pair{0.35, root}, std::pair{0.5, tip}, std::pair{0.85, tip}}) {
            const double a = kTurn * (i + part) / teeth;
            outer.emplace_back(radius * std::cos(a), radius * std::sin(a));
            inner.emplace_back(hole * std::cos(a), hole * std::sin(a));
        }
    return ringPlate("gear", outer, inner, 0.1);
}

Solid cup(double radius, double wall, double height, int sides) {
    const double out = radius + wall;
    return lathe("cup", {{0, 0}, {out, 0}, {out, height}, {radius, height}, {radius, wall}, {0, wall}}, sides, false);
}

Solid turned(Solid solid, float angle, float scale) {
    const Quat q = rotationAbout(normalized(Vec3{0.3f, 0.7f, -0.5f}), angle);
    for (Vec3& v : solid.vertices) v = scale * rotate(q, v) + scale * Vec3{0.37f, -0.21f, 0.11f};
    return solid;
}

std::vector<Solid> twenty() {
    std::vector<Solid> all;
    all.push_back(cup(0.04, 0.006, 0.095, 32));
    all.push_back(torus(0.4, 0.12, 48, 20));
    all.push_back(chair());
    all.push_back(table());
    all.push_back(letter("L", {"X  ", "X  ", "XXX"}));
    all.push_back(letter("T", {"XXX", " X ", " X "}));
    all.push_back(letter("U", {"X X", "X X", "XXX"}));
    all.push_back(letter("H", {"X X", "XXX", "X X"}));
    all.push_back(letter("E", {"XXX", "X  ", "XXX", "X  ", "XXX"}));
    all.push_back(letter("stairs", {"   X", "  XX", " XXX", "XXXX"}));
    all.push_back(letter("frame", {"XXXX", "X  X", "X  X", "XXXX"}));
    all.push_back(letter("shelf", {"XXXXXX", "X    X", "XXXXXX", "X    X", "XXXXXX", "X    X", "XXXXXX"}));
    all.push_back(cross3());
    all.push_back(gear(10, 0.3, 0.38, 0.12));
    all.push_back(star(5, 0.5, 0.2));
    all.push_back(shell(0.3, 0.18));
    all.push_back(lathe("pipe", {{0.2, 0}, {0.26, 0}, {0.26, 0.6}, {0.2, 0.6}}, 32, true));
    all.push_back(dumbbell());
    all.push_back(tube("spring", 60, 10, 0.04, [](double t) {
        return DVec3{0.25 * std::cos(kTurn * t * 1.25), 0.3 * t, 0.25 * std::sin(kTurn * t * 1.25)};
    }));
    all.push_back(lathe("bowl",
                        {{0, 0}, {0.12, 0}, {0.3, 0.15}, {0.36, 0.3}, {0.3, 0.3}, {0.25, 0.17}, {0.1, 0.06}, {0, 0.06}},
                        28, false));
    return all;
}

Solid byName(const std::string& name) {
    for (Solid& solid : twenty())
        if (solid.name == name) return solid;
    throw std::out_of_range(name);
}

}  // namespace ragtop::written
