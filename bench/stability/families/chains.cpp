#include <fmt/format.h>

#include <cmath>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace chains_cases {

constexpr double kLink = 0.5;  ///< m
constexpr double kRadius = 0.5;
constexpr double kClosed = 0.001;  ///< m, of gap

/// Links of 1 kg on ball joints from the origin, a ball on the last; nothing collides.
struct Chain {
    int links = 10;
    float ratio = 1;          ///< mass of the ball over that of a link
    bool horizontal = false;  ///< let go horizontally; otherwise it hangs
    double spread = 0;        ///< up to which links lie across that direction, each way, over their length
    float whirl = 0;          ///< rad/s about the vertical, the whole chain
};

Scene sceneOf(const Chain& chain, int seed = 1) {
    Scene scene;
    Dice dice(static_cast<std::uint64_t>(seed));
    const auto hang = [&](BodyDef def, int above, const DVec3& joint, const DVec3& along, double length) {
        def.pose = {joint + length / 2 * along, rotationBetween({0, 1, 0}, toVec3(along))};
        def.angularVelocity = {0, chain.whirl, 0};
        def.linearVelocity = cross(def.angularVelocity, toVec3(def.pose.position));
        for (ShapeDef& shape : def.shapes) shape.filter.mask = 0;
        const int body = add(scene, def);
        addBall(scene, above, body, joint);
        return body;
    };
    const auto direction = [&] {
        const auto across = [&] { return chain.spread * static_cast<double>(dice.between(-1, 1)); };
        const double x = across(), y = across();
        const DVec3 d = chain.horizontal ? DVec3{1, x, y} : DVec3{x, -1, y};
        return (1 / std::hypot(d.x, d.y, d.z)) * d;
    };
    int last = kWorld;
    DVec3 joint;
    for (int i = 0; i < chain.links; ++i) {
        const DVec3 along = direction();
        last = hang(solidBody(Capsule{0.05f, 0.2f}, {}, 1, {}), last, joint, along, kLink);
        joint = joint + kLink * along;
    }
    hang(solidBody(Sphere{static_cast<float>(kRadius)}, {}, chain.ratio, {}), last, joint, direction(), 2 * kRadius);
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

/// Links begin up to a millimetre aside.
void hangs(Trial& trial, const Chain& chain) {
    double gap = 0;
    for (int seed = 1; seed <= trial.starts(); ++seed) {
        Chain crooked = chain;
        crooked.spread = 0.001 / kLink;
        Run run = trial.start(sceneOf(crooked, seed), fmt::format("{}", seed));
        gap = larger(gap, largestGap(run, 10));
    }
    trial.expectAtMost("gap", gap, kClosed, "m");
}

struct Swing {
    double gap = 0, lost = 0;  ///< m; energy after five seconds over the whole drop
};

/// For ten seconds.
Swing swing(Run& run, const Chain& chain) {
    const double energy = run.energy();
    Swing result;
    result.gap = largestGap(run, 5);
    result.lost = std::abs(energy - run.energy()) / wholeDrop(chain);
    result.gap = larger(result.gap, largestGap(run, 5));
    return result;
}

void swings(Trial& trial, const Chain& chain) {
    Run run = trial.start(sceneOf(chain));
    const Swing result = swing(run, chain);
    trial.expectAtMost("gap", result.gap, kClosed, "m");
    trial.expectAtMost("energy lost in 5 s", result.lost, 0.04, "1");
}

/// Crooked by up to 5 cm a link and turning, so that it leaves every plane.
void whirls(Trial& trial, const Chain& chain) {
    Chain crooked = chain;
    crooked.spread = 0.1;
    crooked.whirl = 1;
    Swing worst;
    int closed = 0;
    for (int seed = 1; seed <= trial.starts(); ++seed) {
        Run run = trial.start(sceneOf(crooked, seed), fmt::format("{}", seed));
        const Swing result = swing(run, crooked);
        if (result.gap <= kClosed) ++closed;
        worst = {larger(worst.gap, result.gap), larger(worst.lost, result.lost)};
    }
    trial.expectAtLeast(fmt::format("stay closed, of {}", trial.starts()), closed, trial.starts(), "chains");
    trial.expectAtMost("gap", worst.gap, kClosed, "m");
    trial.expectAtMost("energy lost in 5 s", worst.lost, 0.04, "1");
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

}  // namespace chains_cases
}  // namespace

Family chains() {
    using namespace chains_cases;
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
        // Of forty links and more it takes seconds.
        addCase(name + ", swings out of the plane", whirls, horizontal, Kind::swept, chain.links <= 20);
        if (required && chain.ratio > 100) addCase(name + ", cost", cost, horizontal, Kind::oneStep, false);
    }
    return family;
}

}  // namespace ragtop::stability
