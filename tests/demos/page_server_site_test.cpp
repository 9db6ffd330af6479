#include "serve/page_site.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "support/temporary_path.h"

namespace ragtop {
namespace {

WebRequest requestFor(const std::string& target) {
    return {.method = "GET", .target = target, .hosts = {"localhost:8080"}, .origins = {}};
}

WebRequest upgradeFrom(const std::vector<std::string>& origins) {
    WebRequest request = requestFor("/live");
    request.upgrade = true;
    request.origins = origins;
    return request;
}

std::string bodyOf(const WebAnswer& answer) {
    return {reinterpret_cast<const char*>(answer.body->data()), answer.body->size()};
}

class Site : public testing::Test {
protected:
    int statusOf(const WebRequest& request) const { return site.answer(request, 8080).status; }
    PageSite site{std::filesystem::path{}, 100};
};

TEST_F(Site, WithoutAPageItTellsHowToBuildOne) {
    const WebAnswer answer = site.answer(requestFor("/"), 8080);
    EXPECT_EQ(answer.status, 200);
    EXPECT_NE(bodyOf(answer).find("scripts/page.sh build"), std::string::npos);
}

TEST_F(Site, PageThatCannotBeReadIsAnErrorThatNamesIt) {
    try {
        PageSite("/no/such/page.html", 0);
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("/no/such/page.html"), std::string::npos);
    }
}

TEST_F(Site, OnlyRequestsThatNameThisServerAreAnswered) {
    for (const char* host : {"localhost:8080", "LOCALHOST:8080", "127.0.0.1:8080"}) {
        WebRequest request = requestFor("/");
        request.hosts = {host};
        EXPECT_EQ(statusOf(request), 200) << host;
    }
    for (const char* host :
         {"", "localhost", "localhost:80", "localhost:8080.evil.example", "evil.example:8080", "evil.example",
          "127.0.0.1", "127.0.0.2:8080", "[::1]:8080", "localhost:8080 ", "user@localhost:8080", "0.0.0.0:8080"}) {
        WebRequest request = requestFor("/");
        request.hosts = {host};
        EXPECT_EQ(statusOf(request), 403) << host;
    }
    WebRequest request = requestFor("/");
    request.hosts = {};
    EXPECT_EQ(statusOf(request), 403);
    request.hosts = {"localhost:8080", "localhost:8080"};
    EXPECT_EQ(statusOf(request), 403);
}

TEST_F(Site, PortMayBeLeftOutOnlyWhereItIsTheDefault) {
    WebRequest request = requestFor("/");
    request.hosts = {"localhost"};
    EXPECT_EQ(site.answer(request, 80).status, 200);
}

TEST_F(Site, OnlyOwnPagesAndNativeProgramsMayConnect) {
    EXPECT_EQ(statusOf(upgradeFrom({})), 101);
    for (const char* origin : {"http://localhost:8080", "http://127.0.0.1:8080"}) {
        EXPECT_EQ(statusOf(upgradeFrom({origin})), 101) << origin;
    }
    for (const char* origin : {"", "null", "http://evil.example", "http://localhost", "https://localhost:8080",
                               "http://localhost:8081", "http://localhost:8080.evil.example", "file://",
                               "http://localhost:8080/", "localhost:8080", "http://[::1]:8080"}) {
        EXPECT_EQ(statusOf(upgradeFrom({origin})), 403) << origin;
    }
    EXPECT_EQ(statusOf(upgradeFrom({"http://localhost:8080", "http://localhost:8080"})), 403);
}

TEST_F(Site, NothingButGetIsAnswered) {
    for (const char* method : {"POST", "PUT", "HEAD", "DELETE", "OPTIONS", "TRACE", "CONNECT", "get", ""}) {
        WebRequest request = requestFor("/");
        request.method = method;
        EXPECT_EQ(statusOf(request), 405) << method;
    }
    WebRequest request = requestFor("/");
    request.body = true;
    EXPECT_EQ(statusOf(request), 413);
}

TEST_F(Site, LiveIsForWebSocketsOnly) {
    EXPECT_EQ(statusOf(requestFor("/live")), 426);
    WebRequest request = upgradeFrom({});
    request.target = "/";
    EXPECT_EQ(statusOf(request), 200) << "an offer to upgrade may be ignored";
}

TEST_F(Site, PublishedFilesAreFoundByTheirExactNameAlone) {
    site.publish("car.glb", "model/gltf-binary", {std::byte{1}, std::byte{2}});
    const WebAnswer answer = site.answer(requestFor("/visual/car.glb"), 8080);
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.mime, "model/gltf-binary");
    EXPECT_EQ(bodyOf(answer), "\1\2");
    EXPECT_EQ(statusOf(requestFor("/visual/car.glb?version=2")), 200);
    for (const char* target : {"/visual/",
                               "/visual",
                               "/visual/car",
                               "/visual/Car.glb",
                               "/visual//car.glb",
                               "/visual/./car.glb",
                               "/visual/../visual/car.glb",
                               "/visual/%63ar.glb",
                               "visual/car.glb",
                               "",
                               "*",
                               "/index.html",
                               "//",
                               "/visual/../../../../etc/passwd",
                               "/visual/..%2f..%2fetc%2fpasswd",
                               "/visual/\\..\\etc\\passwd",
                               "/etc/passwd",
                               "http://localhost:8080/visual/car.glb",
                               "file:///etc/passwd",
                               "/live/",
                               "/visual/car.glb#x"}) {
        EXPECT_EQ(statusOf(requestFor(target)), 404) << target;
    }
}

