#include "slip_law.h"

#include <algorithm>
#include <cmath>

#include "four_angles.h"
#include "quick_angles.h"
#include "ragtop/math.h"

namespace ragtop {
namespace {

float cosOfArcTan(float x) { return 1 / std::sqrt(1 + x * x); }
float signOf(float x) { return x > 0 ? 1.0f : x < 0 ? -1.0f : 0.0f; }

/// C atan(B x − E (B x − atan(B x)))
float magicAngle(float B, float C, float E, float x) {
    const float bx = B * x;
    return C * quickArcTan(bx - E * (bx - quickArcTan(bx)));
}

float steepnessAt(const MagicWeight& weight, float own) {
    return weight.B * cosOfArcTan(weight.fall * (own - weight.from));
}

float driftAt(const MagicFactors& magic, float kappa, float alpha) {
    if (magic.drift == 0) return 0;
    return magic.drift * cosOfArcTan(magic.driftFall * alpha) *
           quickSin(magic.driftShape * quickArcTan(magic.driftB * kappa));
}

/// Slip ratio and slip angle, as in .tir files: a wheel that drifts to the left has a positive one.
struct Slips {
    float kappa = 0, alpha = 0, cosine = 1;
};

/// Of a wheel that spins, slip over travel has no bound; there it counts as 1 over the part of travel along the wheel.
Slips slipsOf(const Vec2& slip) {
    const float across = std::clamp(-slip.y, -1.0f, 1.0f), along = std::sqrt(1 - across * across);
    constexpr float kMost = 1, kLeastAlong = 0.1f;  // at right angles a slip ratio is over nothing
    const float kappa = std::clamp(slip.x / std::max(along, kLeastAlong), -kMost, kMost);
    return {kappa, quickArcSin(across, along), along};
}

/// Sines, or cosines, of C atan(B x − E (B x − atan(B x))).
struct FourWaves {
    FourFloats B, C, E, x;

