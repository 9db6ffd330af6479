#include "tire.h"

#include <algorithm>
#include <cmath>

namespace ragtop {
namespace {

Vec2 solve(const Sym2& a, const Vec2& b) {
    const float s = 1.0f / (a.xx * a.yy - a.xy * a.xy);
    return {s * (a.yy * b.x - a.xy * b.y), s * (a.xx * b.y - a.xy * b.x)};
}

float lengthSquared(const Vec2& a) { return a.x * a.x + a.y * a.y; }

/// The minimum of ½ yᵀ A y − bᵀ y in the unit disc. Outside of it y(t) = (A + t E)⁻¹ b with |y(t)| = 1; Newton's
/// method on 1/|y(t)| = 1 climbs to t from below without overshoot [Conn, Gould, Toint, Trust-Region Methods, 2000,
/// section 7.3.3].
Vec2 minimumInDisc(const Sym2& a, const Vec2& b, bool& onEdge) {
    Vec2 y = solve(a, b);
    float squared = lengthSquared(y);
    onEdge = squared > 1;
    if (!onEdge) return y;
    float t = 0;
    for (int i = 0; i < 12 && squared > 1.000002f; ++i) {
        const Vec2 z = solve({a.xx + t, a.xy, a.yy + t}, y);
        t += squared / (y.x * z.x + y.y * z.y) * (std::sqrt(squared) - 1);
        y = solve({a.xx + t, a.xy, a.yy + t}, b);
        squared = lengthSquared(y);
    }
    const float s = 1.0f / std::sqrt(squared);
    return {s * y.x, s * y.y};
}

/// q in (3).
float secantOver(float x) { return 1 - x + x * x * (1.0f / 3); }

float slidingShare(const TireLaw& law, const Vec2& u) {
    const float x = law.stiffness.x * u.x / (3 * law.friction.x), y = law.stiffness.y * u.y / (3 * law.friction.y);
    return std::sqrt(x * x + y * y);
}

/// (5): how far the tire is from where it begins to slide to where it is locked. Over kSlowestTravel at least, below
/// which a tire only sways.
float lockedShare(const TireLaw& law, const TireMotion& motion, float slowest) {
    const Vec2 slip{motion.travel.x - motion.tread, motion.travel.y};
    const float travel = std::sqrt(lengthSquared(motion.travel));
    const float over = 1 / std::max({travel, std::abs(motion.tread), slowest});
    const float size = over * std::sqrt(lengthSquared(slip));
    const float bent = over * law.relaxation;
    const float z = slidingShare(law, {bent * slip.x, bent * slip.y});
    // Not where nothing slides, and not where the wheel locks before all of the brush does.
    if (!(z > 1) || !(z > size)) return 0;
    return std::min((z - 1) * size / (z - size), 1.0f);
}

/// What a tire has come to that is bent by u, apart from nothing in either direction.
Vec2 slipTried(const TireLaw& law, const Vec2& u) {
    constexpr float kApart = 1e-4f;
    const auto apart = [](float slip) { return std::abs(slip) < kApart ? (slip < 0 ? -kApart : kApart) : slip; };
    return {apart(u.x / law.relaxation), apart(u.y / law.relaxation)};
}

SlipLaw slipLawOf(const TireDef& def, const TireStand& stand) {
    if (def.magicFormula) return magicFactors(*def.magicFormula, stand);
    if (def.slipCurves) return slipCurves(*def.slipCurves, stand);
    return {};
}

}  // namespace

TireNumbers tireNumbers(const TireDef& def, float load) {
    const SlipLaw law = slipLawOf(def, {1, 1, load, 0});
    if (std::holds_alternative<std::monostate>(law)) {
        return {def.longitudinalFriction, def.lateralFriction, def.slidingShare * def.longitudinalFriction,
                def.slipStiffness, def.corneringStiffness};
    }
    const Vec2 friction = peakFriction(law), slope = slopeAtRest(law);
    return {friction.x, friction.y, -forceOverLoad(law, {-1, 0}).x, slope.x, slope.y};
}

TireDef asBrush(const TireDef& def, float load) {
    TireDef brush = def;
    if (!def.magicFormula && !def.slipCurves) return brush;
    const TireNumbers at = tireNumbers(def, load), doubled = tireNumbers(def, 2 * load);
    const auto lost = [](float now, float later) { return now > 0 ? 1 - later / now : 0; };
    brush.magicFormula.reset();
    brush.slipCurves.reset();
    brush.longitudinalFriction = at.longitudinalFriction;
    brush.lateralFriction = at.lateralFriction;
    brush.slidingShare = at.longitudinalFriction > 0 ? at.slidingFriction / at.longitudinalFriction : 1;
    brush.slidingShare = std::clamp(brush.slidingShare, 0.1f, 1.0f);
    brush.loadSensitivity = std::clamp(0.5f * (lost(at.longitudinalFriction, doubled.longitudinalFriction) +
                                               lost(at.lateralFriction, doubled.lateralFriction)),
                                       0.0f, 0.5f);
    brush.slipStiffness = at.slipStiffness;
    brush.corneringStiffness = at.corneringStiffness;
    return brush;
}

TireSpec makeTireSpec(const TireDef& def, float staticLoad, float gravity) {
    const TireNumbers numbers = tireNumbers(def, staticLoad);
    TireSpec spec{def, {}, 0, 1, 1, staticLoad, {numbers.longitudinalFriction, numbers.lateralFriction}};
    spec.stiffness = {numbers.slipStiffness / def.relaxationLength, numbers.corneringStiffness / def.relaxationLength};
    // The load swaying on its standing tire: ω² = N k / (N/g).
    const float sway = std::sqrt(spec.stiffness.y * gravity);
    spec.standingDamping = 2 * def.dampingRatio / sway;
    spec.swaySpeed = def.relaxationLength * sway;
    spec.slowest = 0.5f * std::sqrt(def.relaxationLength * gravity);
    return spec;
}

/// Laws have forces over grip: on what has none they get so little of it that a car loses 10 nm/s² to it.
TireGround tireGround(const TireDef& def, float friction, std::uint32_t surface) {
    constexpr float kLeastGrip = 1e-9f;
    for (const TireSurface& known : def.surfaces) {
        if (known.surface == surface) return {std::max(known.grip, kLeastGrip), known.stiffness, known.drag};
    }
    return {std::max(friction / def.referenceSurface, kLeastGrip), 1, 0};
}

TireLaw tireLaw(const TireSpec& spec, const TireGround& ground, const TireMotion& motion, float load, float transport) {
    const float speed = transport / spec.swaySpeed;
    TireLaw law;
    law.relaxation = spec.def.relaxationLength;
    law.damping = spec.standingDamping / (1 + speed * speed);
    law.slips = slipLawOf(spec.def, {ground.grip, ground.stiffness, load, ground.inclination});
    if (!law.isBrush()) {
        // Combined slip may have all of both.
        const Vec2 peak = peakFriction(law.slips);
        law.friction = {1.5f * peak.x, 1.5f * peak.y};
        return law;
    }
    const float loadChange = load / spec.staticLoad - 1;
    const float grip = ground.grip * std::max(1 - spec.def.loadSensitivity * loadChange, 0.5f);
    law.friction = {grip * spec.def.longitudinalFriction, grip * spec.def.lateralFriction};
    law.stiffness = {ground.stiffness * spec.stiffness.x, ground.stiffness * spec.stiffness.y};
    const float lost = (1 - spec.def.slidingShare) * lockedShare(law, motion, spec.slowest);
    law.friction = {(1 - lost) * law.friction.x, (1 - lost) * law.friction.y};
    return law;
}

SlipForces forcesAt(const TireLaw& law, const Vec2& u) {
    return law.isBrush() ? SlipForces{} : forcesOverLoad(law.slips, slipTried(law, u));
}

/// Without the slip of a direction the other one alone makes its offset; the least slip tells the slope there.
TireLine tireLine(const TireLaw& law, const Vec2& u, const SlipForces& forces) {
    if (law.isBrush()) {
        const float q = secantOver(std::min(slidingShare(law, u), 1.0f));
        return {{}, {q * law.stiffness.x, q * law.stiffness.y}};
    }
    constexpr float kFlattest = 1e-3f;
    const Vec2 tried = slipTried(law, u), &offset = forces.withoutOwn;
    const float s = 1 / law.relaxation;
    return {offset,
            {s * std::max((forces.force.x - offset.x) / tried.x, kFlattest),
             s * std::max((forces.force.y - offset.y) / tried.y, kFlattest)}};
}

Vec2 withinPatch(const TireLaw& law, const Vec2& u) {
    const float x = law.isBrush() ? slidingShare(law, u) : std::sqrt(lengthSquared(u)) / law.relaxation;
    if (!(x > 1)) return u;
    return {u.x / x, u.y / x};
}

/// g(c) = F(c u)·u rises from 0 at its steepest, so that from below c ← c g(1)/g(c) climbs to the first c that has
/// g(1).
Vec2 beforePeak(const TireLaw& law, const Vec2& u) {
    constexpr float kRising = 0.6f;  // of the slope at rest, which a secant has on the rising side at least
    if (law.isBrush()) return u;
    const Vec2 slope = slopeAtRest(law.slips);
    const float s = 1 / law.relaxation, steepest = s * (slope.x * u.x * u.x + slope.y * u.y * u.y);
    const auto force = [&](float c) {
        const Vec2 f = forceOverLoad(law.slips, {c * s * u.x, c * s * u.y});
        return f.x * u.x + f.y * u.y;
    };
    const float asked = force(1);
    if (!(asked > 0) || !(asked < kRising * steepest)) return u;
    float c = asked / steepest;
    for (int i = 0; i < 8; ++i) {
        const float now = force(c);
        if (!(now > 0)) return u;
        c = std::min(c * std::max(asked / now, 1.0f), 1.0f);
    }
    return {c * u.x, c * u.y};
}

namespace {

Vec2 mixed(const Vec2& a, float x, const Vec2& b, float y) { return {x * a.x + y * b.x, x * a.y + y * b.y}; }

}  // namespace

Vec2 meanUnder(const Tread& tread, float load) {
    if (load >= tread.load) return load > 0 ? mixed(tread.mean, tread.load / load, {}, 0) : Vec2{};
    if (load <= tread.coreLoad) return tread.core;
    const float edge = 1 / (tread.load - tread.coreLoad);
    const Vec2 last = mixed(tread.mean, edge * tread.load, tread.core, -edge * tread.coreLoad);
    return mixed(tread.core, tread.coreLoad / load, last, 1 - tread.coreLoad / load);
}

Tread underLoad(const Tread& tread, float load) {
    return {meanUnder(tread, load), tread.core, load, std::min(tread.coreLoad, load)};
}

Vec2 rolledDeflection(const TireLaw& law, const Vec2& u, const Vec2& slip, float transport, float h) {
    const float s = 1.0f / (1 + h * transport / law.relaxation);
    return {s * (u.x - h * slip.x), s * (u.y - h * slip.y)};
}

namespace {

/// Of the end of a substep, against its beginning, at which the mean force of a substep is found. The middle is exact
/// to second order, and the end keeps what is stiff from ringing; between them θ is what makes a decay by y come out as
/// 1/(1 + y + y²/2 + y³/6), e^{−y} to third order: [Liniger, Willoughby, SIAM J. Numer. Anal. 7, 1970], exponential
/// fitting.
float shareOfEnd(float y) { return (3 + y * (2 + y)) / (6 + y * (3 + y)); }

/// F/N of one direction at the end of a substep: at the deflection (1 − θ) u₀ + θ u.
struct TireStep {
    float end = 1;         ///< θ
    float reach = 0;       ///< p = θ h + τ, s
    float compliance = 0;  ///< 1/G
};

TireStep stepOf(const TireLaw& law, float stiffness, float rolled, float load, float h, float K) {
    const float grows = 1 + h * rolled, answers = load * stiffness * (h + law.damping) / grows;
    TireStep step;
    step.end = shareOfEnd(h * rolled + K * answers);
    step.reach = step.end * h + law.damping;
    step.compliance = grows / (load * stiffness * step.reach);
    return step;
}

}  // namespace

/// Backward Euler of (1) into (2) at (1 − θ) u₀ + θ u, per direction, with p = θ h + τ, d = 1 + h V/σ, a stiffness S
/// over load and an offset o:
///
///     λ = N h o + G ((1 + ((1 − θ) h − τ) V/σ) u₀/p − s),   G = N h S p/d
///
/// so with s = free + K λ: (K + G⁻¹) λ = (1 + …) u₀/p − free + G⁻¹ N h o. Forces are scaled by μ N h, which turns
/// the ellipse into the unit disc.
TireVisit solveTire(const TireLaw& law, const TireLine& line, const Vec2& u, float transport, float load, float h,
                    const Sym2& K, const Vec2& free) {
    const Vec2 scale{law.friction.x * load, law.friction.y * load};
    if (!(scale.x > 0) || !(scale.y > 0)) return {};
    const float rolled = transport / law.relaxation;
    const TireStep x = stepOf(law, line.stiffness.x, rolled, load, h, K.xx),
                   y = stepOf(law, line.stiffness.y, rolled, load, h, K.yy);
    const auto pull = [&](const TireStep& step) {
        return (1 + ((1 - step.end) * h - law.damping) * rolled) / step.reach;
    };
    const Sym2 a{scale.x * scale.x * (K.xx + x.compliance), scale.x * scale.y * K.xy,
                 scale.y * scale.y * (K.yy + y.compliance)};
    const Vec2 b{scale.x * (pull(x) * u.x - free.x + x.compliance * load * line.offset.x),
                 scale.y * (pull(y) * u.y - free.y + y.compliance * load * line.offset.y)};
    TireVisit visit;
    const Vec2 best = minimumInDisc(a, b, visit.sliding);
    visit.impulse = {scale.x * best.x, scale.y * best.y};
    visit.end = {x.end, y.end};
    if (!visit.sliding) visit.grip = 1 / x.compliance;
    return visit;
}

/// By (2), F = N S ((1 − θ) u₀ + θ u + τ (u − u₀)/h), or by (1).
Vec2 deflectionAfter(const TireLaw& law, const TireLine& line, const Vec2& u, const TireVisit& visit, const Vec2& slip,
                     float transport, float load, float h) {
    if (!law.isBrush()) return withinPatch(law, rolledDeflection(law, u, slip, transport, h));
    const float q = secantOver(1);
    const Vec2 stiffness = visit.sliding ? Vec2{q * law.stiffness.x, q * law.stiffness.y} : line.stiffness;
    const Vec2 end = visit.sliding ? Vec2{1, 1} : visit.end;
    const auto after = [&](float impulse, float k, float share, float before) {
        return (impulse / (load * k) * h + (law.damping - (1 - share) * h) * before) / (share * h + law.damping);
    };
    return {after(visit.impulse.x, stiffness.x, end.x, u.x), after(visit.impulse.y, stiffness.y, end.y, u.y)};
}

TireLine lineAfter(const TireLaw& law, const Vec2& bent, bool sliding) {
    if (!law.isBrush() || !sliding) return tireLine(law, bent);
    const float q = secantOver(1);
    return {{}, {q * law.stiffness.x, q * law.stiffness.y}};
}

/// Of a brush Σ k u² ∫ t q(t x) dt = Σ k u² (½ − x/3 + x²/12). Another law has its peak near the beginning: by
/// Simpson's rule over s, t = s², from the forces that it has where it does not slip.
double bentEnergy(const TireLaw& law, const Vec2& u) {
    if (!(law.friction.x > 0) || !(law.friction.y > 0)) return 0;
    const auto along = [&](const Vec2& a) { return static_cast<double>(a.x * u.x + a.y * u.y); };
    if (law.isBrush()) {
        const auto x = static_cast<double>(std::min(slidingShare(law, u), 1.0f));
        return along({law.stiffness.x * u.x, law.stiffness.y * u.y}) * (0.5 - x / 3 + x * x / 12);
    }
    const auto forceAt = [&](float t) {
        const float slip = t / law.relaxation;
        return along(forceOverLoad(law.slips, {slip * u.x, slip * u.y}));
    };
    constexpr int kParts = 8;
    const double rest = forceAt(0);
    double sum = 0;
    for (int k = 1; k <= kParts; ++k) {
        const float s = static_cast<float>(k) / kParts;
        const double weight = k == kParts ? 1 : k % 2 == 1 ? 4 : 2;
        sum += weight * 2 * static_cast<double>(s) * (forceAt(s * s) - rest);
    }
    return std::max(sum / (3 * kParts), 0.0);
}

/// On the line that the forces make between slips that are told apart.
float aligningMoment(const TireLaw& law, const Vec2& u, const SlipForces& forces, float load, float forward) {
    if (law.isBrush()) return 0;
    constexpr float kSlow = 0.5f;  // m/s, at which a wheel has hardly a way that it goes
    const Vec2 slip{u.x / law.relaxation, u.y / law.relaxation}, tried = slipTried(law, u);
    const Vec2 &at = forces.force, &without = forces.withoutOwn;
    SlipForces there = forces;
    there.force = {without.x + (at.x - without.x) * (slip.x / tried.x),
                   without.y + (at.y - without.y) * (slip.y / tried.y)};
    there.across += there.force.y - at.y;
    return load * alignmentOverLoad(law.slips, slip, there, std::clamp(forward / kSlow, -1.0f, 1.0f));
}

}  // namespace ragtop
