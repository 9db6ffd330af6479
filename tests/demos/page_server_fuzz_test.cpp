#include <memory>
#include <random>
#include <thread>

#include "page_server_fixture.h"

/// Noise on the line: with a fixed seed, so that a failure comes again.
namespace ragtop {
namespace {

using Random = std::mt19937;

std::size_t below(Random& random, std::size_t limit) { return random() % limit; }

std::string noise(Random& random, std::size_t most) {
    std::string text(below(random, most + 1), '\0');
    for (char& c : text) c = static_cast<char>(random() & 0xff);
    return text;
}

/// Changes, drops, doubles or inserts a few bytes.
std::string damaged(std::string text, Random& random) {
    for (std::size_t i = 1 + below(random, 4); i > 0 && !text.empty(); --i) {
        const std::size_t at = below(random, text.size());
        switch (below(random, 4)) {
            case 0:
                text[at] = static_cast<char>(random() & 0xff);
                break;
            case 1:
                text.erase(at, 1 + below(random, 8));
                break;
            case 2:
                text.insert(at, text.substr(at, 1 + below(random, 16)));
                break;
            default:
                text.insert(at, noise(random, 8));
        }
    }
    return text;
}

std::string handshake(int port) {
    return "GET /live HTTP/1.1\r\nHost: localhost:" + std::to_string(port) +
           "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
}

/// A frame as bytes, right but for what may be damaged.
std::string frameOfNoise(Random& random) {
    constexpr int kOpcodes[] = {0, 1, 1, 1, 2, 3, 8, 9, 10, 11};
    const std::string payload = noise(random, below(random, 3) == 0 ? 70'000 : 200);
    const std::size_t announced = below(random, 4) == 0 ? below(random, std::size_t{1} << 40) : payload.size();
    std::string frame =
        WebClient::frameHeader(kOpcodes[below(random, std::size(kOpcodes))], announced, below(random, 3) != 0);
    return below(random, 2) ? damaged(frame, random) + payload : frame + payload;
}

/// A server that answers what a page says, with one good page to watch it.
class Fuzz : public testing::Test {
protected:
    Fuzz() { good.open(); }
    ~Fuzz() override {
        ended = true;
        simulation.join();
    }
    /// The good page is still answered, and in order.
    void expectAlive() {
        const std::string text = "question " + std::to_string(++questions);
        ASSERT_TRUE(good.say(text));
        ASSERT_EQ(good.receiveTextWith("question"), text);
    }

    PageServer server{onAnyPort()};
    WebClient good{server.port()};
    int questions = 0;

private:
    void echo() {
        PageServer::Message message;
        while (!ended) {
            server.wait(0.01);
            while (server.receive(message)) {
                if (message.kind == PageServer::MessageKind::said) server.send(message.client, message.text);
            }
        }
    }
    std::atomic<bool> ended = false;
    std::thread simulation{[this] { echo(); }};
};

TEST_F(Fuzz, TwoHundredBrokenHandshakesLeaveTheServerWell) {
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        WebClient client(server.port());
        client.send(i % 4 == 0 ? noise(random, 500) : damaged(handshake(server.port()), random));
        if (i % 3 == 0) client.send(frameOfNoise(random));
        client.finish();
        if (i % 2 == 0) client.receiveAll();
        if (i % 20 == 0) expectAlive();
    }
    expectAlive();
}

TEST_F(Fuzz, TwoHundredBrokenMessagesLeaveTheServerWell) {
    Random random(4);
    for (int i = 0; i < 200; ++i) {
        WebClient client(server.port());
        ASSERT_EQ(client.open(), 101) << i;
        for (std::size_t frames = 1 + below(random, 5); frames > 0; --frames) client.send(frameOfNoise(random));
        client.finish();
        client.receiveAll();
        if (i % 20 == 0) expectAlive();
    }
    expectAlive();
}

TEST_F(Fuzz, OneConnectionMaySayNonsenseForLong) {
    Random random(5);
    WebClient client(server.port());
    ASSERT_EQ(client.open(), 101);
    for (int i = 0; i < 200; ++i) {
        std::string text = noise(random, 300);
        for (char& c : text) c = static_cast<char>(c & 0x7f);
        ASSERT_TRUE(client.say(text));
        const auto answer = client.receive();
        ASSERT_TRUE(answer);
        ASSERT_EQ(answer->payload, text);
    }
    expectAlive();
}

TEST_F(Fuzz, HundredMegabytesAreNotTaken) {
    WebClient client(server.port());
    ASSERT_EQ(client.open(), 101);
    client.send(WebClient::frameHeader(WebClient::kText, 100'000'000));
    const std::string part(1 << 20, 'x');
    int sent = 0;
    while (sent < 100 && client.send(part)) ++sent;
    EXPECT_LT(sent, 100);
    expectAlive();
}

}  // namespace
}  // namespace ragtop
