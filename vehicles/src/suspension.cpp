#include "suspension.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ragtop {

StrutSpec makeStrut(const WheelDef& wheel, float staticLoad, float gravity) {
    constexpr float kSquash = 0.05f;  // of a radius, of a tire that stands, where nothing is said: as of passenger cars
    constexpr float kRim = 0.2f;      // of a radius, of the side wall that gives way before the rim is met
    constexpr float kMost = 1.5f, kSolid = 20;  // of the travel, and of the rubber's stiffness, of what is behind it
    const SuspensionDef& def = wheel.suspension;
    const float mass = staticLoad / gravity;
    const float omega = 2 * kPi * def.frequency;
    StrutSpec strut;
    strut.stiffness = def.stiffness.value_or(mass * omega * omega);
    strut.load = def.springCompression ? strut.stiffness * *def.springCompression : staticLoad;
    const float damping = 2 * def.dampingRatio * std::sqrt(strut.stiffness * mass);
    strut.compressionDamping = def.compressionDamping.value_or(damping);
    strut.reboundDamping = def.reboundDamping.value_or(damping);
    strut.travelUp = def.travelUp;
    strut.travelDown = def.travelDown;
    strut.bumpStiffness = def.bumpStopStiffness * strut.stiffness;
    // Rubber gives back little: half of critical.
    strut.bumpDamping = std::sqrt(strut.bumpStiffness * mass);
    strut.tireStiffness = wheel.tire.radialStiffness.value_or(staticLoad / (kSquash * wheel.radius));
    strut.tireSquash = staticLoad / strut.tireStiffness;
    strut.rimSquash = strut.tireSquash + kRim * wheel.radius;
    strut.travelMost = kMost * strut.travelUp;
    strut.solidStiffness = kSolid * strut.bumpStiffness;
    strut.wheelWeight = wheel.mass * gravity;
    return strut;
}

/// Of all F with ΣF = W, ΣF x = 0, ΣF z = 0 the one with the least ΣF² is F = a + b x + c z; the three balances are
/// the normal equations of a, b, c.
std::vector<float> staticLoads(const std::vector<Vec3>& positions, float weight) {
    double n = 0, sx = 0, sz = 0, sxx = 0, sxz = 0, szz = 0;
    for (const Vec3& p : positions) {
        const double x = p.x, z = p.z;
        n += 1;
        sx += x;
        sz += z;
        sxx += x * x;
        sxz += x * z;
        szz += z * z;
    }
    const double ca = sxx * szz - sxz * sxz, cb = sxz * sz - sx * szz, cc = sx * sxz - sxx * sz;
    const double determinant = n * ca + sx * cb + sz * cc;
    if (!(determinant > 1e-9 * n * sxx * szz)) return {};
    const double s = static_cast<double>(weight) / determinant;
    std::vector<float> loads;
    for (const Vec3& p : positions) {
        loads.push_back(static_cast<float>(s * (ca + cb * static_cast<double>(p.x) + cc * static_cast<double>(p.z))));
    }
    return loads;
}

float springForce(const StrutSpec& strut, float compression) {
    const float bump = std::max(compression - strut.travelUp, 0.0f),
                most = std::max(compression - strut.travelMost, 0.0f);
    return strut.load + strut.stiffness * compression + strut.bumpStiffness * bump + strut.solidStiffness * most;
}

namespace {

constexpr float kStopped = std::numeric_limits<float>::infinity();  ///< N/m, of a strut at its droop stop
constexpr float kRimStiffness = 10;                                 ///< of the tire's, where its rim is on the ground

/// F = force + stiffness w, of a way w in a substep.
struct Line {
    float force = 0, stiffness = 0;
};

/// Of a strut on the piece of its curve that holds at `end`.
Line strutLine(const StrutSpec& strut, float compression, float end, float damping, float h) {
    Line line{strut.load + strut.stiffness * compression, strut.stiffness + damping / h};
    if (end > strut.travelUp) {
        line.force += strut.bumpStiffness * (compression - strut.travelUp);
        line.stiffness += strut.bumpStiffness + (compression > strut.travelUp ? strut.bumpDamping / h : 0);
    }
    if (end > strut.travelMost) {
        line.force += strut.solidStiffness * (compression - strut.travelMost);
        line.stiffness += strut.solidStiffness;
    }
    return line;
}

/// Of a tire, along its strut; its way makes it longer.
Line tireLine(const StrutSpec& strut, float squash, float end, float slant, float rub, const LoadLag& lag) {
    const float rim = end > strut.rimSquash ? kRimStiffness * strut.tireStiffness : 0;
    const float load = strut.tireStiffness * squash + rim * (squash - strut.rimSquash);
    return {slant * (lag.load + lag.share * (load - lag.load)) + rub,
            slant * slant * lag.share * (strut.tireStiffness + rim)};
}

}  // namespace

/// Each of the pieces is tried from those that hold at the beginning; the curves rise and bend up, so that a piece that
/// is left is left for the next one.
StrutVisit solveStrut(const StrutSpec& strut, float compression, float squash, float slant, float h, float K,
                      float free, float rub, const LoadLag& lag) {
    constexpr int kMostPieces = 6;
    const float yielding = h * h * K / (slant * slant), coming = -h * free / slant;
    float end = compression, squashed = squash, force = 0, way = 0, stiffness = kStopped;
    for (int piece = 0; piece < kMostPieces; ++piece) {
        const Line tire = tireLine(strut, squash, squashed, slant, rub, lag);
        const auto meet = [&](float damping) {
            const Line line = strutLine(strut, compression, end, damping, h);
            const float share = 1 / (line.stiffness + tire.stiffness), both = line.stiffness * tire.stiffness * share;
            force = (share * (tire.stiffness * line.force + line.stiffness * tire.force) +
                     both * (coming + yielding * rub)) /
                    (1 + both * yielding);
            force = std::max(force, rub);
            stiffness = line.stiffness;
            way = (force - line.force) / line.stiffness;
        };
        meet(strut.compressionDamping);
        if (way < 0) meet(strut.reboundDamping);
        if (compression + way < -strut.travelDown) {
            way = -strut.travelDown - compression;
            force = (tire.force + tire.stiffness * (coming + yielding * rub - way)) / (1 + tire.stiffness * yielding);
            force = std::max(force, rub);
            stiffness = kStopped;
        }
        const float newEnd = compression + way, newSquash = squash + slant * (coming - yielding * (force - rub) - way);
        const bool holds = (newEnd > strut.travelUp) == (end > strut.travelUp) &&
                           (newEnd > strut.travelMost) == (end > strut.travelMost) &&
                           (newSquash > strut.rimSquash) == (squashed > strut.rimSquash);
        end = newEnd;
        squashed = newSquash;
        if (holds) break;
    }
    return {h * (force - rub) / slant, way, stiffness};
}

float fallOfWheel(const StrutSpec& strut, float compression, float h) {
    const Line line = strutLine(strut, compression, compression, strut.reboundDamping, h);
    return std::max(-std::max(line.force, strut.wheelWeight) / line.stiffness, -strut.travelDown - compression);
}

}  // namespace ragtop
