// The sides of joints' rows that are answered as they are (pivoting.h).

#include <cmath>

#include "direct/equations.h"

namespace ragtop::direct {

namespace {

bool isBounded(const SystemRow& row) { return !std::isinf(row.lower) || !std::isinf(row.upper); }

/// The side of y: the row's own, if rounding may have moved y across.
Side askedSide(const SystemRow& row, double y, double rounding) {
    const bool isLower = row.side == Side::lower, isUpper = row.side == Side::upper;
    if (y < row.lower + (isLower ? rounding : -rounding)) return Side::lower;
    if (y > row.upper - (isUpper ? rounding : -rounding)) return Side::upper;
    return Side::within;
}

/// What the row's potential changes by between y and the bound that it has come from or gone beyond, J.
double wrongBy(const SystemRow& row, double y) {
    if (row.asked == row.side) return 0;
    const Side bound = row.side == Side::within ? row.asked : row.side;
    const double beyond = y - (bound == Side::lower ? row.lower : row.upper);
    return 0.5 * row.resistance * beyond * beyond;
}

}  // namespace

void Equations::takeSidesOfLoads() {
    for (SystemRow& row : rows)
        row.side = row.load <= row.lower ? Side::lower : row.load >= row.upper ? Side::upper : Side::within;
}

void Equations::takeSidesOfTargets() {
    for (SystemRow& row : rows) {
        const double asked = row.target / row.resistance;
        row.side = asked <= row.lower ? Side::lower : asked >= row.upper ? Side::upper : Side::within;
    }
}

/// A row within its bounds has the load y = λ̂ − (u − û)/R, another that of its bound. It is right there where y is on
/// that side, but for the rounding of what y sums up.
Residual Equations::evaluateSides(const double* v, double* gradient) {
    speedsAt(v);
    return evaluateSidesAgain(v, gradient);
}

Residual Equations::evaluateSidesAgain(const double* v, double* gradient) {
    for (const SystemContact& c : contacts)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points[c.first + j];
            double y[3], slope[6];
            unbounded(p, c.friction, p.speed, y);
            for (int k = 0; k < 3; ++k) y[k] -= p.asked[k];
            projectionSlope(p.asked, c.friction, p.region, slope);
            p.impulse[0] += slope[0] * y[0] + slope[1] * y[1] + slope[2] * y[2];
            p.impulse[1] += slope[1] * y[0] + slope[3] * y[1] + slope[4] * y[2];
            p.impulse[2] += slope[2] * y[0] + slope[4] * y[1] + slope[5] * y[2];
        }
    for (SystemRow& row : rows)
        row.impulse = row.side == Side::lower   ? row.lower
                      : row.side == Side::upper ? row.upper
                                                : row.load - (row.speed - row.target) / row.resistance;
    return gradientAt(v, gradient);
}

static DVec3 size(const DVec3& a) { return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; }

/// The sums of the sizes of the terms that the motion of a pair sums up.
static Twist termsOfMotion(const SystemPair& pair, const double* v) {
    Twist sum;
    const auto addTerms = [&](std::int32_t body, const DVec3& arm) {
        if (body == kFixed) return;
        const DVec3 w = size(load(v + 6 * body + 3)), r = size(arm);
        sum.linear = sum.linear + size(load(v + 6 * body)) +
                     DVec3{w.y * r.z + w.z * r.y, w.z * r.x + w.x * r.z, w.x * r.y + w.y * r.x};
        sum.turn = sum.turn + w;
    };
    addTerms(pair.a, pair.armA);
    addTerms(pair.b, pair.armB);
    return sum;
}

std::size_t Equations::askSides(const double* v) {
    std::size_t wrong = 0;
    for (const SystemPair& pair : pairs) {
        const Twist terms = termsOfMotion(pair, v);
        for (std::uint32_t i = pair.first; i < pair.first + pair.count; ++i) {
            SystemRow& row = rows[i];
            row.asked = Side::within, row.wrong = 0;
            if (!isBounded(row)) continue;
            const double y = row.load - (row.speed - row.target) / row.resistance;
            const double speed = dot(size(row.linear), terms.linear) + dot(size(row.turn), terms.turn);
            const double sum = std::fabs(row.load) + (speed + std::fabs(row.target)) / row.resistance;
            row.asked = askedSide(row, y, tuning::kSideRounding * sum);
            row.wrong = wrongBy(row, y);
            wrong += row.asked != row.side;
        }
    }
    return wrong;
}

void Equations::changeSides(SideChange change) {
    const SystemRow* chosen = nullptr;
    for (const SystemRow& row : rows)
        if (row.asked != row.side && (!chosen || change == SideChange::last || row.wrong > chosen->wrong))
            chosen = &row;
    const bool together = change == SideChange::leap || change == SideChange::step;
    for (SystemRow& row : rows) {
        if (row.asked == row.side || !(together || &row == chosen)) continue;
        row.side = change == SideChange::leap || row.side == Side::within ? row.asked : Side::within;
    }
}

}  // namespace ragtop::direct
