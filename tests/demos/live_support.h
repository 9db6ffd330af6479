#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "serve/live_scene.h"
#include "serve/session.h"
#include "support/temporary_path.h"

namespace ragtop::live {

/// A folder of the test's own that goes away with it.
class TemporaryFolder {
public:
    TemporaryFolder() {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        path_ = temporaryPath(std::string(test->test_suite_name()) + "_" + test->name());
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }

    std::filesystem::path write(const std::string& name, const std::string& text) const {
        std::ofstream(path_ / name) << text;
        return path_ / name;
    }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

inline std::string dataFile(const std::string& name) { return std::string(RAGTOP_SOURCE_DIR) + "/assets/data/" + name; }

/// Bricks on a floor, and a car that stands beside them.
inline std::string yard() {
    return R"({
  "description": "bricks and a car",
  "materials": {"brick": {"friction": 0.6}},
  "bodies": [{"name": "ground", "type": "fixed", "shape": {"box": {"halfExtents": [100, 1, 100]}}, "position": [0, -1, 0]}],
  "walls": [{"name": "brick", "position": [0, 0, 10], "courses": 4, "bricks": 5, "material": "brick"}],
  "vehicles": [{"name": "car", "file": ")" +
           dataFile("vehicles/hatchback.car.json") + R"(", "position": [4, 0, 0]}],
  "ragdolls": [{"name": "person", "file": ")" +
           dataFile("ragdolls/mannequin.ragdoll.json") + R"(", "position": [-4, 0.2, 4]}]
})";
}

/// What a session has told its pages.
struct Pages {
    std::map<ClientId, std::vector<Json>> texts;
    std::map<ClientId, std::vector<FrameBytes>> frames;
    std::map<std::string, std::size_t> published;
    std::map<ClientId, bool> slow;

    Outlet outlet() {
        Outlet outlet;
        outlet.send = [this](ClientId client, std::string text) { texts[client].push_back(Json::parse(text)); };
        outlet.sendFrame = [this](ClientId client, FrameBytes frame) { frames[client].push_back(std::move(frame)); };
        outlet.ready = [this](ClientId client) { return !slow[client]; };
        outlet.publish = [this](const std::string& name, const std::string&, std::vector<std::byte> bytes) {
            published[name] = bytes.size();
        };
        return outlet;
    }
    /// The latest message of a type; null: none.
    Json last(ClientId client, const std::string& type) const {
        Json found;
        const auto page = texts.find(client);
        if (page == texts.end()) return found;
        for (const Json& message : page->second) {
            if (message["type"] == type) found = message;
        }
        return found;
    }
};

/// A session with one page, driven by hand.
class SessionTest : public testing::Test {
protected:
    static constexpr ClientId kPage = 7;

    void open(const std::string& scene, LiveSceneOptions options = {.visuals = false}) {
        options.tunings = folder_ / "tuning";
        session_ = std::make_unique<Session>(std::make_unique<LiveScene>(scene, options), pages_.outlet(),
                                             SessionOptions{.playing = false});
        session_->join(kPage);
    }
    void openYard() { open(folder_.write("yard.json", yard()).string()); }

    /// Sends a message with an id and returns the answer.
    Json ask(Json message, ClientId page = kPage) {
        message["id"] = ++id_;
        session_->receive(page, text(message));
        session_->advance(0);
        const Json answer = pages_.last(page, "re");
        EXPECT_EQ(answer.value("re", -1), id_) << text(message);
        return answer;
    }
    Json expectOk(const Json& message) {
        const Json answer = ask(message);
        EXPECT_TRUE(answer.value("ok", false)) << text(message) << " -> " << text(answer);
        return answer;
    }
    std::string errorOf(const Json& message) {
        const Json answer = ask(message);
        EXPECT_FALSE(answer.value("ok", true)) << text(message);
        return answer.value("error", "");
    }
    void steps(int count) {
        for (; count > 600; count -= 600) expectOk({{"do", "step"}, {"count", 600}});
        expectOk({{"do", "step"}, {"count", count}});
    }
    std::string hash() { return expectOk({{"do", "hash"}})["hash"].get<std::string>(); }
    World& world() { return *session_->stage().cast().world; }
    std::uint32_t nodeNamed(const std::string& name) const {
        const Json scene = pages_.last(kPage, "scene");
        for (const Json& node : scene["nodes"]) {
            if (node["name"] == name) return node["node"].get<std::uint32_t>();
        }
        ADD_FAILURE() << "no node is called " << name;
        return 0;
    }
    const Vehicle& car() { return *session_->stage().cast().vehicles.at(0).vehicle; }

    TemporaryFolder folder_;
    Pages pages_;
    std::unique_ptr<Session> session_;
    int id_ = 0;
};

}  // namespace ragtop::live
