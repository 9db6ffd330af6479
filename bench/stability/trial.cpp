#include "trial.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <utility>

#include "base/hash.h"
#include "extremes.h"
#include "scenery.h"

namespace ragtop::stability {
namespace {

double milliseconds(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

std::string fileName(std::string text) {
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
    return text + ".glb";
}

DVec3 anchor(const Pose& pose, const Frame& frame) { return transformPoint(pose, frame.position); }

/// Of what tells scenes of the suite apart: gravity, places, masses and materials of bodies, and where joints are.
std::uint64_t digestOf(const Scene& scene, std::uint64_t before) {
    StateHash hash;
    hash.add(before);
    hash.add(scene.settings.gravity);
    for (const SceneBody& body : scene.bodies) {
        const BodyDef& def = body.def;
        hash.add(static_cast<std::int32_t>(def.type));
        hash.add(def.pose.position);
        hash.add(def.pose.rotation);
        hash.add(def.linearVelocity);
        hash.add(def.angularVelocity);
        for (const ShapeDef& shape : def.shapes) {
            hash.add(static_cast<std::int32_t>(shape.geometry.index()));
            hash.add(shape.frame);
            hash.add(shape.material.friction);
            hash.add(shape.material.restitution);
        }
        if (def.type != BodyType::dynamic) continue;
        const MassProperties mass = massOf(def);
        hash.add(mass.mass);
        hash.add(mass.inertia.cx);
        hash.add(mass.inertia.cy);
        hash.add(mass.inertia.cz);
    }
    for (const SceneJoint& joint : scene.joints) {
        hash.add(static_cast<std::int32_t>(joint.def.index()));
        hash.add(joint.bodyA);
        hash.add(joint.bodyB);
        const JointBodies& bodies =
            std::visit([](const auto& def) -> const JointBodies& { return def.bodies; }, joint.def);
        hash.add(bodies.frameA);
        hash.add(bodies.frameB);
    }
    return hash.value();
}

double distance(const DVec3& a, const DVec3& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }

}  // namespace

/// A picture of the run for any engine: a world whose bodies touch nothing and are put where those of the engine are.
struct Run::Film {
    Film(const Scene& scene, std::filesystem::path path)
        : instance(puppets(scene), world), recording(world, {.every = 1}), file(std::move(path)) {
        constexpr Color kTints[] = {0xd98c4a, 0xc9793b, 0xe0a060, 0xb86a35, 0xd0925c};
        for (std::size_t i = 0; i < instance.bodies.size(); ++i)
            if (scene.bodies[i].def.type == BodyType::dynamic)
                recording.paint(instance.bodies[i], kTints[i % std::size(kTints)]);
    }
    ~Film() {
        try {
            recording.write(file);
        } catch (const AssetError& error) {
            // The rows count all the same.
            std::fprintf(stderr, "%s\n", error.what());
        }
    }
    static Scene puppets(Scene scene) {
        scene.joints.clear();
        for (SceneBody& body : scene.bodies) {
            if (body.def.type == BodyType::dynamic) body.def.type = BodyType::kinematic;
            body.def.linearVelocity = body.def.angularVelocity = {};
        }
        return scene;
    }
    /// Every other step, which makes 30 frames of 60 steps.
    void capture(const Engine& engine, double dt) {
        if (++steps % 2 != 0) return;
        for (std::size_t i = 0; i < instance.bodies.size(); ++i)
            if (world.isValid(instance.bodies[i]) && world.type(instance.bodies[i]) != BodyType::fixed)
                world.setPose(instance.bodies[i], engine.motion(static_cast<int>(i)).pose);
        world.step(2 * dt);
        recording.capture();
    }
    World world;
    SceneInstance instance;
    Recording recording;
    std::filesystem::path file;
    int steps = 0;
};

Run::Run(Trial& trial, Scene scene, const std::string& label) : trial_(&trial), scene_(std::move(scene)) {
    scene_.settings.gravity = static_cast<float>(trial.setting_.gravity) * scene_.settings.gravity;
    trial.course_.digest = digestOf(scene_, trial.course_.digest);
    for (const SceneBody& body : scene_.bodies)
        masses_.push_back(body.def.type == BodyType::dynamic ? massOf(body.def) : MassProperties{});
    engine_ = trial.engine().make(scene_);
    const Trial::Setting& setting = trial.setting_;
    if (setting.records) {
        const std::string name = setting.family + "-" + setting.name + (label.empty() ? "" : "-") + label;
        film_ = std::make_unique<Film>(scene_, *setting.records / fileName(name + "-" + trial.engine().name));
    }
}
Run::~Run() = default;
Run::Run(Run&&) noexcept = default;

void Run::step() {
    Trial::Course& course = trial_->course_;
    const double before = milliseconds(CLOCK_THREAD_CPUTIME_ID), wallBefore = milliseconds(CLOCK_MONOTONIC);
    if (!lost_) engine_->step(trial_->dt());
    const double wall = milliseconds(CLOCK_MONOTONIC) - wallBefore;
    const double own = milliseconds(CLOCK_THREAD_CPUTIME_ID) - before;
    const StepWork work = engine_->work();
    trial_->cpuMs_ += work.cpuMs.value_or(own);
    course.wallMs += work.cpuMs.value_or(wall);
    course.contacts += work.contacts;
    course.passes += work.passes;
    ++course.steps;
    trial_->simulated_ += trial_->dt();
    ++steps_;
    inspect();
    if (film_) film_->capture(*engine_, trial_->dt());
}

void Run::inspect() {
    std::string& fault = trial_->course_.fault;
    if (fault.empty()) {
        fault = engine_->complaint();
        if (!fault.empty()) fail();
    }
    for (std::size_t i = 0; i < masses_.size() && !lost_; ++i) {
        if (!(masses_[i].mass > 0)) continue;
        const BodyMotion m = motion(static_cast<int>(i));
        if (isFinite(m.pose.position) && isFinite(m.pose.rotation) && isFinite(m.v) && isFinite(m.w)) continue;
        lost_ = true;
        fail();
        if (fault.empty()) fault = fmt::format("body {} is nowhere after {:.3g} s", i, time());
    }
}

void Run::fail() { trial_->course_.failed = std::min(trial_->course_.failed, time()); }

bool Run::advance(double seconds, const std::function<bool()>& goOn) {
    const auto count = std::lround(std::min(seconds, trial_->setting_.longest) / trial_->dt());
    for (long i = 0; i < count; ++i) {
        step();
        if (!goOn || goOn()) continue;
        fail();
        return false;
    }
    return true;
}

void Run::remove(int body) {
    engine_->remove(body);
    masses_[static_cast<std::size_t>(body)] = {};
    if (film_) film_->world.destroy(film_->instance.bodies[static_cast<std::size_t>(body)]);
}

double Run::time() const { return steps_ * trial_->dt(); }
double Run::dt() const { return trial_->dt(); }

DVec3 Run::centerOfMass(int body) const {
    return transformPoint(motion(body).pose, masses_[static_cast<std::size_t>(body)].center);
}

double Run::jointGap() const {
    double largest = 0;
    for (const SceneJoint& joint : scene_.joints) {
        if (std::holds_alternative<DistanceDef>(joint.def) || std::holds_alternative<SliderDef>(joint.def)) continue;
        const auto pose = [&](int body) { return body == kWorld ? Pose{} : motion(body).pose; };
        const JointBodies& bodies =
            std::visit([](const auto& def) -> const JointBodies& { return def.bodies; }, joint.def);
        const double gap = distance(anchor(pose(joint.bodyA), bodies.frameA), anchor(pose(joint.bodyB), bodies.frameB));
        largest = larger(largest, gap);
    }
    return largest;
}

double Run::energy() const {
    double sum = 0;
    const DVec3 g{scene_.settings.gravity};
    for (std::size_t i = 0; i < masses_.size(); ++i) {
        const MassProperties& mass = masses_[i];
        if (!(mass.mass > 0)) continue;
        const BodyMotion m = motion(static_cast<int>(i));
        const DVec3 x = centerOfMass(static_cast<int>(i)), v{m.v};
        const Vec3 w = inverseRotate(m.pose.rotation, m.w);
        const double heightEnergy = -(g.x * x.x + g.y * x.y + g.z * x.z);
        sum += static_cast<double>(mass.mass) * (heightEnergy + 0.5 * (v.x * v.x + v.y * v.y + v.z * v.z)) +
               0.5 * static_cast<double>(dot(w, mass.inertia * w));
    }
    return sum;
}

DVec3 Run::angularMomentum(int body) const {
    const BodyMotion m = motion(body);
    const Mat3& inertia = masses_[static_cast<std::size_t>(body)].inertia;
    return DVec3{rotate(m.pose.rotation, inertia * inverseRotate(m.pose.rotation, m.w))};
}

double Run::moved(int body) const {
    return distance(position(body), scene_.bodies[static_cast<std::size_t>(body)].def.pose.position);
}

Run Trial::start(Scene scene, const std::string& label) { return {*this, std::move(scene), label}; }

double Trial::allowance() const { return std::max(1.0, 60 * dt()); }

void Trial::expectNear(const std::string& what, double value, double reference, double bound, const std::string& unit) {
    bound *= allowance();
    file(what, value, reference, bound, unit, std::abs(value - reference) <= bound);
}
void Trial::expectAtMost(const std::string& what, double value, double bound, const std::string& unit) {
    bound *= allowance();
    file(what, value, 0, bound, unit, std::abs(value) <= bound);
}
void Trial::expectAtLeast(const std::string& what, double value, double reference, const std::string& unit) {
    file(what, value, reference, 0, unit, value >= reference);
}

void Trial::skip(const std::string& what, const std::string& why) {
    file(what, std::numeric_limits<double>::quiet_NaN(), 0, 0, "", false);
    rows_.back().verdict = Verdict::skipped;
    rows_.back().note = why;
}

void Trial::file(const std::string& what, double value, double reference, double bound, const std::string& unit,
                 bool pass) {
    const std::string name = setting_.name + (what.empty() ? "" : ": ") + what;
    rows_.push_back({setting_.family, name, engine().name, value, reference, bound, unit,
                     pass && course_.fault.empty() ? Verdict::holds : Verdict::fails,
                     simulated_ > 0 ? cpuMs_ / simulated_ : 0, course_.fault});
}

}  // namespace ragtop::stability
