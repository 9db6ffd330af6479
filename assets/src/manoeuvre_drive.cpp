#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "manoeuvre_ground.h"
#include "manoeuvre_laws.h"
#include "manoeuvre_trailer.h"
#include "ragtop/driver.h"
#include "ragtop/joint.h"
#include "ragtop/manoeuvre.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// m/s² per m/s and per m, of drivers that keep speed and circle.
constexpr float kThrottlePerSpeed = 0.4f, kBrakePerSpeed = 0.3f, kAnglePerCurvature = 4;

void placeCar(World& world, const Vehicle& car, const Manoeuvre& manoeuvre) {
    const TrackStart& start = manoeuvre.start;
    const Quat tilt = trackTilt(manoeuvre.ground);
    const Quat attitude = tilt * rotationAbout({0, 1, 0}, start.heading) * rotationAbout({1, 0, 0}, start.pitch) *
                          rotationAbout({0, 0, 1}, -start.roll);
    world.setPose(car.chassis(), {DVec3(rotate(tilt, {0, start.height, 0})), attitude});
    world.setVelocity(car.chassis(), rotate(attitude, {start.sideSpeed, 0, start.speed}), {});
}

float between(float a, float b, float share) { return a + share * (b - a); }

TrackInput inputAt(const std::vector<TrackInput>& points, float time) {
    if (points.empty()) return {};
    const auto next = std::ranges::upper_bound(points, time, {}, &TrackInput::time);
    if (next == points.begin()) return points.front();
    TrackInput now = *(next - 1);
    if (next == points.end()) return now;
    const float share = (time - now.time) / (next->time - now.time);
    now.throttle = between(now.throttle, next->throttle, share);
    now.brake = between(now.brake, next->brake, share);
    now.handbrake = between(now.handbrake, next->handbrake, share);
    now.clutch = between(now.clutch, next->clutch, share);
    now.wheelAngle = between(now.wheelAngle, next->wheelAngle, share);
    return now;
}

class Drive {
public:
    Drive(const Manoeuvre& manoeuvre, const VehicleDef& def, const TrackOptions& options)
        : manoeuvre_(manoeuvre),
          def_(def),
          world_(settings(manoeuvre)),
          car_((layTrack(world_, manoeuvre.ground, options.friction), world_), onOneBody(def),
               {.speed = manoeuvre.start.speed}) {
        placeCar(world_, car_, manoeuvre);
        if (def.level == VehicleLevel::linkages) car_.setLevel(def.level);
        if (manoeuvre.trailer) hitchUp(*manoeuvre.trailer);
        before_ = world_.pose(car_.chassis()).position;
        from_ = before_;
        if (!manoeuvre.cruise || manoeuvre.cruise->line.empty()) return;
        points_ = smoothLine(manoeuvre.cruise->line, manoeuvre.cruise->closed);
        line_ = {points_, manoeuvre.cruise->closed};
        along_ = placeAt(line_, from_).along;
    }

    TrackRun run(float seconds, double dt) {
        TrackRun run;
        const auto steps = static_cast<std::size_t>(std::llround(static_cast<double>(seconds) / dt));
        run.samples.reserve(steps + 1);
        run.samples.push_back(sample(0));
        for (std::size_t i = 1; i <= steps; ++i) {
            steer(static_cast<float>(static_cast<double>(i - 1) * dt), static_cast<float>(dt));
            world_.step(dt);
            run.samples.push_back(sample(static_cast<double>(i) * dt));
        }
        return run;
    }

private:
    static WorldSettings settings(const Manoeuvre& manoeuvre) {
        WorldSettings settings;
        settings.sleeping = manoeuvre.sleeping;
        return settings;
    }

    /// Carriers of wheels are made where the car starts, and as it goes there.
    static VehicleDef onOneBody(VehicleDef def) {
        def.level = std::min(def.level, VehicleLevel::full);
        return def;
    }

    /// Straight behind the car, as fast as it is.
    void hitchUp(const TrackTrailer& trailer) {
        const Vec3 ofCar = hitchOfCar(def_), ofTrailer = hitchOfTrailer(trailer, def_);
        trailer_.emplace(world_, trailerOf(trailer, def_), VehiclePlacement{.speed = manoeuvre_.start.speed});
        trailer_->input.clutch = 1;
        const Pose pose = world_.pose(car_.chassis());
        world_.setPose(trailer_->chassis(), {transformPoint(pose, ofCar - ofTrailer), pose.rotation});
        world_.setVelocity(trailer_->chassis(), world_.linearVelocity(car_.chassis()), {});
        hitch_ = world_.create(BallDef{
            .bodies = {
                .a = car_.chassis(), .b = trailer_->chassis(), .frameA = {ofCar, {}}, .frameB = {ofTrailer, {}}}});
    }

    void steer(float time, float dt) {
        TrackInput now = inputAt(manoeuvre_.input, time);
        const float speed = car_.telemetry().speed;
        if (manoeuvre_.cruise && time < manoeuvre_.cruise->until) {
            const TrackCruise& cruise = *manoeuvre_.cruise;
            if (!points_.empty()) {
                car_.input = followLine(line_, car_, world_.pose(car_.chassis()), cruise.speed);
                return;
            }
            now.throttle = std::clamp(0.15f + kThrottlePerSpeed * (cruise.speed - speed), 0.0f, 1.0f);
            now.brake = std::clamp(kBrakePerSpeed * (speed - cruise.speed) - 0.1f, 0.0f, 1.0f);
            if (cruise.radius) now.wheelAngle = circleAngle(*cruise.radius, speed, dt);
        }
        car_.input = {now.throttle,  now.brake,  steerFor(def_.steering, now.wheelAngle, speed),
                      now.handbrake, now.clutch, now.gear};
    }

