#include "laws.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "../stability/adapters/ragtop.h"
#include "overlaps.h"

namespace ragtop::laws {
namespace {

constexpr double kRest = 0.1;    ///< m/s: slower than a body falls in a hundredth of a second
constexpr double kMoved = 0.01;  ///< m, by which nothing moves that stands, and something that falls
constexpr double kDegree = 3.141592653589793 / 180, kTwoPi = 6.283185307179586;

/// Keeps what is no number.
void raise(double& largest, double value) {
    if (!(value <= largest)) largest = value;
}

double length(const DVec3& a) { return std::sqrt(dot(a, a)); }

double angleOf(const Quat& q) {
    const double sine =
        std::sqrt(static_cast<double>(q.x) * q.x + static_cast<double>(q.y) * q.y + static_cast<double>(q.z) * q.z);
    return 2 * std::atan2(sine, std::abs(static_cast<double>(q.w)));
}

double twistAbout(const Quat& q) {
    return std::remainder(2 * std::atan2(static_cast<double>(q.x), static_cast<double>(q.w)), kTwoPi);
}

double beyond(const Range& range, double angle) {
    return std::max({0.0, static_cast<double>(range.lower) - angle, angle - static_cast<double>(range.upper)});
}

/// The joint's frames in the world.
struct Place {
    Pose a, b;
};

/// m, between what the joint holds together.
double gapOf(const JointDef& def, const Place& place) {
    const DVec3 apart = place.b.position - place.a.position;
    const double along = dot(apart, DVec3{rotate(place.a.rotation, Vec3{1, 0, 0})});
    const double across = std::sqrt(std::max(0.0, dot(apart, apart) - along * along));
    if (std::holds_alternative<SliderDef>(def) || std::holds_alternative<CylindricalDef>(def) ||
        std::holds_alternative<ScrewDef>(def))
        return across;
    if (std::holds_alternative<PlaneDef>(def)) return std::abs(along);
    if (const auto* rope = std::get_if<DistanceDef>(&def))
        return rope->limit ? std::max(0.0, length(apart) - static_cast<double>(rope->limit->upper)) : 0.0;
    if (std::holds_alternative<SixDofDef>(def) || std::holds_alternative<PathDef>(def)) return 0;
    return length(apart);
}

/// What the joint is beyond its limits, rad.
double overLimit(const JointDef& def, const Place& place) {
    const Quat turn = conjugate(place.a.rotation) * place.b.rotation;
    double over = 0;
    if (const auto* ball = std::get_if<BallDef>(&def)) {
        const Vec3 x = rotate(turn, Vec3{1, 0, 0});
        const double swing =
            std::atan2(std::hypot(static_cast<double>(x.y), static_cast<double>(x.z)), static_cast<double>(x.x));
        if (ball->swingLimit) raise(over, swing - static_cast<double>(*ball->swingLimit));
        if (ball->twistLimit) raise(over, beyond(*ball->twistLimit, twistAbout(turn)));
    } else if (const auto* hinge = std::get_if<HingeDef>(&def); hinge != nullptr && hinge->limit) {
        raise(over, beyond(*hinge->limit, twistAbout(turn)));
    }
    return over;
}

double springEnergy(const JointDef& def, const Place& place) {
    if (const auto* distance = std::get_if<DistanceDef>(&def); distance != nullptr && distance->spring) {
        const DVec3 way = place.b.position - place.a.position;
        const double stretch = std::sqrt(dot(way, way)) - static_cast<double>(distance->rest);
        return 0.5 * static_cast<double>(distance->spring->stiffness) * stretch * stretch;
    }
    const auto* ball = std::get_if<BallDef>(&def);
    if (ball == nullptr || !ball->spring) return 0;
    const double angle = angleOf(conjugate(place.a.rotation) * place.b.rotation);
    return 0.5 * static_cast<double>(ball->spring->stiffness) * angle * angle;
}

/// Does nothing hold any body?
bool isFree(const Scene& scene) {
    const auto moves = [](const SceneBody& body) { return body.def.type == BodyType::dynamic; };
    const auto isInside = [](const SceneJoint& joint) {
        return joint.bodyA != stability::kWorld && joint.bodyB != stability::kWorld;
    };
    return std::ranges::all_of(scene.bodies, moves) && std::ranges::all_of(scene.joints, isInside);
}

/// Puts cars where they begin.
void lay(const Drawn& drawn, stability::Engine& engine) {
    for (std::size_t i = 0; i < drawn.laid.size(); ++i)
        engine.layCar(static_cast<int>(i), {drawn.laid[i].pose, drawn.laid[i].v, drawn.laid[i].w});
}

void lay(const Drawn& drawn, World& world, SceneInstance& instance) {
    for (std::size_t i = 0; i < drawn.laid.size(); ++i) {
        world.setPose(instance.vehicles[i].chassis(), drawn.laid[i].pose);
        instance.vehicles[i].setVelocity(drawn.laid[i].v, drawn.laid[i].w);
    }
}

/// What is measured of a scene between steps.
class Watch {
public:
    Watch(const Drawn& drawn, stability::Engine& engine, Overlaps& overlaps)
        : drawn_(drawn), scene_(drawn.scene), engine_(engine), overlaps_(overlaps) {
        for (const SceneBody& body : scene_.bodies)
            masses_.push_back(body.def.type == BodyType::dynamic ? stability::massOf(body.def) : MassProperties{});
        lay(drawn, engine);
        start_ = base_ = energy();
        workOfMotors();
        startMomentum_ = momentum_;
        startWay_ = way_;
        lowest_ = potential_;
        from_ = relativePlaces();
    }

