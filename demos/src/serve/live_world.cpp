#include "live_world.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "ragtop/world.h"

namespace ragtop::live {

LiveWorld::LiveWorld(Cast& cast, Tuning& tuning, std::size_t snapshotBytes)
    : cast_(cast),
      tuning_(tuning),
      hand_(*cast.world),
      driven_(cast.vehicles.size(), false),
      snapshots_(snapshotBytes) {
    last_ = now();
    keep();
}

std::uint64_t LiveWorld::now() const { return cast_.world->stepCount(); }

void LiveWorld::keep() {
    Snapshot snapshot{now(), std::vector<std::byte>(cast_.world->saveSize()), tuning_.state(), driven_};
    cast_.world->save(snapshot.world);
    snapshots_.add(std::move(snapshot));
    // Nobody can go back to what came before.
    const auto past = std::find_if(log_.begin(), log_.end(), [&](const Entry& entry) { return entry.step >= first(); });
    log_.erase(log_.begin(), past);
}

void LiveWorld::step() {
    if (cast_.beforeStep) cast_.beforeStep(driven_);
    cast_.world->step(cast_.step);
    last_ = std::max(last_, now());
    if (now() >= snapshots_.last() + Snapshots::kEvery) keep();
    replay(now());
}

void LiveWorld::replay(std::uint64_t step) {
    auto entry =
        std::lower_bound(log_.begin(), log_.end(), step, [](const Entry& e, std::uint64_t s) { return e.step < s; });
    for (; entry != log_.end() && entry->step == step; ++entry) perform(entry->input);
}

void LiveWorld::seek(std::uint64_t step) {
    if (step < first() || step > last_) {
        throw std::out_of_range("is " + std::to_string(step) + ", must be in [" + std::to_string(first()) + ", " +
                                std::to_string(last_) + "]");
    }
    const Snapshot& from = snapshots_.before(step);
    if (step < now() || from.step > now()) {
        restore(from);
        replay(now());
    }
    while (now() < step) this->step();
}

void LiveWorld::restore(const Snapshot& from) {
    // First the tunables: a vehicle's state has the shape that its definition gives it.
    tuning_.restore(*from.tuned);
    driven_ = from.driven;
    cast_.world->restore(from.world);
}

void LiveWorld::restart() {
    const auto tuned = tuning_.state();
    restore(snapshots_.initial());
    log_.clear();
    snapshots_.dropAfter(now());
    last_ = now();
    ++timeline_;
    TuneInput kept;
    for (std::size_t i = 0; i < tuned->size(); ++i) {
        const TunableField& field = tuning_.fields()[i];
        if (field.value != (*tuned)[i]) kept.values.emplace_back(field.path, (*tuned)[i]);
    }
    if (!kept.values.empty()) apply(kept);
}

BodyId LiveWorld::apply(const Input& input) {
    const BodyId made = perform(input);
    if (last_ > now()) {
        last_ = now();
        std::erase_if(log_, [&](const Entry& entry) { return entry.step > now(); });
        snapshots_.dropAfter(now());
        ++timeline_;
    }
    log_.push_back({now(), input});
    return made;
}

BodyId LiveWorld::perform(const Input& input) {
    struct Perform {
        LiveWorld& self;
        BodyId operator()(const DriveInput& in) const { return self.drive(in), BodyId{}; }
        BodyId operator()(const ResetInput& in) const { return self.resetVehicle(in), BodyId{}; }
        BodyId operator()(const GrabInput& in) const { return self.hand_.grab(in.body, in.point, in.target), BodyId{}; }
        BodyId operator()(const DragInput& in) const { return self.hand_.drag(in.target), BodyId{}; }
        BodyId operator()(const ReleaseInput&) const { return self.hand_.release(), BodyId{}; }
        BodyId operator()(const ShootInput& in) const {
            return self.hand_.shoot(in.origin, in.direction, in.speed, in.radius);
        }
        BodyId operator()(const TuneInput& in) const { return self.tuning_.set(in.values), BodyId{}; }
    };
    return std::visit(Perform{*this}, input);
}

void LiveWorld::drive(const DriveInput& in) {
    VehicleInput& input = cast_.vehicles.at(in.vehicle).vehicle->input;
    // Who takes over from the script finds all pedals up.
    if (!driven_[in.vehicle]) input = {};
    driven_[in.vehicle] = true;
    if (in.throttle) input.throttle = *in.throttle;
    if (in.brake) input.brake = *in.brake;
    if (in.steer) input.steer = *in.steer;
    if (in.handbrake) input.handbrake = *in.handbrake;
    if (in.gear) input.gear = *in.gear;
}

void LiveWorld::resetVehicle(const ResetInput& in) {
    CastVehicle& car = cast_.vehicles.at(in.vehicle);
    VehiclePlacement start = car.start;
    start.speed = 0;
    car.vehicle->place(start);
    car.vehicle->input = {};
    driven_[in.vehicle] = true;
}

}  // namespace ragtop::live
