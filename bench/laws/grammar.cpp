#include "grammar.h"

#include <algorithm>

#include "kinds.h"

namespace ragtop::laws {

std::span<const Kind> allKinds() {
    static const Kind kKinds[] = {
        {"bridge", drawBridge},     {"net", drawNet},         {"contraption", drawContraption},
        {"carried", drawCarried},   {"drum", drawDrum},       {"figure", drawFigure},
        {"beam", drawBeam},         {"heap", drawHeap},       {"pendulum", drawPendulum},
        {"mixture", drawMixture},   {"pressed", drawPressed}, {"hung", drawHung},
        {"lattice", drawLattice},   {"struck", drawStruck},   {"masonry", drawMasonry},
        {"crossing", drawCrossing}, {"machine", drawMachine}, {"drive", drawDrive},
    };
    return kKinds;
}

Vec3 Ride::velocity(double from, double to) const {
    // The way that the gain of speed makes, a ramp up and one down: ∫∫ a.
    const auto ramp = [](double t) { return 0.5 * std::max(0.0, t) * std::max(0.0, t); };
    const auto way = [&](double t) {
        return ramp(t - phase) - ramp(t - 2 * phase) - ramp(t - 3 * phase) + ramp(t - 4 * phase);
    };
    return start + static_cast<float>((way(to) - way(from)) / (to - from)) * acceleration;
}

Drawn draw(const Kind& kind, std::uint64_t seed) {
    Dice dice(seed);
    Drawn drawn = kind.draw(dice);
    drawn.scene.name = kind.name + "-" + std::to_string(seed);
    drawn.scene.duration = drawn.seconds;
    return drawn;
}

}  // namespace ragtop::laws
