#include <gmock/gmock.h>

#include <memory>
#include <thread>

#include "page_server_fixture.h"

/// One page and what it says, right or wrong.
namespace ragtop {
namespace {

using Kind = PageServer::MessageKind;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(PageServer, PageJoinsSpeaksAndLeaves) {
    PageServer server(onAnyPort());
    ClientId id = 0;
    {
        WebClient client(server.port());
        id = openedBy(client, server);
        EXPECT_THAT(server.clients(), ElementsAre(id));
        client.say(R"({"do":"pause"})");
        client.say("");
        client.sendFrame(WebClient::kText, "in ", false);
        client.sendFrame(WebClient::kPing, "between");
        client.sendFrame(WebClient::kContinuation, "parts");
        for (const char* text : {R"({"do":"pause"})", "", "in parts"}) {
            const auto message = nextMessage(server);
            EXPECT_EQ(message.kind, Kind::said);
            EXPECT_EQ(message.client, id);
            EXPECT_EQ(message.text, text);
        }
    }
    EXPECT_EQ(nextMessage(server).kind, Kind::left);
    EXPECT_THAT(server.clients(), ElementsAre());
    PageServer::Message none;
    EXPECT_FALSE(server.receive(none));
    EXPECT_FALSE(server.wait(0));
    server.send(id, "to nobody");
    server.sendFrame(id, frameOf(10));
    EXPECT_FALSE(server.ready(id));
}

TEST(PageServer, TextAndFramesArriveWholeAndInOrder) {
    PageServer server(onAnyPort());
    WebClient client(server.port());
    const ClientId id = openedBy(client, server);
    // Larger than what the system holds for a connection.
    constexpr std::size_t kSizes[] = {0, 1, 125, 126, 65535, 65536, 12'000'000};
    for (const std::size_t size : kSizes) {
        server.send(id, std::string(size, 't'));
        server.sendFrame(id, frameOf(size, std::byte{'f'}));
    }
    for (const std::size_t size : kSizes) {
        for (const auto& [opcode, letter] : {std::pair{WebClient::kText, 't'}, std::pair{WebClient::kBinary, 'f'}}) {
            const auto frame = client.receive();
            ASSERT_TRUE(frame);
            EXPECT_EQ(frame->opcode, opcode);
            EXPECT_TRUE(frame->payload == std::string(size, letter)) << size;
        }
    }
}

TEST(PageServer, ForeignPagesCannotConnect) {
    PageServer server(onAnyPort());
    const std::string own = "http://localhost:" + std::to_string(server.port());
    for (const std::string& origin : {std::string("http://evil.example"), std::string("null"), own + ".evil.example"}) {
        EXPECT_EQ(WebClient(server.port()).open("Origin: " + origin + "\r\n"), 403) << origin;
    }
    EXPECT_EQ(WebClient(server.port()).open("Host: evil.example:" + std::to_string(server.port()) + "\r\n"), 403);
    EXPECT_EQ(WebClient(server.port()).open("Origin: " + own + "\r\n"), 101);
}

TEST(PageServer, FiftyConnectionsAreSixteenPages) {
    PageServer server(onAnyPort());
    std::vector<std::unique_ptr<WebClient>> clients;
    int open = 0, refused = 0;
    for (int i = 0; i < 50; ++i) {
        clients.push_back(std::make_unique<WebClient>(server.port()));
        const int status = clients.back()->open();
        open += status == 101;
        refused += status == 503;
    }
    EXPECT_EQ(open, 16);
    EXPECT_EQ(refused, 34);
    for (int i = 0; i < 16; ++i) EXPECT_EQ(nextMessage(server).kind, Kind::joined);
    for (const ClientId id : server.clients()) server.send(id, "hello");
    for (int i = 0; i < 16; ++i) EXPECT_EQ(clients[static_cast<std::size_t>(i)]->receiveTextWith("hello"), "hello");

    clients.clear();
    for (int i = 0; i < 16; ++i) EXPECT_EQ(nextMessage(server).kind, Kind::left);
    WebClient again(server.port());
    openedBy(again, server);
}

TEST(PageServer, HundredMegabytesAreRefusedByTheirAnnouncement) {
    PageServer server(onAnyPort());
    WebClient client(server.port());
    openedBy(client, server);
    client.send(WebClient::frameHeader(WebClient::kText, 100'000'000));
    const auto answer = client.receive();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->closeCode(), 1009);
    client.finish();
    EXPECT_EQ(nextMessage(server).kind, Kind::left);
}

TEST(PageServer, LongMessageInShortPartsIsRefusedToo) {
    PageServer server(onAnyPort());
    WebClient client(server.port());
    openedBy(client, server);
    const std::string part(1000, 'x');
    client.sendFrame(WebClient::kText, part, false);
    for (int i = 1; i < 66; ++i) client.sendFrame(WebClient::kContinuation, part, false);
    const auto answer = client.receive();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->closeCode(), 1009);
    client.finish();
    EXPECT_EQ(nextMessage(server).kind, Kind::left);
}

