#include "mixed_scene.h"

#include <time.h>

#include <algorithm>
#include <cmath>

#include "../speed/builder.h"
#include "../speed/quality.h"
#include "../stability/adapters/ragtop.h"
#include "../stability/extremes.h"
#include "ragtop/data_folder.h"
#include "ragtop/vehicle_file.h"

namespace ragtop::economy_bench {

namespace {

using speed::Builder;
using stability::larger;

constexpr int kRate = 60, kSeconds = 12;
constexpr int kCalm = 2;       ///< s, after which cars stand
constexpr int kHit = 6;        ///< s, at which the ball comes; lamps are looked at before
constexpr int kLampsFrom = 1;  ///< s

constexpr int kLinks = 10;
constexpr float kLink = 0.2f;  ///< m

struct MixedScene {
    Builder builder{"mixed"};
    int firstBrick = 0, endBrick = 0, ball = 0;
    std::vector<int> lamps;  ///< bodies that hang
};

/// Four walls laid dry, each corner in bond, and a ball of 5 t that waits beside them.
void addHouse(MixedScene& scene) {
    Builder& b = scene.builder;
    scene.firstBrick = static_cast<int>(b.scene.bodies.size());
    b.brickHouse(12);
    scene.endBrick = static_cast<int>(b.scene.bodies.size());
    scene.ball = b.moving(Sphere{0.8f}, 2331.4f, {.position = {0, 0.8, -12}});
}

void addRain(MixedScene& scene) {
    constexpr int kPeople = 40, kSteps = 16;
    constexpr double kAt = 30;
    Builder& b = scene.builder;
    for (int i = 0; i < kSteps; ++i) {
        const float half = 0.1f * static_cast<float>(i + 1);
        b.fixed(Box{{8, half, 0.3f}}, {.position = {kAt, static_cast<double>(half), -0.6 * i}});
    }
    speed::PeerDice dice(29);
    for (int i = 0; i < kPeople; ++i) {
        const float yaw = dice.between(0, 6.283f), lean = dice.between(-1.5f, 1.5f);
        const Quat rotation = rotationAbout({0, 1, 0}, yaw) * rotationAbout({1, 0, 0}, lean);
        addRagdoll(b, {kAt + (i % 4 - 1.5) * 3.2, 6.0 + i / 4 * 1.2, -2.0 - (i / 4 % 4) * 2.0}, rotation);
    }
}

/// Chains that end in a lamp of thirty links' weight, let go a little aside.
void addLamps(MixedScene& scene) {
    constexpr int kChains = 24;
    constexpr double kLean = 0.3;  // rad
    Builder& b = scene.builder;
    for (int chain = 0; chain < kChains; ++chain) {
        const DVec3 top{-30 - 4.0 * (chain % 6), 6, -12 + 8.0 * (chain / 6)};
        const DVec3 way{std::sin(kLean), -std::cos(kLean), 0};
        const int group = ++b.groups;
        int last = stability::kWorld;
        for (int i = 0; i <= kLinks; ++i) {
            const bool lamp = i == kLinks;
            const double along = static_cast<double>(kLink) * (i + 0.5);
            const Quat turned = rotationAbout({0, 0, 1}, static_cast<float>(kLean));
            const Shape shape = lamp ? Shape(Sphere{0.1f}) : Shape(Capsule{0.03f, 0.5f * kLink - 0.03f});
            const float density = lamp ? 3600.0f : 1000.0f;
            const int body =
                b.moving(shape, density, {.position = top + along * way, .rotation = turned, .group = group});
            b.ball(last, body, {.anchor = top + static_cast<double>(kLink) * i * way});
            scene.lamps.push_back(body);
            last = body;
        }
    }
}

void addCars(MixedScene& scene) {
    constexpr int kCars = 40;
    const VehicleDef def = loadVehicle(dataFolder() / "vehicles" / "hatchback.car.json");
    for (int i = 0; i < kCars; ++i) {
        const DVec3 place{-28 - 6.0 * (i % 5), 0.1, -14 + 4.0 * (i / 5)};
        scene.builder.scene.vehicles.push_back({.def = def, .placement = {.position = place}});
    }
}

MixedScene makeMixedScene() {
    MixedScene scene;
    scene.builder.ground(120);
    addHouse(scene);
    addRain(scene);
    addLamps(scene);
    addCars(scene);
    return scene;
}

double processorMs() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

class Player : public stability::RagtopEngine {
public:
    Player(const MixedScene& scene, const WorldSettings& settings)
        : RagtopEngine(scene.builder.scene, settings), scene_(scene) {
        for (Vehicle& car : instance_.vehicles) car.input.handbrake = 1;
    }