    FourFloats values(FourInts cosines) const {
        const FourFloats bx = B * x;
        return quickSinOrCos(C * quickArcTan(bx - E * (bx - quickArcTan(bx))), cosines);
    }
};

/// A weight by the cosine that it is, over that without the other slip.
float weighed(float cosine, float whole, float other) {
    return other == 0 || !(whole > 0.1f) ? 1 : std::max(cosine / whole, 0.0f);
}

float steepestOf(const MagicCurve& curve, float x) { return std::min(curve.E * (1 - curve.bend * signOf(x)), 1.0f); }

/// What a law has without slip in one of its directions or in both.
void takeRest(MagicFactors& magic) {
    constexpr FourInts kWeightsFirst{-1, -1, 0, 0};
    MagicWeight &u = magic.alongWeight, &v = magic.acrossWeight;
    const MagicCurve &a = magic.along, &b = magic.across;
    u.restB = steepnessAt(u, 0);
    v.restB = steepnessAt(v, 0);
    const FourFloats waves = FourWaves{
        {u.restB, v.restB, a.B, b.B},
        {u.C, v.C, a.C, b.C},
        {u.E, v.E, steepestOf(a, a.shift), steepestOf(b, b.shift)},
        {u.shift, v.shift, a.shift,
         b.shift}}.values(kWeightsFirst);
    u.restWhole = u.shift == 0 ? 1 : waves[0];
    v.restWhole = v.shift == 0 ? 1 : waves[1];
    magic.alongRest = a.D * waves[2] + a.lift;
    magic.acrossRest = b.D * waves[3] + b.lift;
}

/// `alone` is the slip ratio where nothing slips across. The waves that make a force, then those of weights that are
/// not 1 without slip, and of a law whose curves are shifted.
SlipForces forcesOf(const MagicFactors& magic, const Slips& at, float alone) {
    constexpr FourInts kWeightsFirst{-1, -1, 0, 0}, kWeights{-1, -1, -1, -1};
    const MagicWeight &u = magic.alongWeight, &v = magic.acrossWeight;
    const MagicCurve &a = magic.along, &b = magic.across;
    const float steepU = steepnessAt(u, at.kappa), steepV = steepnessAt(v, at.alpha);
    const float kappa = at.kappa + a.shift, alpha = at.alpha + b.shift;
    const FourFloats first = FourWaves{
        {steepU, steepV, a.B, b.B},
        {u.C, v.C, a.C, b.C},
        {u.E, v.E, steepestOf(a, kappa), steepestOf(b, alpha)},
        {at.alpha + u.shift, at.kappa + v.shift, kappa,
         alpha}}.values(kWeightsFirst);
    FourFloats rest{1, 1, 1, 1};
    if (u.shift != 0 || v.shift != 0 || magic.alongRest != 0 || magic.acrossRest != 0)
        rest = FourWaves{{steepU, steepV, u.restB, v.restB},
                         {u.C, v.C, u.C, v.C},
                         {u.E, v.E, u.E, v.E},
                         {u.shift, v.shift, at.alpha + u.shift, alone + v.shift}}
                   .values(kWeights);
    const float wholeU = u.shift == 0 ? 1 : rest[0], wholeV = v.shift == 0 ? 1 : rest[1];
    SlipForces out;
    out.across = weighed(first[1], wholeV, at.kappa) * (b.D * first[3] + b.lift);
    out.force = {weighed(first[0], wholeU, at.alpha) * (a.D * first[2] + a.lift),
                 out.across + driftAt(magic, at.kappa, at.alpha)};
    out.withoutOwn.y = driftAt(magic, alone, 0);
    if (magic.alongRest != 0) out.withoutOwn.x = weighed(rest[2], u.restWhole, at.alpha) * magic.alongRest;
    if (magic.acrossRest != 0) out.withoutOwn.y += weighed(rest[3], v.restWhole, alone) * magic.acrossRest;
    return out;
}

/// Up to the peak, down to the slide, and on.
float valueAt(const SlipCurve& curve, float slip) {
    const float x = slip / curve.peakSlip;
    if (x <= 1) return curve.peakFriction * x * (2 - x);
    const float way = std::min((slip - curve.peakSlip) / (curve.slideSlip - curve.peakSlip), 1.0f);
    const float fallen = way * way * (3 - 2 * way);
    return curve.peakFriction + fallen * (curve.slideFriction - curve.peakFriction);
}

Vec2 forceOf(const SlipCurves& curves, const Vec2& slip) {
    const Vec2 x{slip.x / curves.along.peakSlip, slip.y / curves.across.peakSlip};
    const float size = std::sqrt(x.x * x.x + x.y * x.y);
    if (!(size > 0)) return {};
    const auto part = [&](const SlipCurve& curve, float own) {
        return curves.grip * valueAt(curve, size * curve.peakSlip) * own / size;
    };
    return {part(curves.along, x.x), part(curves.across, x.y)};
}

/// Names a coefficient, which the compiler looks up.
struct Name {
    std::size_t index;
    consteval Name(const char* name) : index(magicIndex(name)) {}
};

/// The coefficients at a load: of(a) + of(b) dfz.
struct Numbers {
    const MagicFormulaDef& def;
    float dfz = 0, dpi = 0;  ///< of load and pressure from the nominal ones, over these
    float operator()(Name name) const { return def.values[name.index]; }
    float atLoad(Name a, Name b) const { return (*this)(a) + (*this)(b)*dfz; }
    float pressed(Name a) const { return 1 + (*this)(a)*dpi; }
    float pressed(Name a, Name b) const { return 1 + (*this)(a)*dpi + (*this)(b)*dpi * dpi; }
    bool isNew() const { return (*this)("FITTYP") >= 60; }
};

Numbers numbersAt(const MagicFormulaDef& def, float& load) {
    Numbers of{def};
    const float nominal = of("LFZO") * of("FNOMIN");
    load = std::clamp(load, std::max(of("FZMIN"), 0.01f * nominal), std::max(of("FZMAX"), 0.01f * nominal));
    of.dfz = (load - nominal) / nominal;
    of.dpi = (of("INFLPRES") - of("NOMPRES")) / of("NOMPRES");
    return of;
}

constexpr float kLeast = 0.01f;  ///< friction, and share of what extrapolates to nothing or below

/// (4.E9) to (4.E18), over load.
MagicCurve alongAt(const Numbers& of, const TireStand& at, float camber2, float& stiffness) {
    MagicCurve x;
    x.C = of("PCX1") * of("LCX");
    const float friction = of.atLoad("PDX1", "PDX2") * (1 - of("PDX3") * camber2) * of.pressed("PPX3", "PPX4");
    x.D = std::max(friction * of("LMUX"), kLeast) * at.grip;
    x.E = (of.atLoad("PEX1", "PEX2") + of("PEX3") * of.dfz * of.dfz) * of("LEX");
    x.bend = of("PEX4");
    const float slope = of.atLoad("PKX1", "PKX2") * exponential(of("PKX3") * of.dfz) * of.pressed("PPX1", "PPX2");
    stiffness = std::max(slope, kLeast) * of("LKX") * at.stiffness;
    x.B = stiffness / (x.C * x.D);
    x.shift = of.atLoad("PHX1", "PHX2") * of("LHX");
    x.lift = of.atLoad("PVX1", "PVX2") * of("LVX") * of("LMUX") * at.grip;
    return x;
}

/// (4.E19) to (4.E30), over load; the shift of camber is of the version.
MagicCurve acrossAt(const Numbers& of, const TireStand& at, float load, float& stiffness) {
    const float camber = at.inclination, camber2 = camber * camber, nominal = of("LFZO") * of("FNOMIN");
    MagicCurve y;
    y.C = of("PCY1") * of("LCY");
    const float friction = of.atLoad("PDY1", "PDY2") * (1 - of("PDY3") * camber2) * of.pressed("PPY3", "PPY4");
    y.D = std::max(friction * of("LMUY"), kLeast) * at.grip;
    const float softened = (of("PKY2") + of("PKY5") * camber2) * of.pressed("PPY2") * nominal;
    const float turned = (of.isNew() ? of("PKY4") : 2) * quickArcTan(load / softened);
    stiffness = of("PKY1") * nominal / load * of.pressed("PPY1") * quickSin(turned) *
                (1 - of("PKY3") * std::abs(camber)) * of("LKY") * at.stiffness;
    stiffness = std::min(stiffness, -kLeast);
    y.B = stiffness / (y.C * y.D);
    y.E = of.atLoad("PEY1", "PEY2") * (1 + of("PEY5") * camber2) * of("LEY");
    const float even = 1 + of("PEY5") * camber2;
    y.bend = even != 0 ? (of("PEY3") + of("PEY4") * camber) / even : 0;
    const float leaned = of.atLoad("PVY3", "PVY4") * camber * of("LKYC") * of("LMUY") * at.grip;
    y.lift = of.atLoad("PVY1", "PVY2") * of("LVY") * of("LMUY") * at.grip + leaned;
    y.shift = of.atLoad("PHY1", "PHY2") * of("LHY");
    if (of.isNew()) {
        const float thrust = of.atLoad("PKY6", "PKY7") * of.pressed("PPY5") * of("LKYC");
        y.shift += (thrust * camber - leaned) / stiffness;
    } else {
        y.shift += of("PHY3") * camber * of("LKYC");
    }
    return y;
}

/// (4.E31) to (4.E49).
void addAlignment(const Numbers& of, const TireStand& at, MagicFactors& magic) {
    const float camber = at.inclination, radius = of("UNLOADED_RADIUS");
    const float stiffened = of("LKY") * at.stiffness / (of("LMUY") * at.grip);
    const float dfz2 = of.dfz * of.dfz;
    magic.trailB = (of.atLoad("QBZ1", "QBZ2") + of("QBZ3") * dfz2) *
                   (1 + of("QBZ4") * camber + of("QBZ5") * std::abs(camber)) * stiffened;
    magic.trailC = of("QCZ1");
    magic.trailD = (1 + of.dfz) * radius * of.atLoad("QDZ1", "QDZ2") * (1 - of("PPZ1") * of.dpi) *
                   (1 + of("QDZ3") * camber + of("QDZ4") * camber * camber) * of("LTR");
    magic.trailE = of.atLoad("QEZ1", "QEZ2") + of("QEZ3") * dfz2;
    magic.trailBend = of("QEZ4") + of("QEZ5") * camber;
    magic.trailShift = of.atLoad("QHZ1", "QHZ2") + of.atLoad("QHZ3", "QHZ4") * camber;
    magic.residualB = of("QBZ9") * stiffened + of("QBZ10") * magic.across.B * magic.across.C;
    magic.residualD = radius *
                      (of.atLoad("QDZ6", "QDZ7") * of("LRES") + (of.atLoad("QDZ8", "QDZ9") * (1 + of("PPZ2") * of.dpi) +
                                                                 of.atLoad("QDZ10", "QDZ11") * std::abs(camber)) *
                                                                    camber) *
                      of("LMUY") * at.grip;
    magic.residualShift = magic.across.shift + magic.across.lift / magic.corneringStiffness;
    magic.arm = radius * (of("SSZ1") + of.atLoad("SSZ3", "SSZ4") * camber) * of("LS");
    magic.armPerForce = radius * of("SSZ2") * (1 + of.dfz) * of("LS");
}

}  // namespace

/// (4.E50) to (4.E67) for the weights.
MagicFactors magicFactors(const MagicFormulaDef& def, const TireStand& stand) {
    constexpr float kMostLean = 0.6f;  // rad, beyond which nothing is measured
    TireStand at = stand;
    at.inclination = std::clamp(at.inclination, -kMostLean, kMostLean);
    float load = at.load;
    const Numbers of = numbersAt(def, load);
    const float camber = at.inclination, camber2 = camber * camber;
    MagicFactors magic;
    magic.along = alongAt(of, at, camber2, magic.slipStiffness);
    magic.across = acrossAt(of, at, load, magic.corneringStiffness);
    magic.alongWeight = {(of("RBX1") + of("RBX3") * camber2) * of("LXAL"),
                         of("RCX1"),
                         std::min(of.atLoad("REX1", "REX2"), 1.0f),
                         of("RHX1"),
                         of("RBX2"),
                         0};
    magic.acrossWeight = {(of("RBY1") + of("RBY4") * camber2) * of("LYKA"),
                          of("RCY1"),
                          std::min(of.atLoad("REY1", "REY2"), 1.0f),
                          of.atLoad("RHY1", "RHY2"),
                          of("RBY2"),
                          of("RBY3")};
    magic.drift = magic.across.D * (of.atLoad("RVY1", "RVY2") + of("RVY3") * camber) * of("LVYKA");
    magic.driftFall = of("RVY4");
    magic.driftShape = of("RVY5");
    magic.driftB = of("RVY6");
    addAlignment(of, at, magic);
    takeRest(magic);
    return magic;
}

SlipCurves slipCurves(const SlipCurvesDef& def, const TireStand& stand) {
    return {def.longitudinal, def.lateral, stand.grip};
}

SlipForces forcesOverLoad(const SlipLaw& law, const Vec2& slip) {
    if (const auto* curves = std::get_if<SlipCurves>(&law)) return {forceOf(*curves, slip), {}, 0};
    const auto* magic = std::get_if<MagicFactors>(&law);
    if (!magic) return {};
    return forcesOf(*magic, slipsOf(slip), std::clamp(slip.x, -1.0f, 1.0f));
}

/// Mz = −t F'y + Mzr + s Fx, (4.E71) to (4.E78).
float alignmentOverLoad(const SlipLaw& law, const Vec2& slip, const SlipForces& forces, float forward) {
    const auto* magic = std::get_if<MagicFactors>(&law);
    if (!magic) return 0;
    const Slips at = slipsOf(slip);
    const Vec2 force = forces.force;
    const float ratio = magic->slipStiffness / magic->corneringStiffness * at.kappa;
    // tan² of the angle that has the same of both slips.
    const auto equivalent = [&](float angle) {
        const float tangent = quickSin(angle) / std::max(quickCos(angle), 1e-3f);
        return quickArcTan(std::sqrt(tangent * tangent + ratio * ratio)) * (angle < 0 ? -1.0f : 1.0f);
    };
    const float trailing = at.alpha + magic->trailShift;
    const float bent = 1 + magic->trailBend * (2 / kPi) * quickArcTan(magic->trailB * magic->trailC * trailing);
    const float E = std::min(magic->trailE * bent, 1.0f);
    const float trail = forward * magic->trailD * at.cosine *
                        quickCos(magicAngle(magic->trailB, magic->trailC, E, equivalent(trailing)));
    const float residual =
        magic->residualD * at.cosine * cosOfArcTan(magic->residualB * equivalent(at.alpha + magic->residualShift));
    return residual - trail * forces.across + (magic->arm + magic->armPerForce * force.y) * force.x;
}

Vec2 peakFriction(const SlipLaw& law) {
    if (const auto* magic = std::get_if<MagicFactors>(&law))
        return {magic->along.D + std::abs(magic->along.lift),
                magic->across.D + std::abs(magic->across.lift) + std::abs(magic->drift)};
    if (const auto* curves = std::get_if<SlipCurves>(&law))
        return {curves->grip * curves->along.peakFriction, curves->grip * curves->across.peakFriction};
    return {};
}

Vec2 slopeAtRest(const SlipLaw& law) {
    if (const auto* magic = std::get_if<MagicFactors>(&law)) return {magic->slipStiffness, -magic->corneringStiffness};
    if (const auto* curves = std::get_if<SlipCurves>(&law))
        return {2 * curves->grip * curves->along.peakFriction / curves->along.peakSlip,
                2 * curves->grip * curves->across.peakFriction / curves->across.peakSlip};
    return {};
}

/// In double, by e^x = (e^(x/16))^16.
float exponential(float x) {
    const double y = static_cast<double>(std::clamp(x, -80.0f, 80.0f)) / 16;
    double sum = 1, term = 1;
    for (int i = 1; i <= 18; ++i) {
        term *= y / i;
        sum += term;
    }
    for (int i = 0; i < 4; ++i) sum *= sum;
    return static_cast<float>(sum);
}

}  // namespace ragtop
