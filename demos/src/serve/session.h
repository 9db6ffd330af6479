#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands.h"
#include "debug_lines.h"
#include "draped.h"
#include "frame_encoder.h"
#include "live_world.h"
#include "nodes.h"
#include "page_server.h"
#include "ragtop/fixed_stepper.h"
#include "stage.h"

namespace ragtop::live {

/// Where a session's messages go: a PageServer, or a test.
struct Outlet {
    std::function<void(ClientId, std::string)> send;
    std::function<void(ClientId, FrameBytes)> sendFrame;
    std::function<bool(ClientId)> ready;
    std::function<void(const std::string& name, const std::string& mime, std::vector<std::byte>)> publish;
};

struct SessionOptions {
    std::size_t snapshotBytes = std::size_t{512} << 20;  ///< that snapshots may take
    bool playing = true;                                 ///< from the beginning, once there is a page
};

/// One world that all pages watch and drive: takes their messages, makes the steps that are due, and sends them what
/// has changed. It knows no sockets and no clock.
class Session {
public:
    Session(std::unique_ptr<Stage> stage, Outlet outlet, const SessionOptions& options = {});
    ~Session();

    void join(ClientId client);
    void leave(ClientId client);
    void receive(ClientId client, std::string_view message);
    /// Makes the steps that are due `elapsed` s after the last call, and sends frames and messages. Without pages the
    /// world waits.
    void advance(double elapsed);
    /// s until advance may have something to do.
    double idle() const;

    bool playing() const { return playing_; }
    LiveWorld& live() { return *live_; }
    Stage& stage() { return *stage_; }

private:
    struct Page {
        std::uint32_t poses = 0, cloths = 0, overlay = 0;  // number of the last one sent
    };
    /// Debug drawing of the world as it is.
    struct Overlay {
        std::uint32_t number = 0;
        FrameBytes lines, colors;
        bool hasLines = false, hasColors = false;
    };
    struct PendingSeek {
        ClientId client;
        Message message;
    };

    void open(std::unique_ptr<Stage> stage);
    void publish();
    void restart();
    void reload();
    void stepBy(int count);
    void input(const Input& input);
    void release();
    void worldChanged();
    void refreshNodes();
    void refreshTunables();

    // session_commands.cpp
    struct Perform;
    void perform(ClientId client, const Message& message);
    void performSeek();
    void answer(ClientId client, const Message& message, const Json& result, const std::string& error);

    // session_messages.cpp
    Json helloMessage() const;
    Json scenesJson() const;
    Json sceneMessage() const;
    Json cameraJson() const;
    Json tunablesJson() const;
    Json statusMessage() const;

    void makeSteps(double elapsed);
    void showWorld();
    void sendFrames();
    void sendAll(const Json& message);

    std::unique_ptr<Stage> stage_;
    Outlet outlet_;
    SessionOptions options_;
    std::unique_ptr<LiveWorld> live_;
    std::unique_ptr<Nodes> nodes_;
    std::unique_ptr<Draped> draped_;
    std::unique_ptr<FrameEncoder> encoder_;
    std::unique_ptr<FixedStepper> stepper_;
    DVec3 origin_;
    std::map<ClientId, Page> pages_;
    std::optional<ClientId> holder_;  // who has grabbed
    std::optional<std::uint32_t> picked_;
    std::optional<PendingSeek> seek_;  // the latest; those before it need not be shown
    ShowOptions show_;
    Overlay overlay_;
    std::shared_ptr<const TuneState> tunablesSent_;
    const std::vector<Blob>* published_ = nullptr;
    bool playing_ = true;
    bool statusDue_ = true, posesDue_ = true, telemetryDue_ = true;
    double speed_ = 1;
    double sinceStatus_ = 0, sinceTelemetry_ = 0, sinceReload_ = 0;
    double wall_ = 0, simulated_ = 0, realTimeFactor_ = 0;
};

}  // namespace ragtop::live
