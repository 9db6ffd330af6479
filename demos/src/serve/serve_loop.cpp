#include "serve_loop.h"

#include <system_error>

#include "ragtop/asset_error.h"
#include "ragtop/data_folder.h"

namespace ragtop::live {
namespace {

constexpr double kMostListening = 0.005;  ///< s between two steps; the rest of what pages say waits

Outlet outletOf(PageServer& server) {
    Outlet outlet;
    outlet.send = [&](ClientId client, std::string text) { server.send(client, std::move(text)); };
    outlet.sendFrame = [&](ClientId client, FrameBytes frame) { server.sendFrame(client, std::move(frame)); };
    outlet.ready = [&](ClientId client) { return server.ready(client); };
    outlet.publish = [&](const std::string& name, const std::string& mime, std::vector<std::byte> bytes) {
        server.publish(name, mime, std::move(bytes));
    };
    return outlet;
}

}  // namespace

std::filesystem::path findPage(const std::optional<std::filesystem::path>& given) {
    std::error_code error;
    if (given) {
        if (!std::filesystem::is_regular_file(*given, error)) throw AssetError(given->string() + ": no such file");
        return *given;
    }
    std::filesystem::path installed;
    try {
        installed = dataFolder() / "page/ragtop.html";
    } catch (const AssetError&) {
    }
    // Read at run time, as the folders of data_folder.cpp are.
    static const char* volatile source = RAGTOP_PAGE_SOURCE;
    for (const std::filesystem::path& page : {installed, std::filesystem::path(source)}) {
        if (std::filesystem::is_regular_file(page, error)) return page;
    }
    return {};
}

ServeLoop::ServeLoop(std::unique_ptr<Stage> stage, const PageServerOptions& server, const SessionOptions& session)
    : server_(server),
      session_(std::move(stage), outletOf(server_), session),
      last_(std::chrono::steady_clock::now()) {}

void ServeLoop::update() {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::duration time) { return std::chrono::duration<double>(time).count(); };
    const auto start = Clock::now();
    PageServer::Message message;
    while (seconds(Clock::now() - start) < kMostListening && server_.receive(message)) {
        switch (message.kind) {
            case PageServer::MessageKind::joined:
                session_.join(message.client);
                break;
            case PageServer::MessageKind::said:
                session_.receive(message.client, message.text);
                break;
            case PageServer::MessageKind::left:
                session_.leave(message.client);
                break;
        }
    }
    const auto now = Clock::now();
    session_.advance(seconds(now - last_));
    last_ = now;
}

void ServeLoop::turn() {
    update();
    server_.wait(session_.idle());
}

}  // namespace ragtop::live
