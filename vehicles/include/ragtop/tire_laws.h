#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "ragtop/tunables.h"

/// Laws of tires besides the brush of TireDef: what is measured, and what a designer draws.
namespace ragtop {

/// A number of a Magic Formula tire, as tire property files (.tir) name it.
struct MagicCoefficient {
    Tunable tunable;
    float standard = 0;
};

/// All numbers of the Magic Formula 5.2 and 6.1 that are read, but for turn slip and overturning. What they stand for:
/// [Pacejka 2012, 4.3.2].
inline constexpr std::array kMagicCoefficients{
    MagicCoefficient{{"FITTYP", "", 5, 62, "61 or 62: version 6.1; else 5.2"}, 61},
    MagicCoefficient{{"FNOMIN", "N", 1e-3, 1e9, "nominal load"}, 4000},
    MagicCoefficient{{"UNLOADED_RADIUS", "m", 1e-3, 1e3, "of the free tire"}, 0.3f},
    MagicCoefficient{{"NOMPRES", "Pa", 1, 1e9, "nominal pressure"}, 220000},
    MagicCoefficient{{"INFLPRES", "Pa", 1, 1e9, "pressure"}, 220000},
    MagicCoefficient{{"FZMIN", "N", 0, 1e9, "least load that was measured"}, 0},
    MagicCoefficient{{"FZMAX", "N", 1e-3, 1e12, "largest load that was measured"}, 1e12f},
    MagicCoefficient{{"LFZO", "1", 1e-3, 1e3, "scale of FZO"}, 1},
    MagicCoefficient{{"LCX", "1", 1e-3, 1e3, "scale of CX"}, 1},
    MagicCoefficient{{"LMUX", "1", 1e-3, 1e3, "scale of MUX"}, 1},
    MagicCoefficient{{"LEX", "1", -1e3, 1e3, "scale of EX"}, 1},
    MagicCoefficient{{"LKX", "1", 1e-3, 1e3, "scale of KX"}, 1},
    MagicCoefficient{{"LHX", "1", -1e3, 1e3, "scale of HX"}, 1},
    MagicCoefficient{{"LVX", "1", -1e3, 1e3, "scale of VX"}, 1},
    MagicCoefficient{{"LCY", "1", 1e-3, 1e3, "scale of CY"}, 1},
    MagicCoefficient{{"LMUY", "1", 1e-3, 1e3, "scale of MUY"}, 1},
    MagicCoefficient{{"LEY", "1", -1e3, 1e3, "scale of EY"}, 1},
    MagicCoefficient{{"LKY", "1", 1e-3, 1e3, "scale of KY"}, 1},
    MagicCoefficient{{"LHY", "1", -1e3, 1e3, "scale of HY"}, 1},
    MagicCoefficient{{"LVY", "1", -1e3, 1e3, "scale of VY"}, 1},
    MagicCoefficient{{"LTR", "1", -1e3, 1e3, "scale of TR"}, 1},
    MagicCoefficient{{"LRES", "1", -1e3, 1e3, "scale of RES"}, 1},
    MagicCoefficient{{"LXAL", "1", -1e3, 1e3, "scale of XAL"}, 1},
    MagicCoefficient{{"LYKA", "1", -1e3, 1e3, "scale of YKA"}, 1},
    MagicCoefficient{{"LVYKA", "1", -1e3, 1e3, "scale of VYKA"}, 1},
    MagicCoefficient{{"LS", "1", -1e3, 1e3, "scale of S"}, 1},
    MagicCoefficient{{"LKYC", "1", -1e3, 1e3, "scale of KYC"}, 1},
    MagicCoefficient{{"PCX1", "1", 1e-3, 1e6, "longitudinal: shape"}, 1.6f},
    MagicCoefficient{{"PDX1", "1", 1e-3, 1e6, "longitudinal: peak"}, 1.1f},
    MagicCoefficient{{"PDX2", "1", -1e6, 1e6, "longitudinal: peak"}, -0.08f},
    MagicCoefficient{{"PDX3", "1", -1e6, 1e6, "longitudinal: peak"}, 0},
    MagicCoefficient{{"PEX1", "1", -1e6, 1e6, "longitudinal: curvature"}, 0.4f},
    MagicCoefficient{{"PEX2", "1", -1e6, 1e6, "longitudinal: curvature"}, 0},
    MagicCoefficient{{"PEX3", "1", -1e6, 1e6, "longitudinal: curvature"}, 0},
    MagicCoefficient{{"PEX4", "1", -1e6, 1e6, "longitudinal: curvature"}, 0},
    MagicCoefficient{{"PKX1", "1", 1e-3, 1e6, "longitudinal: slip stiffness"}, 22},
    MagicCoefficient{{"PKX2", "1", -1e6, 1e6, "longitudinal: slip stiffness"}, -0.5f},
    MagicCoefficient{{"PKX3", "1", -1e6, 1e6, "longitudinal: slip stiffness"}, 0},
    MagicCoefficient{{"PHX1", "1", -1e6, 1e6, "longitudinal: horizontal shift"}, 0},
    MagicCoefficient{{"PHX2", "1", -1e6, 1e6, "longitudinal: horizontal shift"}, 0},
    MagicCoefficient{{"PVX1", "1", -1e6, 1e6, "longitudinal: vertical shift"}, 0},
    MagicCoefficient{{"PVX2", "1", -1e6, 1e6, "longitudinal: vertical shift"}, 0},
    MagicCoefficient{{"PPX1", "1", -1e6, 1e6, "longitudinal: of pressure"}, 0},
    MagicCoefficient{{"PPX2", "1", -1e6, 1e6, "longitudinal: of pressure"}, 0},
    MagicCoefficient{{"PPX3", "1", -1e6, 1e6, "longitudinal: of pressure"}, 0},
    MagicCoefficient{{"PPX4", "1", -1e6, 1e6, "longitudinal: of pressure"}, 0},
    MagicCoefficient{{"RBX1", "1", -1e6, 1e6, "longitudinal, combined: stiffness factor"}, 12},
    MagicCoefficient{{"RBX2", "1", -1e6, 1e6, "longitudinal, combined: stiffness factor"}, -10},
    MagicCoefficient{{"RBX3", "1", -1e6, 1e6, "longitudinal, combined: stiffness factor"}, 0},
    MagicCoefficient{{"RCX1", "1", -1e6, 1e6, "longitudinal, combined: shape"}, 1.1f},
    MagicCoefficient{{"REX1", "1", -1e6, 1e6, "longitudinal, combined: curvature"}, 0},
    MagicCoefficient{{"REX2", "1", -1e6, 1e6, "longitudinal, combined: curvature"}, 0},
    MagicCoefficient{{"RHX1", "1", -1e6, 1e6, "longitudinal, combined: horizontal shift"}, 0},
    MagicCoefficient{{"PCY1", "1", 1e-3, 1e6, "lateral: shape"}, 1.3f},
    MagicCoefficient{{"PDY1", "1", 1e-3, 1e6, "lateral: peak"}, 1.0f},
    MagicCoefficient{{"PDY2", "1", -1e6, 1e6, "lateral: peak"}, -0.1f},
    MagicCoefficient{{"PDY3", "1", -1e6, 1e6, "lateral: peak"}, 0},
    MagicCoefficient{{"PEY1", "1", -1e6, 1e6, "lateral: curvature"}, -0.5f},
    MagicCoefficient{{"PEY2", "1", -1e6, 1e6, "lateral: curvature"}, 0},
    MagicCoefficient{{"PEY3", "1", -1e6, 1e6, "lateral: curvature"}, 0},
    MagicCoefficient{{"PEY4", "1", -1e6, 1e6, "lateral: curvature"}, 0},
    MagicCoefficient{{"PEY5", "1", -1e6, 1e6, "lateral: curvature"}, 0},
    MagicCoefficient{{"PKY1", "1", -1e6, -1e-3, "lateral: slip stiffness"}, -20},
    MagicCoefficient{{"PKY2", "1", 1e-3, 1e6, "lateral: slip stiffness"}, 1.6f},
    MagicCoefficient{{"PKY3", "1", -1e6, 1e6, "lateral: slip stiffness"}, 0},
    MagicCoefficient{{"PKY4", "1", 1e-3, 1e6, "lateral: slip stiffness"}, 2},
    MagicCoefficient{{"PKY5", "1", -1e6, 1e6, "lateral: slip stiffness"}, 0},
    MagicCoefficient{{"PKY6", "1", -1e6, 1e6, "lateral: slip stiffness"}, 0},
    MagicCoefficient{{"PKY7", "1", -1e6, 1e6, "lateral: slip stiffness"}, 0},
    MagicCoefficient{{"PHY1", "1", -1e6, 1e6, "lateral: horizontal shift"}, 0},
    MagicCoefficient{{"PHY2", "1", -1e6, 1e6, "lateral: horizontal shift"}, 0},
    MagicCoefficient{{"PHY3", "1", -1e6, 1e6, "lateral: horizontal shift"}, 0},
    MagicCoefficient{{"PVY1", "1", -1e6, 1e6, "lateral: vertical shift"}, 0},
    MagicCoefficient{{"PVY2", "1", -1e6, 1e6, "lateral: vertical shift"}, 0},
    MagicCoefficient{{"PVY3", "1", -1e6, 1e6, "lateral: vertical shift"}, 0},
    MagicCoefficient{{"PVY4", "1", -1e6, 1e6, "lateral: vertical shift"}, 0},
    MagicCoefficient{{"PPY1", "1", -1e6, 1e6, "lateral: of pressure"}, 0},
    MagicCoefficient{{"PPY2", "1", -1e6, 1e6, "lateral: of pressure"}, 0},
    MagicCoefficient{{"PPY3", "1", -1e6, 1e6, "lateral: of pressure"}, 0},
    MagicCoefficient{{"PPY4", "1", -1e6, 1e6, "lateral: of pressure"}, 0},
    MagicCoefficient{{"PPY5", "1", -1e6, 1e6, "lateral: of pressure"}, 0},
    MagicCoefficient{{"RBY1", "1", -1e6, 1e6, "lateral, combined: stiffness factor"}, 9},
    MagicCoefficient{{"RBY2", "1", -1e6, 1e6, "lateral, combined: stiffness factor"}, 8},
    MagicCoefficient{{"RBY3", "1", -1e6, 1e6, "lateral, combined: stiffness factor"}, 0},
    MagicCoefficient{{"RBY4", "1", -1e6, 1e6, "lateral, combined: stiffness factor"}, 0},
    MagicCoefficient{{"RCY1", "1", -1e6, 1e6, "lateral, combined: shape"}, 1.05f},
    MagicCoefficient{{"REY1", "1", -1e6, 1e6, "lateral, combined: curvature"}, 0},
    MagicCoefficient{{"REY2", "1", -1e6, 1e6, "lateral, combined: curvature"}, 0},
    MagicCoefficient{{"RHY1", "1", -1e6, 1e6, "lateral, combined: horizontal shift"}, 0},
    MagicCoefficient{{"RHY2", "1", -1e6, 1e6, "lateral, combined: horizontal shift"}, 0},
    MagicCoefficient{{"RVY1", "1", -1e6, 1e6, "lateral, combined: vertical shift"}, 0},
    MagicCoefficient{{"RVY2", "1", -1e6, 1e6, "lateral, combined: vertical shift"}, 0},
    MagicCoefficient{{"RVY3", "1", -1e6, 1e6, "lateral, combined: vertical shift"}, 0},
    MagicCoefficient{{"RVY4", "1", -1e6, 1e6, "lateral, combined: vertical shift"}, 0},
    MagicCoefficient{{"RVY5", "1", -1e6, 1e6, "lateral, combined: vertical shift"}, 0},
    MagicCoefficient{{"RVY6", "1", -1e6, 1e6, "lateral, combined: vertical shift"}, 0},
    MagicCoefficient{{"QBZ1", "1", -1e6, 1e6, "aligning: stiffness factor"}, 8},
    MagicCoefficient{{"QBZ2", "1", -1e6, 1e6, "aligning: stiffness factor"}, 0},
    MagicCoefficient{{"QBZ3", "1", -1e6, 1e6, "aligning: stiffness factor"}, 0},
    MagicCoefficient{{"QBZ4", "1", -1e6, 1e6, "aligning: stiffness factor"}, 0},
    MagicCoefficient{{"QBZ5", "1", -1e6, 1e6, "aligning: stiffness factor"}, 0},
    MagicCoefficient{{"QBZ9", "1", -1e6, 1e6, "aligning: stiffness factor"}, 0},
    MagicCoefficient{{"QBZ10", "1", -1e6, 1e6, "aligning: stiffness factor"}, 0},
    MagicCoefficient{{"QCZ1", "1", -1e6, 1e6, "aligning: shape"}, 1.1f},
    MagicCoefficient{{"QDZ1", "1", -1e6, 1e6, "aligning: peak"}, 0.1f},
    MagicCoefficient{{"QDZ2", "1", -1e6, 1e6, "aligning: peak"}, 0},
    MagicCoefficient{{"QDZ3", "1", -1e6, 1e6, "aligning: peak"}, 0},
    MagicCoefficient{{"QDZ4", "1", -1e6, 1e6, "aligning: peak"}, 0},
    MagicCoefficient{{"QDZ6", "1", -1e6, 1e6, "aligning: peak"}, 0},
    MagicCoefficient{{"QDZ7", "1", -1e6, 1e6, "aligning: peak"}, 0},
    MagicCoefficient{{"QDZ8", "1", -1e6, 1e6, "aligning: peak"}, 0},
    MagicCoefficient{{"QDZ9", "1", -1e6, 1e6, "aligning: peak"}, 0},
    MagicCoefficient{{"QDZ10", "1", -1e6, 1e6, "aligning: peak"}, 0},
    MagicCoefficient{{"QDZ11", "1", -1e6, 1e6, "aligning: peak"}, 0},
    MagicCoefficient{{"QEZ1", "1", -1e6, 1e6, "aligning: curvature"}, 0},
    MagicCoefficient{{"QEZ2", "1", -1e6, 1e6, "aligning: curvature"}, 0},
    MagicCoefficient{{"QEZ3", "1", -1e6, 1e6, "aligning: curvature"}, 0},
    MagicCoefficient{{"QEZ4", "1", -1e6, 1e6, "aligning: curvature"}, 0},
    MagicCoefficient{{"QEZ5", "1", -1e6, 1e6, "aligning: curvature"}, 0},
    MagicCoefficient{{"QHZ1", "1", -1e6, 1e6, "aligning: horizontal shift"}, 0},
    MagicCoefficient{{"QHZ2", "1", -1e6, 1e6, "aligning: horizontal shift"}, 0},
    MagicCoefficient{{"QHZ3", "1", -1e6, 1e6, "aligning: horizontal shift"}, 0},
    MagicCoefficient{{"QHZ4", "1", -1e6, 1e6, "aligning: horizontal shift"}, 0},
    MagicCoefficient{{"PPZ1", "1", -1e6, 1e6, "aligning: of pressure"}, 0},
    MagicCoefficient{{"PPZ2", "1", -1e6, 1e6, "aligning: of pressure"}, 0},
    MagicCoefficient{{"SSZ1", "1", -1e6, 1e6, "aligning: arm of the longitudinal force"}, 0},
    MagicCoefficient{{"SSZ2", "1", -1e6, 1e6, "aligning: arm of the longitudinal force"}, 0},
    MagicCoefficient{{"SSZ3", "1", -1e6, 1e6, "aligning: arm of the longitudinal force"}, 0},
    MagicCoefficient{{"SSZ4", "1", -1e6, 1e6, "aligning: arm of the longitudinal force"}, 0},
};

/// Where a coefficient is in the table.
consteval std::size_t magicIndex(std::string_view name) {
    for (std::size_t i = 0; i < kMagicCoefficients.size(); ++i) {
        if (kMagicCoefficients[i].tunable.name == name) return i;
    }
    throw "no coefficient of that name";
}

/// A Magic Formula tire: pure and combined slip, camber, pressure and aligning moment [Pacejka 2012, 4.3.2], in the
/// axes of .tir files (ISO-W: x forward, y to the left, camber to the right). Loads beyond FZMIN and FZMAX have the
/// frictions and stiffnesses over load of these.
struct MagicFormulaDef {
    std::array<float, kMagicCoefficients.size()> values = [] {
        std::array<float, kMagicCoefficients.size()> standards{};
        for (std::size_t i = 0; i < standards.size(); ++i) standards[i] = kMagicCoefficients[i].standard;
        return standards;
    }();
};

/// The rise and fall of friction over slip in one direction: x (2 - x) of the peak for x = slip over peakSlip up to 1,
/// and from there smoothly down to the slide, which holds beyond slideSlip.
struct SlipCurve {
    float peakSlip = 0.12f;      ///< slip ratio, or tangent of the slip angle
    float peakFriction = 1.05f;  ///< force over load
    float slideSlip = 0.6f;
    float slideFriction = 0.85f;
};

/// Two curves instead of coefficients. In combined slip each direction has its share of the slips over their peaks, as
/// a vector, at that vector's length.
struct SlipCurvesDef {
    SlipCurve longitudinal{};
    SlipCurve lateral{.peakSlip = 0.15f, .peakFriction = 1, .slideSlip = 0.7f, .slideFriction = 0.85f};
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const MagicFormulaDef*) {
    for (std::size_t i = 0; i < kMagicCoefficients.size(); ++i) visit(kMagicCoefficients[i].tunable, self.values[i]);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SlipCurve*) {
    visit(Tunable{"peakSlip", "1", 1e-3, 0.9, "slip ratio, or tangent of the slip angle, of most friction"},
          self.peakSlip);
    visit(Tunable{"peakFriction", "1", 0.01, 10, "largest force over load"}, self.peakFriction);
    visit(Tunable{"slideSlip", "1", 1e-3, 1, "from which on it slides"}, self.slideSlip);
    visit(Tunable{"slideFriction", "1", 0.01, 10, "force over load of what slides"}, self.slideFriction);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SlipCurvesDef*) {
    visit(Tunable{"longitudinal", "", 0, 0, "along the wheel"}, self.longitudinal);
    visit(Tunable{"lateral", "", 0, 0, "across the wheel"}, self.lateral);
}

}  // namespace ragtop
