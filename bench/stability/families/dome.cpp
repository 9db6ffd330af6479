#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "masonry.h"

namespace ragtop::stability {
namespace {
namespace dome_cases {

constexpr double kSeconds = 60;
constexpr double kRadius = 10;  ///< m, of the middle surface
constexpr double kFriction = 0.3;

struct Bond {
    int courses = 4, blocks = 48;        ///< blocks in each course
    double eye = std::numbers::pi / 18;  ///< rad, half angle of the opening at the top
    bool running = true;                 ///< each course is shifted by half a block; otherwise joints run through
};

/// A hemisphere of blocks. Every block is two blocks of half the width side by side in one body, so that beds are
/// plane between any two of them though a course is shifted by half a block against the one below.
class Dome {
public:
    explicit Dome(double thickness, const Bond& bond = {})
        : bond_(bond), inner_(kRadius * (1 - thickness / 2)), outer_(kRadius * (1 + thickness / 2)) {}

    /// All blocks, for the engines.
    Masonry whole() const {
        Masonry dome(static_cast<float>(kFriction));
        for (int course = 0; course < bond_.courses; ++course)
            for (int block = 0; block < bond_.blocks; ++block) {
                const int line = 2 * block + shift(course);
                dome.addStone({half(course, line), half(course, line + 1)});
            }
        return dome;
    }
    /// One block of each course, for the linear program: the others are its copies.
    Masonry sector() const {
        Masonry dome(static_cast<float>(kFriction), 32);
        for (int course = 0; course < bond_.courses; ++course) {
            const int first = shift(course);
            dome.addStone({half(course, first), half(course, first + 1)});
            for (const int side : {0, 1}) addBed(dome, course, first + side);
            addHead(dome, course, first + 2);
        }
        return dome;
    }

private:
    int shift(int course) const { return bond_.running ? course % 2 : 0; }
    /// Angle of a bed from the vertical; the lowest is on the floor.
    double colatitude(int bed) const {
        return std::numbers::pi / 2 - (std::numbers::pi / 2 - bond_.eye) * bed / bond_.courses;
    }
    double azimuth(int line) const { return std::numbers::pi * line / bond_.blocks; }
    DVec3 direction(int bed, int line) const {
        const double s = std::sin(colatitude(bed)), y = bed == 0 ? 0 : std::cos(colatitude(bed));
        return {s * std::cos(azimuth(line)), y, -s * std::sin(azimuth(line))};
    }
    std::vector<DVec3> half(int course, int line) const {
        std::vector<DVec3> corners;
        for (const int bed : {course, course + 1})
            for (const int side : {line, line + 1})
                for (const double r : {inner_, outer_}) corners.push_back(r * direction(bed, side));
        return corners;
    }
    static DVec3 unit(const DVec3& a) { return (1 / std::hypot(a.x, a.y, a.z)) * a; }
    static DVec3 crossed(const DVec3& a, const DVec3& b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
    /// The joint under one half of a block: its block below may be a copy one block further.
    void addBed(Masonry& dome, int course, int line) const {
        Joint joint;
        joint.b = course;
        joint.a = course - 1;  // the floor under the first
        const DVec3 left = direction(course, line), right = direction(course, line + 1);
        for (const DVec3& side : {left, right})
            for (const double r : {inner_, outer_}) joint.points.push_back(r * side);
        joint.normal = unit(crossed(left, right));
        if (joint.normal.y < 0) joint.normal = -1.0 * joint.normal;
        joint.tangent = unit(left + right);
        if (course > 0) {
            const int blocksOn = static_cast<int>(std::floor((line - shift(course - 1)) / 2.0));
            joint.turn = azimuth(2 * blocksOn);
        }
        dome.limit.addJoint(joint);
    }
    /// The joint between a block and its copy one block further round.
    void addHead(Masonry& dome, int course, int line) const {
        Joint joint;
        joint.a = joint.b = course;
        joint.turn = azimuth(2);
        const DVec3 low = direction(course, line), high = direction(course + 1, line);
        for (const DVec3& end : {low, high})
            for (const double r : {inner_, outer_}) joint.points.push_back(r * end);
        // Against the sense of the azimuth: from the copy to the block.
        joint.normal = {std::sin(azimuth(line)), 0, std::cos(azimuth(line))};
        joint.tangent = unit(low + high);
        dome.limit.addJoint(joint);
    }

    Bond bond_;
    double inner_, outer_;
};

double limitThickness(const Bond& bond = {}) {
    return bisect(0.06, 0.03, 1e-3, [&](double t) { return Dome(t, bond).sector().limit.stands(kFriction); });
}

Survival simulate(Trial& trial, double thickness) {
    const Masonry dome = Dome(thickness).whole();
    Run run = trial.start(dome.scene, fmt::format("{:.4f}", thickness));
    return survive(run, dome.stones, kSeconds, thickness * kRadius / 2);
}

void thick(Trial& trial) {
    constexpr double kThickness = 0.06;
    const Survival result = simulate(trial, kThickness);
    trial.expectAtLeast("stands", result.time, kSeconds, "s");
    trial.expectAtMost("largest move", result.moved, kThickness * kRadius / 10, "m");
}

void thin(Trial& trial) { trial.expectAtMost("stands no longer than", simulate(trial, 0.03).time, kSeconds / 2, "s"); }

void critical(Trial& trial) {
    const double exact = limitThickness();
    const double measured = bisect(0.06, 0.03, 5e-3, [&](double t) { return simulate(trial, t).time >= kSeconds; });
    trial.expectNear("critical t/R", measured, exact, 0.02 * exact, "1");
}

}  // namespace dome_cases
}  // namespace

void addDomeCases(Family& family) {
    using namespace dome_cases;
    // Without bond and eye a dome is a ring of lunes, whose limit is known as 0.042 [Heyman, The Stone Skeleton, 1995].
    family.cases.push_back({"limit analysis of a dome",
                            [](Trial& trial) {
                                const Bond lunes{24, 96, std::numbers::pi / 90, false};
                                trial.expectNear("critical t/R", limitThickness(lunes), 0.042, 0.001, "1");
                            },
                            Kind::ragtopOnly});
    family.cases.push_back({"dome, t/R=0.06", thick});
    family.cases.push_back({"dome, t/R=0.03", thin});
    family.cases.push_back({"dome", critical, Kind::oneStep, false});
}

}  // namespace ragtop::stability
