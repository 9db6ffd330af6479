#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "page_server_fixture.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

TEST(PageServer, GivesThePageAndWhatIsPublished) {
    const auto path = temporaryPath("served.html");
    const std::string html(3 << 20, 'h');
    std::ofstream(path) << html;
    PageServerOptions options;
    options.page = path;
    PageServer server(onAnyPort(options));
    std::filesystem::remove(path);
    server.publish("car.glb", "model/gltf-binary", {std::byte{1}, std::byte{0}, std::byte{2}});

    WebClient client(server.port());
    const auto page = client.get("/");
    EXPECT_EQ(page.status, 200);
    EXPECT_EQ(page.fields.at("content-type"), "text/html; charset=utf-8");
    EXPECT_TRUE(page.body == html);
    const auto car = client.get("/visual/car.glb");
    EXPECT_EQ(car.status, 200);
    EXPECT_EQ(car.fields.at("content-type"), "model/gltf-binary");
    EXPECT_EQ(car.body, std::string("\1\0\2", 3));
}

TEST(PageServer, EveryAnswerKeepsOtherSitesOut) {
    PageServer server(onAnyPort());
    for (const char* target : {"/", "/nothing", "/live"}) {
        const auto fields = WebClient(server.port()).get(target).fields;
        const std::string& policy = fields.at("content-security-policy");
        EXPECT_TRUE(policy.starts_with("default-src 'none';")) << policy;
        EXPECT_NE(policy.find("frame-ancestors 'none'"), std::string::npos);
        EXPECT_NE(policy.find("ws://localhost:" + std::to_string(server.port())), std::string::npos);
        EXPECT_EQ(policy.find("unsafe-eval"), std::string::npos);
        EXPECT_EQ(fields.at("x-content-type-options"), "nosniff");
        EXPECT_EQ(fields.at("cache-control"), "no-store");
        EXPECT_EQ(fields.at("cross-origin-resource-policy"), "same-origin");
        EXPECT_EQ(fields.count("access-control-allow-origin"), 0u);
    }
}

TEST(PageServer, ListensOnOneAddressOnly) {
    PageServer server(onAnyPort());
    WebClient::Options other;
    other.address = "127.0.0.2";
    EXPECT_THROW(WebClient(server.port(), other), std::runtime_error);
}

TEST(PageServer, PortThatIsTakenIsAnError) {
    PageServer server(onAnyPort());
    PageServerOptions same;
    same.port = server.port();
    try {
        PageServer second(same);
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(std::string(error.what()).find("port " + std::to_string(server.port()) + " is taken"), 0u);
    }
    same.port = 70000;
    EXPECT_THROW(PageServer{same}, std::runtime_error);
}

TEST(PageServer, PortIsFreeAgainAfterIt) {
    PageServerOptions options;
    {
        PageServer server(onAnyPort());
        options.port = server.port();
        WebClient client(server.port());
        EXPECT_EQ(client.get("/").status, 200);
    }
    EXPECT_EQ(PageServer(options).port(), options.port);
}

TEST(PageServer, WrongRequestsAreToldWhyAndEndTheConnection) {
    PageServer server(onAnyPort());
    const struct {
        std::string start, fields;
        int status;
    } cases[] = {
        {"GET / HTTP/1.1\r\n", "Host: evil.example\r\n", 403},
        {"GET / HTTP/1.1\r\n", "Host: localhost\r\nHost: localhost\r\n", 403},
        {"GET /live HTTP/1.1\r\n", "Origin: http://evil.example\r\n", 403},
        {"GET /../../etc/passwd HTTP/1.1\r\n", "", 404},
        {"GET /visual/%2e%2e/%2e%2e/etc/passwd HTTP/1.1\r\n", "", 404},
        {"POST / HTTP/1.1\r\n", "Content-Length: 5\r\n", 405},
        {"BREW / HTTP/1.1\r\n", "", 405},
        {"GET / HTTP/1.1\r\n", "Content-Length: 100000000\r\n", 413},
        {"GET / HTTP/1.1\r\n", "Transfer-Encoding: chunked\r\n", 413},
        {"GET / HTTP/1.1\r\n", "Content-Length: -1\r\n", 400},
        {"GET / HTTP/7.1\r\n", "", 400},
        {"what is this\r\n", "", 400},
        {"GET / HTTP/1.1\r\n", "Long: " + std::string(10000, 'x') + "\r\n", 431},
        {"GET /" + std::string(10000, 'x') + " HTTP/1.1\r\n", "", 431},
    };
    for (const auto& wrong : cases) {
        WebClient client(server.port());
        const auto answer = client.request(wrong.start, wrong.fields);
        EXPECT_EQ(answer.status, wrong.status) << wrong.start.substr(0, 60) << wrong.fields.substr(0, 60);
        EXPECT_EQ(client.receiveAll(), "");
    }
    EXPECT_EQ(WebClient(server.port()).get("/").status, 200);
}

