#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <thread>

#include "page_server_fixture.h"

/// Pages that read slowly, or never.
namespace ragtop {
namespace {

using Kind = PageServer::MessageKind;

WebClient hesitant(PageServer& server) {
    WebClient::Options options;
    options.receiveBuffer = 4096;
    return WebClient(server.port(), options);
}

/// Frames of a scene of 2,000 bodies for those who are ready, as often as it takes; each frame bears its number.
class Stream {
public:
    explicit Stream(PageServer& server) : server_(server) {}
    void step() {
        ++number_;
        const auto frame = std::make_shared<std::vector<std::byte>>(64'032);
        (*frame)[0] = static_cast<std::byte>(number_ & 0xff);
        for (const ClientId id : server_.clients()) {
            if (!server_.ready(id)) continue;
            server_.sendFrame(id, frame);
            ++sent_[id];
        }
    }
    int sent(ClientId id) { return sent_[id]; }

private:
    PageServer& server_;
    unsigned number_ = 0;
    std::map<ClientId, int> sent_;
};

TEST(PageServer, PageThatNeverReadsSkipsFramesAndHoldsNobodyUp) {
    PageServerOptions options;
    options.lagSeconds = 0.02;
    PageServer server(onAnyPort(options));
    WebClient stuck = hesitant(server), reader(server.port());
    const ClientId stuckId = openedBy(stuck, server), readerId = openedBy(reader, server);
    std::atomic<int> read = 0;
    std::thread reading([&] {
        for (auto frame = reader.receive(); frame && frame->opcode == WebClient::kBinary; frame = reader.receive()) {
            EXPECT_EQ(frame->payload.size(), 64'032u);
            ++read;
        }
    });
    Stream stream(server);
    while (read < 200) {
        stream.step();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    server.send(readerId, "the end");
    reading.join();
    EXPECT_FALSE(server.ready(stuckId));
    EXPECT_LT(stream.sent(stuckId), 200);
    EXPECT_EQ(server.clients().size(), 2u) << "it may still begin to read";
}

TEST(PageServer, PageThatReadsAgainIsReadyAgain) {
    PageServerOptions options;
    options.lagSeconds = 0.01;
    PageServer server(onAnyPort(options));
    WebClient client = hesitant(server);
    const ClientId id = openedBy(client, server);
    Stream stream(server);
    for (int i = 0; i < 100; ++i) {
        stream.step();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_FALSE(server.ready(id));
    server.send(id, "the end");
    int frames = 0;
    std::thread reading([&] {
        for (auto frame = client.receive(); frame && frame->payload != "the end"; frame = client.receive()) ++frames;
        client.say("got it");
        while (client.receive()) {
        }
    });
    EXPECT_EQ(nextMessage(server).text, "got it");
    EXPECT_EQ(frames, stream.sent(id)) << "what was sent has come";
    while (!server.ready(id)) std::this_thread::yield();
    PageServer::Message none;
    EXPECT_FALSE(server.receive(none));
    client.finish();
    reading.join();
}

TEST(PageServer, PageThatLetsTooMuchPileUpIsCutOff) {
    PageServerOptions options;
    options.unsentBytes = 1 << 20;
    PageServer server(onAnyPort(options));
    WebClient stuck = hesitant(server), reader(server.port());
    const ClientId stuckId = openedBy(stuck, server), readerId = openedBy(reader, server);
    // The system itself holds some megabytes for a connection.
    for (int i = 0; i < 64; ++i) server.send(stuckId, std::string(1 << 20, 'x'));
    const auto message = nextMessage(server);
    EXPECT_EQ(message.kind, Kind::left);
    EXPECT_EQ(message.client, stuckId);
    EXPECT_THAT(server.clients(), testing::ElementsAre(readerId));
    server.send(readerId, "still here");
    EXPECT_EQ(reader.receiveTextWith("here"), "still here");
}

TEST(PageServer, PageThatIsSilentForLongIsCutOff) {
    PageServerOptions options;
    options.silenceSeconds = 0.1;
    PageServer server(onAnyPort(options));
    WebClient stuck = hesitant(server), reader(server.port());
    const ClientId stuckId = openedBy(stuck, server), readerId = openedBy(reader, server);
    server.sendFrame(stuckId, frameOf(100));
    const auto message = nextMessage(server);
    EXPECT_EQ(message.kind, Kind::left);
    EXPECT_EQ(message.client, stuckId);
    server.send(readerId, "still here");
    EXPECT_EQ(reader.receiveTextWith("here"), "still here") << "it has nothing to be silent about";
}

TEST(PageServer, PageThatAsksAndNeverReadsTheAnswersIsCutOff) {
    PageServerOptions options;
    options.unsentBytes = 1 << 20;
    options.silenceSeconds = 0.1;
    PageServer server(onAnyPort(options));
    WebClient stuck = hesitant(server);
    openedBy(stuck, server);
    std::thread flood([&] {
        while (stuck.sendFrame(WebClient::kPing, std::string(100, 'x'))) {
        }
    });
    std::thread asking([&, other = hesitant(server)]() mutable {
        other.open();
        while (other.sendFrame(WebClient::kBinary, "x")) {
        }
    });
    int left = 0;
    while (left < 1) {
        const auto message = nextMessage(server);
        left += message.kind == Kind::left;
        if (message.kind == Kind::joined) server.send(message.client, "hello");
    }
    // The one that floods with pings and is sent nothing may stay: it costs no memory. It ends with the server.
    EXPECT_EQ(left, 1);
    for (const ClientId id : server.clients()) server.send(id, std::string(2 << 20, 'x'));
    EXPECT_EQ(nextMessage(server).kind, Kind::left);
    flood.join();
    asking.join();
}

}  // namespace
}  // namespace ragtop