    void note(Watched& watched) {
        spent_ += workOfMotors();
        const double total = energy() - spent_ - worked_;
        // What tires stand on is known from the end of the first step on, and what that stands on from the second.
        if (hasCars() && steps_ <= 1) start_ = base_ = total;
        raise(gained_, total - base_);
        // What motors may give is more than they do: it must not pay for what comes later. What overlaps hold may.
        if ((hasMotors_ || hasCars()) && total < base_) base_ = std::min(base_, total + overlaps_.held(engine_));
        if (!(potential_ >= lowest_)) lowest_ = potential_;
        if (hasMotors_ || hasCars()) raise(fullest_, kinetic_);
        const double room = std::max({start_ - lowest_, kLeast * weightTimesSize_, fullest_});
        watched.energyGain = room > 0 ? std::max(0.0, gained_ / room) : 0;
        if (std::isnan(gained_)) watched.energyGain = gained_;
        ++steps_;
        if (drawn_.isOnIce || isFree(scene_)) raise(watched.momentumGain, momentumGain());
        raise(watched.gap, gap());
        raise(watched.fastest, fastest_);
        raise(watched.overLimit, over());
        std::vector<Pose> poses = allPoses();
        stuck_ = std::ranges::equal(poses, last_, isSame) && !rests() ? stuck_ + scene_.step : 0;
        raise(watched.stuck, stuck_);
        last_ = std::move(poses);
        if (!drawn_.stands && !drawn_.falls) return;
        const std::vector<DVec3> now = relativePlaces();
        for (std::size_t i = 0; i < now.size(); ++i) raise(moved_, length(now[i] - from_[i]));
        if (drawn_.stands) watched.moved = moved_;
        if (drawn_.falls) watched.hangs = std::max(0.0, kMoved - moved_);
    }
    /// Laws of rest say something of scenes that come to it alone.
    bool rests() const { return speed() <= kRest; }
    double speed() const { return mass_ > 0 ? std::sqrt(2 * kinetic_ / mass_) : 0; }
    double gap() const {
        double largest = 0;
        for (const SceneJoint& joint : scene_.joints) raise(largest, gapOf(joint.def, place(joint)));
        return largest;
    }
    double over() const {
        double largest = 0;
        for (const SceneJoint& joint : scene_.joints) raise(largest, overLimit(joint.def, place(joint)));
        return largest;
    }

private:
    /// Of a step, by which what speeds up turns later than at its mean speed: half of one of four substeps.
    static constexpr double kLate = 0.125;
    bool hasCars() const { return !scene_.vehicles.empty(); }
    static constexpr double kLeast = 0.1;  ///< of the weight times a metre, that counts as energy of a scene at rest

