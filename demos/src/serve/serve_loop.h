#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include "page_server.h"
#include "session.h"

namespace ragtop::live {

/// The page: `given`, or else that in dataFolder(), or the source tree's; empty when there is none. Throws AssetError
/// when `given` is no file.
std::filesystem::path findPage(const std::optional<std::filesystem::path>& given);

/// A session on a server, in real time.
class ServeLoop {
public:
    /// Throws std::runtime_error when the port is taken.
    ServeLoop(std::unique_ptr<Stage> stage, const PageServerOptions& server, const SessionOptions& session);

    int port() const { return server_.port(); }
    Session& session() { return session_; }
    /// Takes messages, makes the steps that are due, sends frames; never waits.
    void update();
    /// The same, and waits until there is more to do, a quarter of a second at most.
    void turn();

private:
    PageServer server_;
    Session session_;
    std::chrono::steady_clock::time_point last_;
};

}  // namespace ragtop::live
