#include <fmt/format.h>

#include <cmath>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {

constexpr double kLink = 0.5;  ///< m
constexpr double kRadius = 0.5;

/// Links of 1 kg on ball joints from the origin, a ball on the last; nothing collides.
struct Chain {
    int links = 10;
    float ratio = 1;          ///< mass of the ball over that of a link
    bool horizontal = false;  ///< let go horizontally; otherwise it hangs
};

Scene sceneOf(const Chain& chain) {
    Scene scene;
    const DVec3 along = chain.horizontal ? DVec3{1, 0, 0} : DVec3{0, -1, 0};
    const Quat turn = rotationBetween({0, 1, 0}, toVec3(along));
    const auto hang = [&](BodyDef def, int above, double joint) {
        def.pose.rotation = turn;
        for (ShapeDef& shape : def.shapes) shape.filter.mask = 0;
        const int body = add(scene, def);
        addBall(scene, above, body, joint * along);
        return body;
    };
    int last = kWorld;
    for (int i = 0; i < chain.links; ++i)
        last = hang(solidBody(Capsule{0.05f, 0.2f}, kLink * (i + 0.5) * along, 1, {}), last, kLink * i);
    const double end = kLink * chain.links;
    hang(solidBody(Sphere{static_cast<float>(kRadius)}, (end + kRadius) * along, chain.ratio, {}), last, end);
    return scene;
}

/// What the chain can win by falling from horizontal to hanging, J.
double wholeDrop(const Chain& chain) {
    const double links = kLink * chain.links;
    return kGravity * (chain.links * links / 2 + static_cast<double>(chain.ratio) * (links + kRadius));
}

double largestGap(Run& run, double seconds) {
    double gap = 0;
    run.advance(seconds, [&] {
        gap = larger(gap, run.jointGap());
        return gap < 100;
    });
    return gap;
}

void hangs(Trial& trial, const Chain& chain) {
    Run run = trial.start(sceneOf(chain));
    trial.expectAtMost("gap", largestGap(run, 10), 0.001, "m");
}

/// Swings for ten seconds; energy is compared after five, over the whole drop.
void swings(Trial& trial, const Chain& chain) {
    Run run = trial.start(sceneOf(chain));
    const double energy = run.energy();
    double gap = largestGap(run, 5);
    const double lost = (energy - run.energy()) / wholeDrop(chain);
    gap = larger(gap, largestGap(run, 5));
    trial.expectAtMost("gap", gap, 0.001, "m");
    trial.expectAtMost("energy lost in 5 s", lost, 0.04, "1");
}

/// Cost of the heavy chain in that of one whose ball weighs as much as a link; they take turns.
void cost(Trial& trial, const Chain& chain) {
    Chain light = chain;
    light.ratio = 1;
    Trial other({"", "", &trial.engine(), trial.dt(), {}});
    Run heavy = trial.start(sceneOf(chain)), even = other.start(sceneOf(light));
    for (int i = 0; i < 10; ++i) {
        heavy.advance(0.5);
        even.advance(0.5);
    }
    trial.expectAtMost("cost over that of 1:1", trial.cpuMs() / other.cpuMs(), 2, "1");
}

}  // namespace

Family chains() {
    Family family{"chain", {}};
    const auto addCase = [&family](const std::string& name, auto&& test, const Chain& chain, Kind kind = Kind::swept,
                                   bool brief = true) {
        family.cases.push_back({name, [=](Trial& trial) { test(trial, chain); }, kind, brief});
    };
    for (const Chain& chain :
         {Chain{10, 100}, Chain{10, 1000}, Chain{20, 10000}, Chain{40, 10000}, Chain{100, 10000}}) {
        const bool required = chain.links <= 20;
        const std::string name = fmt::format("{} links, {}:1", chain.links, chain.ratio);
        const Chain horizontal{chain.links, chain.ratio, true};
        addCase(name + ", hangs", hangs, chain);
        addCase(name + ", swings", swings, horizontal);
        if (required && chain.ratio > 100) addCase(name + ", cost", cost, horizontal, Kind::oneStep, false);
    }
    return family;
}

}  // namespace ragtop::stability