    Place place(const SceneJoint& joint) const {
        const JointBodies& bodies =
            std::visit([](const auto& def) -> const JointBodies& { return def.bodies; }, joint.def);
        const auto of = [&](int body, const ScenePart& part, const Frame& frame) {
            const Pose pose = part                        ? engine_.car(part.index).pose
                              : body == stability::kWorld ? Pose{}
                                                          : engine_.motion(body).pose;
            return Pose{transformPoint(pose, frame.position), pose.rotation * frame.rotation};
        };
        return {of(joint.bodyA, joint.partA, bodies.frameA), of(joint.bodyB, joint.partB, bodies.frameB)};
    }
    double energy() {
        kinetic_ = potential_ = mass_ = fastest_ = way_ = 0;
        momentum_ = {};
        const DVec3 g{scene_.settings.gravity};
        for (std::size_t i = 0; i < masses_.size(); ++i) {
            const MassProperties& mass = masses_[i];
            if (!(mass.mass > 0)) continue;
            const stability::BodyMotion m = engine_.motion(static_cast<int>(i));
            const double kg = static_cast<double>(mass.mass);
            const DVec3 v{m.v};
            raise(fastest_, length(v));
            const Vec3 w = inverseRotate(m.pose.rotation, m.w);
            mass_ += kg;
            momentum_ = momentum_ + kg * v;
            way_ += kg * length(v);
            kinetic_ += 0.5 * kg * dot(v, v) + 0.5 * static_cast<double>(dot(w, mass.inertia * w));
            potential_ -= kg * dot(g, transformPoint(m.pose, mass.center));
        }
        if (hasCars()) addCars();
        weightTimesSize_ = mass_ * length(g);
        double springs = 0;
        for (const SceneJoint& joint : scene_.joints) springs += springEnergy(joint.def, place(joint));
        potential_ += springs;
        return kinetic_ + potential_;
    }
    void addCars() {
        const stability::CarSums cars = engine_.cars();
        raise(fastest_, cars.fastest);
        mass_ += cars.mass;
        momentum_ = momentum_ + cars.momentum;
        way_ += cars.way;
        kinetic_ += cars.kinetic;
        potential_ += cars.potential + cars.held;
        worked_ = cars.work;
    }
    /// Of its change in all steps so far, of what the bodies had.
    double momentumGain() const {
        const DVec3 given = mass_ * scene_.step * steps_ * DVec3{scene_.settings.gravity};
        const double way = std::max(startWay_, length(given));
        DVec3 gained = momentum_ - startMomentum_ - given;
        if (drawn_.isOnIce) gained.y = 0;  // that of the floor
        return way > 0 ? length(gained) / way : way_;
    }
    /// J, that the motors of hinges have given since the last time, at most: they push with all their torque what turns
    /// slower than they ask, and give none to what turns back or faster.
    double workOfMotors() {
        double work = 0;
        std::size_t i = 0;
        for (const SceneJoint& joint : scene_.joints) {
            const auto* hinge = std::get_if<HingeDef>(&joint.def);
            if (hinge == nullptr || !hinge->motor) continue;
            hasMotors_ = true;
            const Place now = place(joint);
            const double target = static_cast<double>(hinge->motor->targetSpeed), ahead = target < 0 ? -1 : 1;
            const Turn turn{twistAbout(conjugate(now.a.rotation) * now.b.rotation), ahead * speedOf(joint)};
            if (i == turns_.size()) turns_.push_back(turn);
            const double way = ahead * std::remainder(turn.angle - turns_[i].angle, kTwoPi) +
                               kLate * scene_.step * std::max(0.0, turn.speed - turns_[i].speed);
            turns_[i++] = turn;
            work += static_cast<double>(hinge->motor->maxForce) * std::clamp(way, 0.0, std::abs(target) * scene_.step);
        }
        return work;
    }
    /// rad/s, of a hinge.
    double speedOf(const SceneJoint& joint) const {
        const auto turn = [&](int body) { return body == stability::kWorld ? Vec3{} : engine_.motion(body).w; };
        const Vec3 axis = rotate(place(joint).a.rotation, Vec3{1, 0, 0});
        return static_cast<double>(ragtop::dot(axis, turn(joint.bodyB) - turn(joint.bodyA)));
    }
    /// Of all that moves by itself but the first, from it.
    std::vector<DVec3> relativePlaces() const {
        std::vector<DVec3> places;
        const DVec3 origin = engine_.motion(0).pose.position;
        for (std::size_t i = 1; i < masses_.size(); ++i)
            if (masses_[i].mass > 0) places.push_back(engine_.motion(static_cast<int>(i)).pose.position - origin);
        return places;
    }
    std::vector<Pose> allPoses() const {
        std::vector<Pose> poses;
        for (std::size_t i = 0; i < masses_.size(); ++i) poses.push_back(engine_.motion(static_cast<int>(i)).pose);
        for (std::size_t i = 0; i < scene_.vehicles.size(); ++i) poses.push_back(engine_.car(static_cast<int>(i)).pose);
        return poses;
    }
    static bool isSame(const Pose& a, const Pose& b) { return a.position == b.position && a.rotation == b.rotation; }