TEST(PageServer, MessageOfTheLargestSizeIsTaken) {
    PageServer server(onAnyPort());
    WebClient client(server.port());
    openedBy(client, server);
    client.say(std::string(64 * 1024, 'x'));
    EXPECT_EQ(nextMessage(server).text.size(), 64u * 1024);
}

TEST(PageServer, BrokenFramesCloseWithTheCodeOfTheirFault) {
    PageServer server(onAnyPort());
    const auto closeCodeOf = [&](auto&& sendWrong) {
        WebClient client(server.port());
        openedBy(client, server);
        sendWrong(client);
        const auto answer = client.receive();
        client.finish();
        EXPECT_EQ(nextMessage(server).kind, Kind::left);
        return answer ? answer->closeCode() : 0;
    };
    EXPECT_EQ(closeCodeOf([](WebClient& c) { c.say("\xc3\x28"); }), 1007) << "not UTF-8";
    EXPECT_EQ(closeCodeOf([](WebClient& c) { c.send(std::string_view("\x81\x02hi", 4)); }), 1002) << "not masked";
    EXPECT_EQ(closeCodeOf([](WebClient& c) { c.sendFrame(3, "x"); }), 1002) << "unknown opcode";
    EXPECT_EQ(closeCodeOf([](WebClient& c) { c.sendFrame(0x40 | WebClient::kText, "x"); }), 1002)
        << "unknown extension";
    EXPECT_EQ(closeCodeOf([](WebClient& c) { c.sendFrame(WebClient::kContinuation, "x"); }), 1002) << "no beginning";
    EXPECT_EQ(closeCodeOf([](WebClient& c) { c.sendFrame(WebClient::kPing, std::string(126, 'x')); }), 1002);
    EXPECT_EQ(closeCodeOf([](WebClient& c) { c.sendFrame(WebClient::kClose, "x"); }), 1002);
}

TEST(PageServer, BinaryMessagesGetAnError) {
    PageServer server(onAnyPort());
    WebClient client(server.port());
    openedBy(client, server);
    client.sendFrame(WebClient::kBinary, "{}");
    EXPECT_THAT(client.receiveTextWith("error"), HasSubstr("must be text"));
    client.say("{}");
    EXPECT_EQ(nextMessage(server).text, "{}");
}

TEST(PageServer, MoreMessagesThanMayWaitGetAnError) {
    PageServer server(onAnyPort());
    WebClient flood(server.port()), other(server.port());
    openedBy(flood, server);
    openedBy(other, server);
    for (int i = 0; i < 300; ++i) flood.say(std::to_string(i));
    for (int i = 256; i < 300; ++i) EXPECT_THAT(flood.receiveTextWith("error"), HasSubstr("too many messages"));
    for (int i = 0; i < 256; ++i) EXPECT_EQ(nextMessage(server).text, std::to_string(i));
    other.say("still heard");
    EXPECT_EQ(nextMessage(server).text, "still heard");
}

TEST(PageServer, EndsWithWhateverIsUnderWay) {
    auto server = std::make_unique<PageServer>(onAnyPort());
    WebClient idle(server->port()), half(server->port()), upgrading(server->port()), page(server->port()),
        speaking(server->port());
    half.send("GET / HT");
    upgrading.send("GET /live HTTP/1.1\r\nUpgrade: websocket\r\n");
    const ClientId id = openedBy(page, *server);
    openedBy(speaking, *server);
    speaking.send(WebClient::frameHeader(WebClient::kText, 1000));
    for (int i = 0; i < 20; ++i) server->sendFrame(id, frameOf(1 << 20));
    page.say("unread");
    server.reset();
    EXPECT_EQ(idle.receiveAll(), "");
    EXPECT_FALSE(speaking.receive());
}

TEST(PageServer, WaitingEndsWhenAPageSpeaks) {
    PageServer server(onAnyPort());
    WebClient client(server.port());
    openedBy(client, server);
    std::thread later([&] { client.say("now"); });
    EXPECT_TRUE(server.wait(kForever));
    later.join();
}

}  // namespace
}  // namespace ragtop
