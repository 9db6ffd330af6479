#include "ragdoll_costs.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "contender.h"
#include "ragtop/body_pose.h"
#include "ragtop/cloth.h"
#include "ragtop/data_folder.h"
#include "ragtop/puppet.h"
#include "ragtop/ragdoll_file.h"
#include "ragtop/ragdoll_lod.h"
#include "ragtop/spring_bones.h"
#include "ragtop/world.h"
#include "rows.h"

namespace ragtop::speed {
namespace {

constexpr double kFrame = 1.0 / 60;

/// ms of so many calls, each.
double timeOf(int calls, const std::function<void()>& call, Clock clock = Clock::processor) {
    const double before = now(clock);
    for (int i = 0; i < calls; ++i) call();
    return (now(clock) - before) / calls;
}

double medianTime(int runs, int calls, const std::function<void()>& call) {
    std::vector<double> times;
    for (int run = 0; run < runs; ++run) times.push_back(timeOf(calls, call));
    return medianOf(times)->value;
}

/// Bytes of the heap that are given out.
double heapBytes() {
    const struct mallinfo2 info = mallinfo2();
    return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

WorldSettings settings(bool sleeping) {
    WorldSettings made;
    made.sleeping = sleeping;
    return made;
}

/// A world with a floor and room for ragdolls.
struct Stage {
    explicit Stage(bool sleeping, int threads = 1)
        : world(settings(sleeping), {.tasks = threads > 1 ? threadTasks(threads) : serialTasks()}) {
        world.create(BodyDef{.type = BodyType::fixed,
                             .shapes = {{.geometry = Box{{200, 1, 200}}, .material = {.friction = 0.8f}}},
                             .pose = {{0, -1, 0}, {}}});
    }
    void step(int count) {
        for (int i = 0; i < count; ++i) world.step(kFrame);
    }

    World world;
    std::deque<Ragdoll> bodies;
};

/// The i-th of many that are dropped apart from each other, turned any way.
Pose dropped(int index, int side, double apart, double height) {
    const auto angle = 2.39996f * static_cast<float>(index);  // the golden angle: no two lie alike
    const double middle = 0.5 * (side - 1);
    return {{apart * (index % side - middle), height, apart * (index / side - middle)},
            rotationAbout({0, 1, 0}, angle) * rotationAbout({1, 0, 0}, 1.3f + 0.2f * std::sin(angle))};
}

double lying(const RagdollDef& def, int count, int runs) {
    Stage stage(false);
    const int side = static_cast<int>(std::ceil(std::sqrt(count)));
    for (int i = 0; i < count; ++i) stage.bodies.emplace_back(stage.world, def, dropped(i, side, 3, 0.6));
    stage.step(300);
    return 1e3 * medianTime(runs, 6000 / (count + 19), [&] { stage.step(1); }) / count;
}

/// Of muscles and balance, and of the world that solves for them.
std::pair<double, double> standingUp(const RagdollDef& def, int runs) {
    Stage stage(false);
    Ragdoll body(stage.world, def, standing(BodyAxes(def)));
    Puppet puppet(stage.world, body);
    const auto step = [&] {
        puppet.step(kFrame);
        stage.step(1);
    };
    for (int i = 0; i < 120; ++i) step();
    std::vector<double> control, solving;
    for (int run = 0; run < runs; ++run) {
        double own = 0, worlds = 0;
        for (int i = 0; i < 100; ++i) {
            own += timeOf(1, [&] { puppet.step(kFrame); });
            worlds += timeOf(1, [&] { stage.step(1); });
        }
        control.push_back(10 * own);
        solving.push_back(10 * worlds);
    }
    return {medianOf(control)->value, medianOf(solving)->value};
}

/// ns
double drive(const RagdollDef& def, int runs) {
    Stage stage(false);
    stage.bodies.emplace_back(stage.world, def, Pose{{0, 1, 0}, {}});
    std::vector<JointDrive> drives;
    for (const JointId joint : stage.bodies[0].joints())
        drives.push_back({.joint = joint, .stiffness = 100, .damping = 10});
    const double ms = medianTime(runs, 2000, [&] {
        for (JointDrive& each : drives) each.feedForward.x += 0.01f;
        stage.world.setDrives(drives);
    });
    return 1e6 * ms / static_cast<double>(drives.size());
}

/// ms a step in the worst second of eight in which 500 fall on stairs.
double falling(const RagdollDef& def, int threads) {
    Stage stage(true, threads);
    for (int i = 0; i < 24; ++i)
        stage.world.create(StaticBody{.shape = Box{{24, 0.1f * static_cast<float>(i + 1), 0.3f}},
                                      .position = {0, 0.1 * (i + 1), -0.6 * i},
                                      .material = {.friction = 0.8f}});
    for (int i = 0; i < 500; ++i) {
        Pose at = dropped(i % 100, 10, 2.4, 6 + 1.5 * (i / 100));
        at.position.z = 0.5 * at.position.z - 7;
        stage.bodies.emplace_back(stage.world, def, at);
    }
    double worst = 0;
    for (int second = 0; second < 8; ++second)
        worst = std::max(worst, timeOf(
                                    60, [&] { stage.step(1); }, threads > 1 ? Clock::wall : Clock::processor));
    return worst;
}

double asleep(const RagdollDef& def, int runs) {
    Stage stage(true);
    for (int i = 0; i < 1000; ++i) stage.bodies.emplace_back(stage.world, def, dropped(i, 32, 3, 0.6));
    for (const Ragdoll& body : stage.bodies)
        for (const BodyId part : body.bodies()) stage.world.sleep(part);
    stage.step(2);
    return 1e3 * medianTime(runs, 1000, [&] { stage.step(1); });
}

/// µs and kB of the i-th hundred that are put into a world that had as many before.
std::pair<double, double> spawning(const RagdollDef& def) {
    constexpr int kCount = 100;
    Stage stage(true);
    const auto spawn = [&] {
        for (int i = 0; i < kCount; ++i) stage.bodies.emplace_back(stage.world, def, dropped(i, 10, 3, 1));
    };
    spawn();
    stage.step(2);
    stage.bodies.clear();
    const double us = 1e3 * timeOf(1, spawn) / kCount;
    stage.bodies.clear();
    const double before = heapBytes();
    Stage fresh(true);
    for (int i = 0; i < kCount; ++i) fresh.bodies.emplace_back(fresh.world, def, dropped(i, 10, 3, 1));
    fresh.step(2);
    return {us, 1e-3 * (heapBytes() - before) / kCount};
}

double springChains(int runs) {
    constexpr int kChains = 1000, kBones = 8;
    Skeleton skeleton;
    skeleton.bones.push_back({"head", -1, {}});
    SpringBonesDef def;
    for (int i = 0; i < kChains; ++i) {
        const SinCos way = sinCos(2 * kPi * static_cast<float>(i) / kChains);
        const int first = static_cast<int>(skeleton.bones.size());
        for (int k = 0; k < kBones; ++k)
            skeleton.bones.push_back({"hair",
                                      k == 0 ? 0 : first + k - 1,
                                      {(0.1f + 0.05f * static_cast<float>(k)) * Vec3{way.cos, 0, way.sin}, {}}});
        def.chains.push_back({.first = first, .last = first + kBones - 1});
    }
    SpringBones springs(skeleton, def);
    std::vector<Pose> pose(skeleton.bones.size());
    double total = 0;
    const int frames = 20 * runs;
    for (int frame = 0; frame < frames; ++frame) {
        const double time = frame * kFrame;
        const Pose head{{0.2 * std::sin(5 * time), 0, 0},
                        rotationAbout({0, 1, 0}, static_cast<float>(std::sin(3 * time)))};
        for (std::size_t i = 0; i < pose.size(); ++i) pose[i] = head * skeleton.bones[i].bind;
        total += timeOf(1, [&] { springs.step(pose, kFrame); });
    }
    return total / frames;
}

/// µs of a sheet of 32 × 32 points that hangs from a body which runs to and fro.
double cape(int runs) {
    World world;
    const BodyId wearer = world.create(BodyDef{
        .type = BodyType::kinematic, .shapes = {{.geometry = Capsule{0.2f, 0.4f}}}, .pose = {{0, 1, -0.25}, {}}});
    ClothDef def = clothSheet(32, 32, {0.8f, 0, 0}, {0, -1.2f, 0});
    for (int i = 0; i < 32; ++i) def.attachments.push_back({.point = i, .body = wearer});
    Cloth cloth(world, def, {{-0.4, 1.4, 0}, {}});
    double time = 0;
    const auto step = [&] {
        time += kFrame;
        world.moveTo(wearer, {{0, 1, -0.25 + std::sin(2 * time)}, {}}, kFrame);
        world.step(kFrame);
    };
    for (int i = 0; i < 60; ++i) step();
    return 1e3 * medianTime(runs, 60, step);
}

struct Crowd {
    double ms = 0;                ///< a step
    std::vector<DVec3> places{};  ///< of the pelvises in the end
};

/// 500 fall on the ground for 3 s, in full detail or by their heights on the screen: 25, 169 and 306 of the three
/// levels.
Crowd crowd(const RagdollDef& def, bool levels) {
    Stage stage(true);
    std::deque<RagdollLod> lods;
    for (int i = 0; i < 500; ++i) {
        stage.bodies.emplace_back(stage.world, def, dropped(i, 23, 2.2, 1));
        if (!levels) continue;
        lods.emplace_back(stage.world, stage.bodies.back());
        lods.back().setHeightOnScreen(2.0f / static_cast<float>(i / 2 + 1));
        lods.back().setLevel(i < 25 ? RagdollLevel::full : i < 194 ? RagdollLevel::reduced : RagdollLevel::single);
    }
    Crowd made;
    made.ms = timeOf(180, [&] { stage.step(1); });
    for (std::size_t i = 0; i < stage.bodies.size(); ++i)
        made.places.push_back(levels ? lods[i].partPose(0).position
                                     : stage.world.pose(stage.bodies[i].bodies()[0]).position);
    lods.clear();
    return made;
}

/// m, root mean square.
double apart(const Crowd& a, const Crowd& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.places.size(); ++i)
        sum += static_cast<double>(lengthSquared(relative(a.places[i], b.places[i])));
    return std::sqrt(sum / static_cast<double>(a.places.size()));
}

}  // namespace

std::vector<RagdollCost> measureRagdolls(int runs) {
    const RagdollDef def = loadRagdoll(dataFolder() / "ragdolls" / "mannequin.ragdoll.json");
    std::vector<RagdollCost> costs;
    const auto add = [&](RagdollCost cost) {
        fmt::print("{}", costLine(cost));
        std::fflush(stdout);
        costs.push_back(std::move(cost));
    };
    add({"lying awake", lying(def, 1, runs), "us/step", 15});
    add({"lying awake, each of 100", lying(def, 100, runs), "us/step", 8});
    const auto [control, solving] = standingUp(def, runs);
    add({"standing on its own feet", control + solving, "us/step", 20});
    add({"of that the puppet", control, "us/step", 20});
    add({"a drive set", drive(def, runs), "ns", 40});
    add({"500 on stairs, worst second", falling(def, 1), "ms/step", 12});
    add({"the same on two threads", falling(def, 2), "ms/step", 7});
    add({"1,000 asleep", asleep(def, runs), "us/step", 2});
    const auto [spawn, kilobytes] = spawning(def);
    add({"one spawned", spawn, "us", 60});
    add({"one in memory", kilobytes, "kB", 40});
    add({"1,000 spring chains of 8", springChains(runs), "ms/frame", 1});
    add({"cape of 1,024 points", cape(runs), "us/step", 120});
    const Crowd full = crowd(def, false), coarse = crowd(def, true);
    add({"crowd of 500, full over levels", full.ms / coarse.ms, "", 3, true});
    add({"of that the pelvises apart, RMS", apart(full, coarse), "m", 1});
    return costs;
}

std::string costLine(const RagdollCost& cost) {
    return fmt::format("{:<32} {:>10.4g} {:<8} {} {:g}{}\n", cost.name, cost.value, cost.unit,
                       cost.atLeast ? "at least" : "at most ", cost.bound, cost.holds() ? "" : "   missed");
}

std::string toJson(const std::vector<RagdollCost>& costs) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const RagdollCost& cost : costs)
        list.push_back({{"scene", "ragdoll"},
                        {"row", cost.name},
                        {"value", cost.value},
                        {"unit", cost.unit},
                        {cost.atLeast ? "at_least" : "at_most", cost.bound},
                        {"holds", cost.holds()}});
    return list.dump(2) + "\n";
}

}  // namespace ragtop::speed