    const Drawn& drawn_;
    const Scene& scene_;
    stability::Engine& engine_;
    Overlaps& overlaps_;
    std::vector<MassProperties> masses_;
    std::vector<DVec3> from_;
    std::vector<Pose> last_;
    double stuck_ = 0, moved_ = 0;
    /// Of a hinge.
    struct Turn {
        double angle = 0, speed = 0;  ///< rad; rad/s, as its motor is asked for
    };
    std::vector<Turn> turns_;  ///< of those that have a motor
    bool hasMotors_ = false;
    double start_ = 0, lowest_ = 0;
    double fullest_ = 0;                             ///< J, kinetic, where motors give it
    double base_ = 0, gained_ = -1e300, spent_ = 0;  ///< J: from which gains are counted, the largest, what motors gave
    double worked_ = 0;                              ///< J, of engines
    double kinetic_ = 0, potential_ = 0, mass_ = 0, fastest_ = 0, weightTimesSize_ = 0;
    DVec3 momentum_, startMomentum_;  // kg m/s
    double way_ = 0, startWay_ = 0;   // the same, of sizes
    double steps_ = 0;
};

void drive(const Drawn& drawn, stability::Engine& engine, double time) {
    for (const Ride& ride : drawn.rides)
        engine.setVelocity(ride.body, ride.velocity(time, time + drawn.scene.step), {});
    for (const Shaker& shaker : drawn.shakers) {
        const double rate = kTwoPi * static_cast<double>(shaker.frequency);
        const double speed = rate * static_cast<double>(shaker.amplitude) * std::cos(rate * time);
        engine.setVelocity(shaker.body, Vec3{static_cast<float>(speed), 0, 0}, {});
    }
}

}  // namespace

bool isDriven(const Drawn& drawn) {
    return drawn.isDriven || !drawn.shakers.empty() || !drawn.rides.empty() ||
           std::ranges::any_of(drawn.scene.bodies, [](const SceneBody& body) {
               return body.def.type == BodyType::kinematic && lengthSquared(body.def.linearVelocity) > 0;
           });
}

std::span<const Law> allLaws() {
    static constexpr Law kLaws[] = {
        {"energy", &Watched::energyGain, 0.01, "1"},
        {"momentum", &Watched::momentumGain, 1e-4, "1"},
        {"gap", &Watched::gap, 0.05, "m"},
        {"gap at rest", &Watched::restGap, 0.002, "m"},
        {"limit", &Watched::overLimit, 5 * kDegree, "rad"},
        {"limit at rest", &Watched::restOverLimit, 1 * kDegree, "rad"},
        {"overlap", &Watched::overlap, 0.05, "m", false},
        {"overlap at rest", &Watched::restOverlap, 0.002, "m", false},
        {"stands", &Watched::moved, kMoved, "m"},
        {"falls", &Watched::hangs, 0, "m"},
        {"stops", &Watched::rolls, kRest, "m/s"},
        {"fastest", &Watched::fastest, 300, "m/s"},
        {"comes to rest", &Watched::endSpeed, kRest, "m/s", false},
        {"goes on", &Watched::stuck, 0.1, "s"},
    };
    return kLaws;
}

std::vector<std::string> broken(const Watched& watched, const std::vector<std::string>& asked) {
    const auto counts = [&](const std::string& law, bool always = true) {
        return std::ranges::any_of(asked,
                                   [&](const std::string& name) { return (name == "all" && always) || name == law; });
    };
    std::vector<std::string> names;
    for (const Law& law : allLaws())
        if (counts(law.name, law.always) && !(watched.*law.value <= law.bound)) names.emplace_back(law.name);
    if (counts(kRestoredLaw) && !watched.restored) names.emplace_back(kRestoredLaw);
    for (const std::string& law : watched.meddled)
        if (counts(law)) names.push_back("meddled: " + law);
    return names;
}

Watched watch(const Drawn& drawn, const stability::EngineKind& kind) {
    const auto engine = kind.make(drawn.scene);
    const double dt = drawn.scene.step;
    const auto steps = std::lround(drawn.seconds / dt), last = std::lround(0.5 / dt);
    Watched watched;
    Overlaps overlaps(drawn.scene, *engine);
    Watch watch(drawn, *engine, overlaps);
    const long often = std::max(1L, std::lround(0.1 / dt));
    std::vector<double> times;
    for (long i = 0; i < steps; ++i) {
        drive(drawn, *engine, static_cast<double>(i) * dt);
        const auto begin = std::chrono::steady_clock::now();
        engine->step(dt);
        times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
        watch.note(watched);
        const double overlap = i % often == 0 ? overlaps.deepest(*engine) : 0;
        raise(watched.overlap, overlap);
        if (i < steps - last || !watch.rests()) continue;
        raise(watched.restOverlap, overlap);
        raise(watched.restGap, watch.gap());
        raise(watched.restOverLimit, watch.over());
    }
    watched.endSpeed = watch.speed();
    if (drawn.brakes) watched.rolls = watched.endSpeed;
    if (isDriven(drawn)) watched.energyGain = 0;
    for (const double ms : times) watched.meanMs += ms / static_cast<double>(times.size());
    std::ranges::sort(times);
    watched.medianMs = times[times.size() / 2];
    watched.worstMs = times.back();
    return watched;
}

bool restoresAlike(const Drawn& drawn, std::uint64_t seed) {
    const double dt = drawn.scene.step;
    WorldSettings settings;
    settings.gravity = drawn.scene.settings.gravity;
    settings.sleeping = false;
    const auto steps = std::min(std::lround(drawn.seconds / dt), 180L);
    World straight(settings), turned(settings);
    SceneInstance one(drawn.scene, straight), other(drawn.scene, turned);
    lay(drawn, straight, one);
    lay(drawn, turned, other);
    for (long i = 0; i < steps; ++i) {
        one.drive(static_cast<double>(i) * dt);
        straight.step(dt);
        if (!straight.validate().empty()) return false;
    }
    Dice dice(seed);
    std::vector<std::byte> kept;
    for (long i = 0; i < steps; ++i) {
        if (dice.below(30) == 0) {  // some steps of another course, and back
            kept.resize(turned.saveSize());
            kept.resize(turned.save(kept));
            for (std::uint32_t k = 0; k <= dice.below(5); ++k) turned.step(dt);
            turned.restore(kept);
        }
        other.drive(static_cast<double>(i) * dt);
        turned.step(dt);
        if (!turned.validate().empty()) return false;
    }
    return straight.hash() == turned.hash();
}

}  // namespace ragtop::laws
