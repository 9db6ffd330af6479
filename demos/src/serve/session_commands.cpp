#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "ragtop/world.h"
#include "session.h"

namespace ragtop::live {

struct Session::Perform {
    Session& self;
    ClientId client;

    DVec3 world(const Vec3& position) const { return self.origin_ + position; }

    BodyId bodyOf(std::uint32_t node) const {
        const BodyId body = self.nodes_->body(node);
        if (body.isNull()) throw std::invalid_argument(fmt::format("node is {}, must be the number of a body", node));
        return body;
    }
    void requireVehicle(std::size_t vehicle) const {
        const std::size_t count = self.stage_->cast().vehicles.size();
        if (vehicle >= count) {
            throw std::invalid_argument(fmt::format("vehicle is {}, must be below {}, their number", vehicle, count));
        }
    }

    Json operator()(const PlayCommand&) const {
        self.playing_ = self.statusDue_ = true;
        return Json::object();
    }
    Json operator()(const PauseCommand&) const {
        self.playing_ = false;
        self.statusDue_ = true;
        return Json::object();
    }
    Json operator()(const StepCommand& step) const {
        self.stepBy(step.count);
        return {{"step", self.live_->now()}};
    }
    Json operator()(const SeekCommand& seek) const {
        try {
            self.live_->seek(seek.step);
        } catch (const std::out_of_range& error) {
            throw std::invalid_argument(std::string("step ") + error.what());
        }
        self.playing_ = false;
        self.worldChanged();
        return {{"step", self.live_->now()}};
    }
    Json operator()(const RestartCommand&) const {
        self.restart();
        return Json::object();
    }
    Json operator()(const SpeedCommand& speed) const {
        self.speed_ = speed.factor;
        self.statusDue_ = true;
        return Json::object();
    }
    Json operator()(const LoadCommand& load) const {
        self.open(self.stage_->opened(load.scene));
        return Json::object();
    }
    Json operator()(const ScenesCommand&) const { return {{"scenes", self.scenesJson()}}; }
    Json operator()(const ShowCommand& show) const {
        for (const auto& [name, on] : show.options) self.show_[name] = on;
        self.statusDue_ = self.posesDue_ = true;
        return Json::object();
    }
    Json operator()(const GrabCommand& grab) const {
        const BodyId body = bodyOf(grab.node);
        self.input(GrabInput{body, grab.point, world(grab.target)});
        self.holder_ = client;
        return Json::object();
    }
    Json operator()(const DragCommand& drag) const {
        if (self.holder_ != client) throw std::invalid_argument("this page has grabbed nothing");
        // At the rate of the mouse; it moves nothing by itself.
        self.live_->apply(DragInput{world(drag.target)});
        return Json::object();
    }
    Json operator()(const ReleaseCommand&) const {
        if (self.holder_ != client) throw std::invalid_argument("this page has grabbed nothing");
        self.release();
        return Json::object();
    }
    Json operator()(const ShootCommand& shoot) const {
        const BodyId ball =
            self.live_->apply(ShootInput{world(shoot.origin), shoot.direction, shoot.speed, shoot.radius});
        self.worldChanged();
        return {{"node", *self.nodes_->node(ball)}};
    }
    Json operator()(const DriveCommand& drive) const {
        requireVehicle(drive.vehicle);
        self.live_->apply(
            DriveInput{drive.vehicle, drive.throttle, drive.brake, drive.steer, drive.handbrake, drive.gear});
        return Json::object();
    }
    Json operator()(const ResetVehicleCommand& reset) const {
        requireVehicle(reset.vehicle);
        self.input(ResetInput{reset.vehicle});
        return Json::object();
    }
    Json operator()(const PickCommand& pick) const {
        if (pick.node) bodyOf(*pick.node);
        self.picked_ = pick.node;
        self.statusDue_ = self.telemetryDue_ = true;
        return Json::object();
    }
    Json operator()(const TuneCommand& tune) const {
        self.input(TuneInput{{{tune.path, tune.value}}});
        return {{"value", tuneJson(self.stage_->tuning().field(tune.path).value)}};
    }
    Json operator()(const UntuneCommand& untune) const {
        const Tuning& tuning = self.stage_->tuning();
        const auto i = static_cast<std::size_t>(&tuning.field(untune.path) - tuning.fields().data());
        return (*this)(TuneCommand{untune.path, tuning.defaults()[i]});
    }
    Json operator()(const SaveTuningCommand& save) const { return {{"file", self.stage_->saveTuning(save.name)}}; }
    Json operator()(const LoadTuningCommand& load) const {
        auto values = self.stage_->savedTuning(load.name);
        const std::size_t count = values.size();
        if (count > 0) self.input(TuneInput{std::move(values)});
        return {{"changed", count}};
    }
    Json operator()(const HashCommand&) const {
        return {{"step", self.live_->now()}, {"hash", fmt::format("{:016x}", self.stage_->cast().world->hash())}};
    }
};

void Session::perform(ClientId client, const Message& message) {
    if (message.command && std::holds_alternative<SeekCommand>(*message.command)) {
        // While a slider is dragged only the last place counts.
        if (seek_) answer(seek_->client, seek_->message, {{"step", live_->now()}}, {});
        seek_ = PendingSeek{client, message};
        return;
    }
    performSeek();
    Json result = Json::object();
    std::string error = message.error;
    if (message.command) {
        try {
            result = std::visit(Perform{*this, client}, *message.command);
        } catch (const std::exception& wrong) {
            error = message.explained(wrong.what());
        }
    }
    answer(client, message, result, error);
}

void Session::performSeek() {
    if (!seek_) return;
    const PendingSeek pending = *std::exchange(seek_, std::nullopt);
    Json result = Json::object();
    std::string error;
    try {
        result = Perform{*this, pending.client}(std::get<SeekCommand>(*pending.message.command));
    } catch (const std::exception& wrong) {
        error = pending.message.explained(wrong.what());
    }
    answer(pending.client, pending.message, result, error);
}

void Session::answer(ClientId client, const Message& message, const Json& result, const std::string& error) {
    if (!message.id) {
        if (!error.empty()) outlet_.send(client, text({{"type", "error"}, {"error", error}}));
        return;
    }
    Json reply{{"type", "re"}, {"re", *message.id}, {"ok", error.empty()}};
    if (!error.empty())
        reply["error"] = error;
    else
        reply.update(result);
    outlet_.send(client, text(reply));
}

}  // namespace ragtop::live
