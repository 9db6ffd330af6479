#include "grammar.h"

#include "kinds.h"

namespace ragtop::laws {

std::span<const Kind> allKinds() {
    static const Kind kKinds[] = {
        {"bridge", drawBridge},   {"net", drawNet},         {"contraption", drawContraption}, {"carried", drawCarried},
        {"drum", drawDrum},       {"figure", drawFigure},   {"beam", drawBeam},               {"heap", drawHeap},
        {"pendulum", drawPendulum}, {"mixture", drawMixture},
    };
    return kKinds;
}

Drawn draw(const Kind& kind, std::uint64_t seed) {
    Dice dice(seed);
    Drawn drawn = kind.draw(dice);
    drawn.scene.name = kind.name + "-" + std::to_string(seed);
    drawn.scene.duration = drawn.seconds;
    return drawn;
}

}  // namespace ragtop::laws