TEST_F(Site, PublishingAgainReplaces) {
    site.publish("car.glb", "model/gltf-binary", {std::byte{1}});
    site.publish("car.glb", "image/png", {});
    EXPECT_EQ(site.answer(requestFor("/visual/car.glb"), 8080).mime, "image/png");
    EXPECT_EQ(bodyOf(site.answer(requestFor("/visual/car.glb"), 8080)), "");
}

TEST_F(Site, OldFilesMakeRoomForNewOnes) {
    const auto status = [&](const char* name) { return statusOf(requestFor(std::string("/visual/") + name)); };
    site.publish("a", "text/plain", std::vector<std::byte>(40));
    site.publish("b", "text/plain", std::vector<std::byte>(40));
    site.publish("a", "text/plain", std::vector<std::byte>(60));
    EXPECT_EQ(status("b"), 200) << "there is room for both";
    site.publish("c", "text/plain", std::vector<std::byte>(30));
    EXPECT_EQ(status("a"), 200) << "b was published before it";
    EXPECT_EQ(status("b"), 404);
    EXPECT_EQ(status("c"), 200);
    EXPECT_THROW(site.publish("d", "text/plain", std::vector<std::byte>(101)), std::invalid_argument);
    EXPECT_EQ(status("a"), 200);
    site.publish("d", "text/plain", std::vector<std::byte>(100));
    EXPECT_EQ(status("d"), 200);
    EXPECT_EQ(status("c"), 404);
    EXPECT_EQ(statusOf(requestFor("/")), 200);
}

TEST_F(Site, NamesAndTypesThatCouldBeMisreadAreRefused) {
    for (const char* name : {"", "a/b", "../a", "a b", "a%2fb", "a?b", "a\r\nb", "\xc3\xa4"}) {
        EXPECT_THROW(site.publish(name, "text/plain", {}), std::invalid_argument) << name;
    }
    for (const char* mime : {"", "text/plain\r\nSet-Cookie: a=b", "\xc3\xa4"}) {
        EXPECT_THROW(site.publish("a", mime, {}), std::invalid_argument) << mime;
    }
}

TEST_F(Site, GivesThePageAsItIs) {
    const auto path = temporaryPath("page.html");
    const std::string html("<p>\0\xff\r\n", 7);
    std::ofstream(path, std::ios::binary) << html;
    const PageSite own(path, 0);
    std::filesystem::remove(path);
    EXPECT_EQ(bodyOf(own.answer(requestFor("/"), 8080)), html);
    EXPECT_EQ(bodyOf(own.answer(requestFor("/?scene=crash"), 8080)), html);
}

}  // namespace
}  // namespace ragtop