    /// The circle's angle at no speed, and what it takes besides, found by what the path lacks.
    float circleAngle(float radius, float speed, float dt) {
        const float curvature = speed > 1 ? yawRate() / speed : 1 / radius;
        more_ += dt * kAnglePerCurvature * (1 / radius - curvature);
        return arcTan2(wheelbase(def_), radius) + more_;
    }

    float yawRate() const {
        return dot(world_.angularVelocity(car_.chassis()), rotate(world_.pose(car_.chassis()).rotation, {0, 1, 0}));
    }

    TrackSample sample(double time) {
        const VehicleTelemetry& seen = car_.telemetry();
        const Pose pose = world_.pose(car_.chassis());
        distance_ += static_cast<double>(length(relative(pose.position, before_)));
        before_ = pose.position;
        TrackSample row{};
        const auto put = [&](TrackChannel channel, double value) { row[static_cast<std::size_t>(channel)] = value; };
        double load = 0, largestLoad = 0, slip = 0, angle = 0, steered = 0;
        for (std::size_t i = 0; i < seen.wheels.size(); ++i) {
            const WheelTelemetry& wheel = seen.wheels[i];
            load += static_cast<double>(wheel.load);
            largestLoad = std::max(largestLoad, static_cast<double>(wheel.peakLoad));
            slip = std::max(slip, static_cast<double>(std::abs(wheel.slipRatio)));
            if (def_.wheels[i].steerFactor == 0) continue;
            angle += static_cast<double>(wheel.steerAngle / def_.wheels[i].steerFactor);
            steered += 1;
        }
        put(TrackChannel::time, time);
        put(TrackChannel::speed, static_cast<double>(seen.speed));
        put(TrackChannel::distance, distance_);
        put(TrackChannel::drift, static_cast<double>(length(relative(pose.position, from_))));
        put(TrackChannel::height, pose.position.y - from_.y);
        const double trailing = trailer_ ? trailer_->telemetry().energy.elastic : 0;
        put(TrackChannel::energy, world_.energy() + seen.energy.elastic + trailing);
        put(TrackChannel::yawRate, static_cast<double>(yawRate()));
        put(TrackChannel::lateralAcceleration, static_cast<double>(yawRate() * seen.speed));
        put(TrackChannel::wheelAngle, steered > 0 ? angle / steered : 0);
        put(TrackChannel::load, load);
        put(TrackChannel::largestLoad, largestLoad);
        put(TrackChannel::largestSlip, slip);
        put(TrackChannel::upright, static_cast<double>(rotate(pose.rotation, {0, 1, 0}).y));
        put(TrackChannel::asleep, world_.isAwake(car_.chassis()) ? 0 : 1);
        put(TrackChannel::rpm, static_cast<double>(seen.engine.rpm));
        if (trailer_) {
            const Vec3 ahead = rotate(world_.pose(trailer_->chassis()).rotation, {0, 0, 1});
            const Vec3 seenAhead = inverseRotate(pose.rotation, ahead);
            const Vec3 forward = rotate(pose.rotation, {0, 0, 1});
            put(TrackChannel::hitchForce, static_cast<double>(dot(world_.state(hitch_).force, forward)));
            put(TrackChannel::articulation, static_cast<double>(arcTan2(seenAhead.x, seenAhead.z)));
        }
        if (points_.empty()) return row;
        const LinePlace place = placeAt(line_, pose.position);
        // A lap's end is where its beginning is.
        const float half = 0.5f * place.length, went = place.along - along_;
        driven_ += static_cast<double>(went > half ? went - place.length : went < -half ? went + place.length : went);
        along_ = place.along;
        put(TrackChannel::aside, static_cast<double>(place.aside));
        put(TrackChannel::laps, driven_ / static_cast<double>(place.length));
        return row;
    }

    const Manoeuvre& manoeuvre_;
    const VehicleDef& def_;
    World world_;
    Vehicle car_;
    std::optional<Vehicle> trailer_;
    JointId hitch_;
    float more_ = 0;  ///< rad
    DVec3 before_, from_;
    double distance_ = 0;
    std::vector<DVec3> points_;
    DriverLine line_;    ///< of the cruise, where it has one
    float along_ = 0;    ///< m, on the line
    double driven_ = 0;  ///< m, on the line
};

}  // namespace

TrackRun drive(const Manoeuvre& manoeuvre, const VehicleDef& car, const TrackOptions& options) {
    VehicleDef def = car;
    def.level = options.level.value_or(car.level);
    if (const std::string wrong = whyInvalid(manoeuvre); !wrong.empty()) throw std::invalid_argument(wrong);
    if (!(options.hz >= 10 && options.hz <= 10000)) throw std::invalid_argument("hz must be in [10, 10000]");
    const float seconds = options.seconds.value_or(manoeuvre.duration);
    if (!(seconds > 0 && seconds <= 1e4f)) throw std::invalid_argument("seconds must be in (0, 1e4]");
    if (def.level < manoeuvre.leastLevel) {
        throw std::invalid_argument(manoeuvre.name + ": level is " + std::to_string(static_cast<int>(def.level)) +
                                    ", must be " + std::to_string(static_cast<int>(manoeuvre.leastLevel)) +
                                    " or more, to have what is measured");
    }
    TrackRun run = Drive(manoeuvre, def, options).run(seconds, 1.0 / static_cast<double>(options.hz));
    const float friction = options.friction.value_or(manoeuvre.ground.friction);
    for (const TrackMeasurement& one : manoeuvre.measure)
        run.values.push_back(measured(one, run, {&manoeuvre, &def, friction}));
    return run;
}

}  // namespace ragtop