TEST(PageServer, HugeUploadIsRefusedUnread) {
    PageServer server(onAnyPort());
    WebClient client(server.port());
    client.send("POST / HTTP/1.1\r\nHost: localhost:" + std::to_string(server.port()) +
                "\r\nContent-Length: 100000000\r\n\r\n");
    EXPECT_EQ(client.receiveAnswer().status, 405);
}

TEST(PageServer, RequestsInOneGoAreAnsweredInOrder) {
    PageServer server(onAnyPort());
    server.publish("a", "text/plain", {std::byte{'a'}});
    server.publish("b", "text/plain", {std::byte{'b'}});
    WebClient client(server.port());
    const std::string host = " HTTP/1.1\r\nHost: localhost:" + std::to_string(server.port()) + "\r\n\r\n";
    client.send("GET /visual/a" + host + "GET /visual/b" + host);
    EXPECT_EQ(client.receiveAnswer().body, "a");
    EXPECT_EQ(client.receiveAnswer().body, "b");
}

TEST(PageServer, UnfinishedRequestsEnd) {
    PageServerOptions options;
    options.requestSeconds = 1;
    PageServer server(onAnyPort(options));
    WebClient silent(server.port()), slow(server.port()), kept(server.port());
    slow.send("GET / HTTP/1.1\r\nHost: local");
    EXPECT_EQ(kept.get("/").status, 200);
    for (WebClient* client : {&silent, &slow, &kept}) EXPECT_EQ(client->receiveAll(), "");
}

TEST(PageServer, AnswersThatAreNotReadEnd) {
    PageServerOptions options;
    options.connections = 1;
    options.requestSeconds = 0.5;
    PageServer server(onAnyPort(options));
    // More than the system holds for a connection.
    server.publish("large", "text/plain", std::vector<std::byte>(32 << 20));
    WebClient stuck(server.port());
    stuck.send("GET /visual/large HTTP/1.1\r\nHost: localhost:" + std::to_string(server.port()) + "\r\n\r\n");
    EXPECT_EQ(WebClient(server.port()).get("/").status, 200) << "there is room for one connection only";
    EXPECT_LT(stuck.receiveAll().size(), std::size_t{32} << 20);
}

TEST(PageServer, IdleConnectionsMakeRoomTheOldestFirst) {
    PageServerOptions options;
    options.requestSeconds = 3600;  // they do not end by themselves
    PageServer server(onAnyPort(options));
    WebClient page(server.port());
    const ClientId id = openedBy(page, server);
    std::vector<WebClient> idle;
    for (int i = 0; i < 200; ++i) idle.emplace_back(server.port());
    EXPECT_EQ(WebClient(server.port()).get("/").status, 200);
    EXPECT_EQ(idle.front().receiveAll(), "") << "it has been ended";
    EXPECT_EQ(idle.back().get("/").status, 200) << "it came late and is still there";
    server.send(id, "still here");
    EXPECT_EQ(page.receiveTextWith("here"), "still here");
}

TEST(PageServer, ConnectionsBeyondTheLimitWaitTheirTurn) {
    PageServerOptions options;
    options.connections = 4;
    options.requestSeconds = 0.5;
    PageServer server(onAnyPort(options));
    std::vector<WebClient> idle;
    for (int i = 0; i < 12; ++i) idle.emplace_back(server.port());
    EXPECT_EQ(WebClient(server.port()).get("/").status, 200);
}

}  // namespace
}  // namespace ragtop
