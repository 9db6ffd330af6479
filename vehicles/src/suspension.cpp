#include "suspension.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ragtop {

namespace {

/// Through (0, 0) and the points of a curve; of one rate where there is none.
std::vector<DamperLine> damperLines(const std::vector<DamperPoint>& curve, float rate) {
    if (curve.empty()) return {{0, 0, rate}};
    std::vector<DamperLine> lines;
    DamperPoint from;
    for (const DamperPoint& to : curve) {
        lines.push_back({from.speed, from.force, (to.force - from.force) / (to.speed - from.speed)});
        from = to;
    }
    return lines;
}

constexpr float kRubber = 0.5f;  ///< of a travel, that a stop yields before metal is met

}  // namespace

StrutSpec makeStrut(const WheelDef& wheel, float staticLoad, float gravity) {
    constexpr float kSquash = 0.05f;  // of a radius, of a tire that stands, where nothing is said: as of passenger cars
    constexpr float kRim = 0.2f;      // of a radius, of the side wall that gives way before the rim is met
    constexpr float kSolid = 20;      // of the rubber's stiffness, of what is behind it
    const SuspensionDef& def = wheel.suspension;
    const float mass = staticLoad / gravity;
    const float omega = 2 * kPi * def.frequency;
    StrutSpec strut;
    strut.stiffness = def.stiffness.value_or(mass * omega * omega);
    strut.load = def.springCompression ? strut.stiffness * *def.springCompression : staticLoad;
    const float damping = 2 * def.dampingRatio * std::sqrt(strut.stiffness * mass);
    strut.compression = damperLines(def.compressionCurve, def.compressionDamping.value_or(damping));
    strut.rebound = damperLines(def.reboundCurve, def.reboundDamping.value_or(damping));
    strut.travelUp = def.travelUp;
    strut.travelDown = def.travelDown;
    strut.bump = {def.bumpStopStiffness * strut.stiffness, def.bumpStopProgression / (kRubber * def.travelUp)};
    strut.droop = {def.droopStopStiffness.value_or(0) * strut.stiffness,
                   def.droopStopProgression / (kRubber * def.travelDown)};
    // Rubber gives back little: half of critical.
    strut.bumpDamping = std::sqrt(strut.bump.stiffness * mass);
    strut.tireStiffness = wheel.tire.radialStiffness.value_or(staticLoad / (kSquash * wheel.radius));
    strut.tireSquash = staticLoad / strut.tireStiffness;
    strut.rimSquash = strut.tireSquash + kRim * wheel.radius;
    strut.travelMost = (1 + kRubber) * strut.travelUp;
    strut.travelLeast = -(def.droopStopStiffness ? 1 + kRubber : 1) * strut.travelDown;
    strut.solidStiffness = kSolid * strut.bump.stiffness;
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

namespace {

float stopForce(const StopSpec& stop, float s) {
    return s > 0 ? stop.stiffness * s * (1 + 0.5f * stop.progression * s) : 0;
}

constexpr float kRimStiffness = 10;  ///< of the tire's, where its rim is on the ground

}  // namespace

float springForce(const StrutSpec& strut, float compression) {
    return strut.load + strut.stiffness * compression + stopForce(strut.bump, compression - strut.travelUp) -
           stopForce(strut.droop, -strut.travelDown - compression) +
           strut.solidStiffness * std::max(compression - strut.travelMost, 0.0f);
}

float damperForce(const StrutSpec& strut, float speed) {
    const std::vector<DamperLine>& curve = speed < 0 ? strut.rebound : strut.compression;
    const float size = std::abs(speed);
    std::size_t k = 0;
    while (k + 1 < curve.size() && size > curve[k + 1].speed) ++k;
    const float force = curve[k].force + curve[k].slope * (size - curve[k].speed);
    return speed < 0 ? -force : force;
}

float squashUnder(const StrutSpec& strut, float load) {
    const float rim = strut.tireStiffness * strut.rimSquash;
    if (!(load > rim)) return load / strut.tireStiffness;
    return strut.rimSquash + (load - rim) / ((1 + kRimStiffness) * strut.tireStiffness);
}

namespace {

double square(double x) { return x * x; }

/// ∫ k s (1 + p s/2) ds
double stopEnergy(const StopSpec& stop, double s) {
    if (!(s > 0)) return 0;
    return static_cast<double>(stop.stiffness) * s * s * (0.5 + static_cast<double>(stop.progression) * s / 6);
}

}  // namespace

double springEnergy(const StrutSpec& strut, float compression) {
    const auto stiffness = static_cast<double>(strut.stiffness);
    return 0.5 * square(static_cast<double>(strut.load + strut.stiffness * compression)) / stiffness +
           stopEnergy(strut.bump, static_cast<double>(compression - strut.travelUp)) +
           stopEnergy(strut.droop, static_cast<double>(-strut.travelDown - compression)) +
           0.5 * static_cast<double>(strut.solidStiffness) *
               square(static_cast<double>(std::max(compression - strut.travelMost, 0.0f)));
}

double squashEnergy(const StrutSpec& strut, float squash) {
    const double rim = square(static_cast<double>(std::max(squash - strut.rimSquash, 0.0f)));
    return 0.5 * static_cast<double>(strut.tireStiffness) *
           (square(static_cast<double>(squash)) + static_cast<double>(kRimStiffness) * rim);
}

namespace {

constexpr float kHeld = std::numeric_limits<float>::infinity();  ///< N/m, of a strut at its droop stop

/// F = force + stiffness w, of a way w in a substep.
struct Line {
    float force = 0, stiffness = 0;
};

/// Adds the tangent of a stop of which s are squashed at the end of a way, and before − s less at its beginning; `sign`
/// is that of its force.
void addTangent(Line& line, const StopSpec& stop, float s, float before, float sign) {
    const float more = stop.stiffness * stop.progression * s;
    line.force += sign * (stop.stiffness * before + more * (before - 0.5f * s));
    line.stiffness += stop.stiffness + more;
}

/// Of a strut without its damper, on the piece of its curve, or the tangent, that holds at `end`.
Line strutLine(const StrutSpec& strut, float compression, float end, float h, const BarPull& bar) {
    Line line{strut.load + strut.stiffness * compression + bar.force, strut.stiffness + bar.stiffness};
    if (end > strut.travelUp) {
        addTangent(line, strut.bump, end - strut.travelUp, compression - strut.travelUp, 1);
        line.stiffness += compression > strut.travelUp ? strut.bumpDamping / h : 0;
    }
    if (end > strut.travelMost) {
        line.force += strut.solidStiffness * (compression - strut.travelMost);
        line.stiffness += strut.solidStiffness;
    }
    if (end < -strut.travelDown)
        addTangent(line, strut.droop, -strut.travelDown - end, -strut.travelDown - compression, -1);
    return line;
}

Line operator+(const Line& a, const Line& b) { return {a.force + b.force, a.stiffness + b.stiffness}; }

/// The damper over the way of a substep, on one of its lines; `sign` is that of the way.
Line damperOver(const DamperLine& damper, float sign, float h) {
    return {sign * (damper.force - damper.slope * damper.speed), damper.slope / h};
}

/// The way that `wayWith(line of the damper)` finds on the damper's line that holds for it. It falls as the damper's
/// force rises, so that the lines are tried from rest outwards.
template <class WayWith>
float wayOnDamper(const StrutSpec& strut, float h, WayWith&& wayWith) {
    const auto along = [&](const std::vector<DamperLine>& lines, float sign) {
        float way = 0;
        for (std::size_t k = 0; k < lines.size(); ++k) {
            way = wayWith(damperOver(lines[k], sign, h));
            if (k + 1 == lines.size() || !(sign * way > h * lines[k + 1].speed)) break;
        }
        return way;
    };
    const float way = along(strut.compression, 1);
    return way < 0 ? along(strut.rebound, -1) : way;
}

/// Of the stops of a strut.
unsigned pieceAt(const StrutSpec& strut, float x) {
    return (x > strut.travelUp ? 1u : 0u) + (x > strut.travelMost ? 2u : 0u) + (x < -strut.travelDown ? 4u : 0u);
}

/// Does the line that was taken for `end` hold for what it led to?
bool isSamePiece(const StrutSpec& strut, float end, float newEnd) {
    constexpr float kNear = 1e-5f;  // of the travel, of tangents
    const unsigned piece = pieceAt(strut, newEnd);
    if (piece != pieceAt(strut, end)) return false;
    const bool curved =
        ((piece & 1) != 0 && strut.bump.progression > 0) || ((piece & 4) != 0 && strut.droop.progression > 0);
    return !curved || std::abs(newEnd - end) < kNear * (strut.travelUp + strut.travelDown);
}

/// Of a tire, along its strut; its way makes it longer.
Line tireLine(const StrutSpec& strut, float squash, float end, float slant, float rub) {
    const float rim = end > strut.rimSquash ? kRimStiffness * strut.tireStiffness : 0;
    const float load = strut.tireStiffness * squash + rim * (squash - strut.rimSquash);
    return {slant * load + rub, slant * slant * (strut.tireStiffness + rim)};
}

}  // namespace

/// Each of the pieces is tried from those that hold at the beginning.
StrutVisit solveStrut(const StrutSpec& strut, float compression, float squash, float slant, float h, float K,
                      float free, float rub, const BarPull& bar) {
    constexpr int kMostPieces = 12;
    const float yielding = h * h * K / (slant * slant), coming = -h * free / slant;
    float end = compression, squashed = squash, force = 0, way = 0, stiffness = kHeld;
    for (int piece = 0; piece < kMostPieces; ++piece) {
        const Line tire = tireLine(strut, squash, squashed, slant, rub);
        const Line springs = strutLine(strut, compression, end, h, bar);
        way = wayOnDamper(strut, h, [&](const Line& damper) {
            const Line line = springs + damper;
            const float share = 1 / (line.stiffness + tire.stiffness), both = line.stiffness * tire.stiffness * share;
            force = (share * (tire.stiffness * line.force + line.stiffness * tire.force) +
                     both * (coming + yielding * rub)) /
                    (1 + both * yielding);
            force = std::max(force, rub);
            stiffness = line.stiffness;
            return (force - line.force) / line.stiffness;
        });
        if (compression + way < strut.travelLeast) {
            way = strut.travelLeast - compression;
            force = (tire.force + tire.stiffness * (coming + yielding * rub - way)) / (1 + tire.stiffness * yielding);
            force = std::max(force, rub);
            stiffness = kHeld;
        }
        const float newEnd = compression + way, newSquash = squash + slant * (coming - yielding * (force - rub) - way);
        const bool holds =
            isSamePiece(strut, end, newEnd) && (newSquash > strut.rimSquash) == (squashed > strut.rimSquash);
        end = newEnd;
        squashed = newSquash;
        if (holds) break;
    }
    return {h * (force - rub) / slant, way, stiffness};
}

float fallOfWheel(const StrutSpec& strut, float compression, float h, const BarPull& bar) {
    const Line springs = strutLine(strut, compression, compression, h, {});
    const float way = wayOnDamper(strut, h, [&](const Line& damper) {
        const float pushed = std::max(springs.force, strut.wheelWeight) + bar.force + damper.force;
        return -pushed / (springs.stiffness + bar.stiffness + damper.stiffness);
    });
    return std::max(way, strut.travelLeast - compression);
}

float swingOfWheel(const StrutSpec& strut, float compression, float h, const BarPull& bar) {
    constexpr int kMostPieces = 12;
    float end = compression, way = 0;
    for (int piece = 0; piece < kMostPieces; ++piece) {
        const Line springs = strutLine(strut, compression, end, h, bar);
        way = wayOnDamper(strut, h, [&](const Line& damper) {
            const Line line = springs + damper;
            return -line.force / line.stiffness;
        });
        way = std::max(way, strut.travelLeast - compression);
        const float newEnd = compression + way;
        const bool holds = isSamePiece(strut, end, newEnd);
        end = newEnd;
        if (holds) break;
    }
    return way;
}

}  // namespace ragtop