    Played play(bool measured) {
        Played played;
        double cpu = 0;
        for (int second = 0; second < kSeconds; ++second) {
            if (second == kHit) setVelocity(scene_.ball, {0, 0, 25}, {});
            const double before = processorMs();
            for (int i = 0; i < kRate; ++i) step(1.0 / kRate);
            cpu += processorMs() - before;
            if (measured) look(second + 1, played.figures);
        }
        played.ms = cpu / kSeconds;
        return played;
    }

private:
    using Figures = std::array<double, kFigures.size()>;

    void look(int second, Figures& figures) {
        const speed::Quality quality = speed::measureQuality(scene_.builder.scene, *this);
        const double deepest = 1e3 * quality.overlapMax.value_or(0);
        keepLarger(figures[0], 1e3 * quality.overlapP99.value_or(0));
        keepLarger(figures[1], deepest);
        figures[2] = deepest;
        keepLarger(figures[3], 1e3 * quality.gap.value_or(0));
        for (int brick = scene_.firstBrick; second == kHit && brick < scene_.endBrick; ++brick)
            keepLarger(figures[4], movedFrom(definitionOf(brick).pose.position, motion(brick).pose.position));
        if (second == kCalm)
            for (int car = 0; car < carCount(); ++car) parked_.push_back(placeOfCar(car));
        for (int car = 0; second > kCalm && car < carCount(); ++car)
            keepLarger(figures[5], movedFrom(parked_[static_cast<std::size_t>(car)], placeOfCar(car)));
        if (second == kLampsFrom) swing_ = energyOfLamps();
        if (second == kHit) figures[6] = 100 * std::abs(energyOfLamps() - swing_) / (swing_ - energyAtRest());
    }
    static void keepLarger(double& worst, double value) { worst = larger(worst, value); }
    int carCount() const { return static_cast<int>(instance_.vehicles.size()); }
    DVec3 placeOfCar(int car) const {
        return world_.pose(instance_.vehicles[static_cast<std::size_t>(car)].chassis()).position;
    }
    const BodyDef& definitionOf(int body) const {
        return scene_.builder.scene.bodies[static_cast<std::size_t>(body)].def;
    }
    /// mm
    /// mm
    static double movedFrom(const DVec3& a, const DVec3& b) {
        return 1e3 * std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
    }
    double gravity() const { return static_cast<double>(length(world_.settings().gravity)); }

    double energyOfLamps() const {
        double energy = 0;
        for (const int body : scene_.lamps) {
            const stability::BodyMotion now = motion(body);
            const MassProperties mass = stability::massOf(definitionOf(body));
            const Vec3 w = inverseRotate(now.pose.rotation, now.w);
            const auto kinetic = 0.5f * (mass.mass * dot(now.v, now.v) + dot(w, mass.inertia * w));
            energy += static_cast<double>(kinetic) + static_cast<double>(mass.mass) * gravity() * now.pose.position.y;
        }
        return energy;
    }
    /// Of chains that hang straight down.
    double energyAtRest() const {
        double energy = 0;
        for (std::size_t i = 0; i < scene_.lamps.size(); ++i) {
            const int link = static_cast<int>(i) % (kLinks + 1);
            const double mass = static_cast<double>(stability::massOf(definitionOf(scene_.lamps[i])).mass);
            energy += mass * gravity() * (6 - static_cast<double>(kLink) * (link + 0.5));
        }
        return energy;
    }

    const MixedScene& scene_;
    std::vector<DVec3> parked_;
    double swing_ = 0;
};

}  // namespace

Played playMixedScene(const WorldSettings& settings, bool measured) {
    const MixedScene scene = makeMixedScene();
    WorldSettings own = settings;
    own.gravity = scene.builder.scene.settings.gravity;
    return Player(scene, own).play(measured);
}

}  // namespace ragtop::economy_bench
