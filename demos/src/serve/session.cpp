#include "session.h"

#include <algorithm>
#include <cmath>

#include "live_telemetry.h"
#include "ragtop/world.h"

namespace ragtop::live {
namespace {

constexpr double kStatusEvery = 0.25, kTelemetryEvery = 1.0 / 30, kReloadEvery = 0.5;  ///< s
constexpr double kFactorOver = 0.5;  ///< s over which the real-time factor is measured
constexpr int kMostStepsAtOnce = 4;
constexpr double kFar = 4096;  ///< m; poses of a scene farther away are told from its middle

/// Near what moves when that is far away.
DVec3 originOf(const World& world) {
    DVec3 sum;
    double count = 0;
    for (const BodyId body : world.bodies()) {
        if (world.type(body) != BodyType::dynamic) continue;
        sum = sum + world.centerOfMass(body);
        count += 1;
    }
    if (count == 0) return {};
    const DVec3 middle = (1 / count) * sum;
    const double distance = std::max({std::abs(middle.x), std::abs(middle.y), std::abs(middle.z)});
    if (distance < kFar) return {};
    return {std::round(middle.x), std::round(middle.y), std::round(middle.z)};
}

}  // namespace

Session::Session(std::unique_ptr<Stage> stage, Outlet outlet, const SessionOptions& options)
    : outlet_(std::move(outlet)), options_(options), playing_(options.playing) {
    for (const std::string& name : showNames()) show_[name] = false;
    open(std::move(stage));
}

Session::~Session() {
    // It is a part of the world, which the stage owns.
    live_.reset();
}

void Session::open(std::unique_ptr<Stage> stage) {
    live_.reset();
    nodes_.reset();
    stage_ = std::move(stage);
    Cast& cast = stage_->cast();
    origin_ = originOf(*cast.world);
    live_ = std::make_unique<LiveWorld>(cast, stage_->tuning(), options_.snapshotBytes);
    nodes_ = std::make_unique<Nodes>(cast, live_->hand(), origin_);
    draped_ = std::make_unique<Draped>(cast, origin_);
    encoder_ = std::make_unique<FrameEncoder>(origin_);
    stepper_ = std::make_unique<FixedStepper>(cast.step, kMostStepsAtOnce);
    holder_.reset();
    picked_.reset();
    seek_.reset();
    publish();
    tunablesSent_ = stage_->tuning().state();
    for (auto& page : pages_) page.second = {};
    if (!pages_.empty()) sendAll(sceneMessage());
    worldChanged();
}

void Session::publish() {
    if (published_ == &stage_->blobs()) return;
    published_ = &stage_->blobs();
    for (const Blob& blob : *published_) outlet_.publish(blob.name, "model/gltf-binary", blob.bytes);
}

void Session::restart() {
    if (auto anew = stage_->restarted()) return open(std::move(anew));
    live_->restart();
    holder_.reset();
    worldChanged();
}

void Session::join(ClientId client) {
    pages_[client] = {};
    outlet_.send(client, text(helloMessage()));
    outlet_.send(client, text(sceneMessage()));
    outlet_.send(client, text(statusMessage()));
    posesDue_ = telemetryDue_ = true;
}

void Session::leave(ClientId client) {
    pages_.erase(client);
    if (seek_ && seek_->client == client) seek_.reset();
    if (holder_ == client) release();
}

void Session::receive(ClientId client, std::string_view said) {
    if (pages_.contains(client)) perform(client, readMessage(said));
}

void Session::stepBy(int count) {
    playing_ = false;
    const auto now = static_cast<std::int64_t>(live_->now());
    const std::int64_t wanted = std::max(now + count, static_cast<std::int64_t>(live_->first()));
    live_->seek(static_cast<std::uint64_t>(std::min(wanted, static_cast<std::int64_t>(live_->last()))));
    while (static_cast<std::int64_t>(live_->now()) < wanted) live_->step();
    worldChanged();
}

void Session::input(const Input& input) {
    live_->apply(input);
    worldChanged();
}

/// An input only where something is held: it may not be after a step back, and the future would be dropped for nothing.
void Session::release() {
    holder_.reset();
    if (!live_->hand().held().isNull()) input(ReleaseInput{});
}

/// After anything but plain steps.
void Session::worldChanged() {
    refreshNodes();
    refreshTunables();
    statusDue_ = posesDue_ = telemetryDue_ = true;
}

void Session::refreshNodes() {
    if (const Json change = nodes_->refresh(live_->timeline()); !change.is_null()) sendAll(change);
}

void Session::refreshTunables() {
    const Tuning& tuning = stage_->tuning();
    const auto now = tuning.state();
    if (now == tunablesSent_) return;
    Json values = Json::array();
    for (std::size_t i = 0; i < now->size(); ++i) {
        if ((*now)[i] == (*tunablesSent_)[i]) continue;
        values.push_back({{"path", tuning.fields()[i].path}, {"value", tuneJson((*now)[i])}});
    }
    tunablesSent_ = now;
    if (!values.empty()) sendAll({{"type", "tunables"}, {"values", std::move(values)}});
}

void Session::reload() {
    Reload reload = stage_->reload();
    for (const Reload::File& file : reload.files) {
        sendAll({{"type", "file"}, {"path", file.path}, {"ok", file.ok}, {"message", file.message}});
    }
    const bool usable = !reload.files.empty() && reload.files.front().ok;
    if (reload.anew) return open(std::move(reload.anew));
    if (!usable) return;
    if (!reload.values.empty()) input(TuneInput{std::move(reload.values)});
    sendAll({{"type", "tunables"}, {"values", Json::array()}, {"tunables", tunablesJson()}});
}

void Session::advance(double elapsed) {
    performSeek();
    sinceReload_ += elapsed;
    if (sinceReload_ >= kReloadEvery) {
        sinceReload_ = 0;
        reload();
    }
    if (pages_.empty()) return;
    makeSteps(elapsed);
    if (posesDue_) showWorld();
    sendFrames();
    sinceStatus_ += elapsed;
    sinceTelemetry_ += elapsed;
    if (statusDue_ || sinceStatus_ >= kStatusEvery) {
        statusDue_ = false;
        sinceStatus_ = 0;
        sendAll(statusMessage());
    }
    if (telemetryDue_ || (playing_ && sinceTelemetry_ >= kTelemetryEvery)) {
        telemetryDue_ = false;
        sinceTelemetry_ = 0;
        sendAll(telemetryMessage(stage_->cast(), *nodes_, picked_, origin_));
    }
}

void Session::makeSteps(double elapsed) {
    if (!playing_) {
        realTimeFactor_ = wall_ = simulated_ = 0;
        return;
    }
    const int count = stepper_->advance(elapsed * speed_).count();
    for (int i = 0; i < count; ++i) live_->step();
    if (count > 0) posesDue_ = true;
    wall_ += elapsed;
    simulated_ += count * stage_->cast().step;
    if (wall_ < kFactorOver) return;
    realTimeFactor_ = simulated_ / wall_;
    wall_ = simulated_ = 0;
}

/// Takes the world up as it is now, for the pages to see.
void Session::showWorld() {
    posesDue_ = false;
    refreshNodes();
    refreshTunables();
    const Cast& cast = stage_->cast();
    const auto step = static_cast<std::uint32_t>(live_->now());
    encoder_->update(nodes_->poses(), step, cast.world->time());
    draped_->update(step);
    const bool lines = showsLines(show_), colors = show_.at("islands");
    if (!lines && !colors && !overlay_.hasLines && !overlay_.hasColors) return;
    ++overlay_.number;
    overlay_.lines = lines || overlay_.hasLines ? encodeLines(debugLines(cast, show_, origin_), step) : nullptr;
    overlay_.colors = colors || overlay_.hasColors ? encodeColors(islandColors(cast, *nodes_, colors), step) : nullptr;
    // What is switched off is told once more; pages that were slow may learn it later, all the same.
    overlay_.hasLines = lines;
    overlay_.hasColors = colors;
}

void Session::sendFrames() {
    for (auto& [client, page] : pages_) {
        const bool behind =
            page.poses != encoder_->sequence() || page.cloths != draped_->sequence() || page.overlay != overlay_.number;
        if (!behind || !outlet_.ready(client)) continue;
        if (page.poses != encoder_->sequence()) outlet_.sendFrame(client, encoder_->encode(page.poses));
        // After the poses of the same step.
        if (page.cloths != draped_->sequence()) outlet_.sendFrame(client, draped_->frame());
        if (page.overlay != overlay_.number) {
            for (const FrameBytes& frame : {overlay_.lines, overlay_.colors}) {
                if (frame) outlet_.sendFrame(client, frame);
            }
        }
        page.poses = encoder_->sequence();
        page.cloths = draped_->sequence();
        page.overlay = overlay_.number;
    }
}

double Session::idle() const {
    if (pages_.empty()) return kStatusEvery;
    if (statusDue_ || posesDue_ || telemetryDue_ || seek_) return 0;
    if (!playing_) return kTelemetryEvery;
    return std::min((1 - stepper_->blendFactor()) * stage_->cast().step / speed_, kStatusEvery);
}

void Session::sendAll(const Json& message) {
    if (pages_.empty()) return;
    const std::string line = text(message);
    for (const auto& page : pages_) outlet_.send(page.first, line);
}

}  // namespace ragtop::live
