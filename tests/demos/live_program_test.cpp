#include "serve/live_program.h"

#include <gtest/gtest.h>

#include "live_support.h"
#include "ragtop/vehicle_file.h"

namespace ragtop::live {
namespace {

struct Wind {
    float speed = 0;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const Wind*) {
    visit(Tunable{"speed", "m/s", -30, 30, "along x"}, self.speed);
}

/// A program with a box in the wind and a car.
class Program : public SessionTest {
protected:
    Program() : car_((ground(), world_), hatchback(), {.position = {10, 0, 0}}) {
        box_ = world_.create(DynamicBody{.shape = Box{{0.5f, 0.5f, 0.5f}}, .density = 100, .position = {0, 0.5, 0}});
        options_.name = "windy";
        options_.nameOf = [this](BodyId body) { return body == box_ ? "box" : ""; };
        options_.colorOf = [](BodyId) { return Color{0x123456}; };
        options_.vehicles.push_back({"car", &car_, {.position = {10, 0, 0}}});
        addTunables(wind_, "wind", "wind", options_.tunables);
        options_.beforeStep = [this](double) {
            world_.applyForce(box_, {100 * wind_.speed, 0, 0}, world_.centerOfMass(box_));
            car_.input.throttle = 0.3f;
        };
    }
    ~Program() override { session_.reset(); }

    void ground() { world_.create(StaticBody{.shape = Box{{100, 1, 100}}, .position = {0, -1, 0}}); }
    static VehicleDef hatchback() { return loadVehicle(dataFile("vehicles/hatchback.car.json")); }
    void serveIt() {
        session_ = std::make_unique<Session>(std::make_unique<LiveProgram>(world_, options_), pages_.outlet(),
                                             SessionOptions{.playing = false});
        session_->join(kPage);
    }

    World world_;
    Wind wind_;
    Vehicle car_;
    BodyId box_;
    ServeOptions options_;
};

TEST_F(Program, IsShownAsItSays) {
    serveIt();
    const Json scene = pages_.last(kPage, "scene");
    EXPECT_EQ(scene["name"], "windy");
    const std::uint32_t box = nodeNamed("box");
    EXPECT_EQ(scene["nodes"][box]["color"], 0x123456);
    EXPECT_EQ(scene["vehicles"][0]["name"], "car");
    EXPECT_TRUE(pages_.last(kPage, "hello")["scenes"].empty());
    const Json last = scene["tunables"].back();
    EXPECT_EQ(last["path"], "wind.speed");
    EXPECT_EQ(last["unit"], "m/s");
    EXPECT_EQ(last["max"], 30);
}

TEST_F(Program, ItsNumbersAreTunedAndGoBackWithTheWorld) {
    serveIt();
    steps(30);
    EXPECT_NEAR(world_.pose(box_).position.x, 0, 1e-3);
    expectOk({{"do", "tune"}, {"path", "wind.speed"}, {"value", 20}});
    EXPECT_EQ(wind_.speed, 20);
    steps(60);
    const double blown = world_.pose(box_).position.x;
    EXPECT_GT(blown, 1);
    const std::string there = hash();
    expectOk({{"do", "seek"}, {"step", 10}});
    EXPECT_EQ(wind_.speed, 0);
    expectOk({{"do", "seek"}, {"step", 90}});
    EXPECT_EQ(wind_.speed, 20);
    EXPECT_EQ(hash(), there);
    EXPECT_EQ(errorOf({{"do", "tune"}, {"path", "wind.speed"}, {"value", 31}}),
              "tune: wind.speed is 31, must be a number in [-30, 30] m/s");
}

TEST_F(Program, ResetGoesToItsFirstStateWithWhatIsTuned) {
    for (int i = 0; i < 7; ++i) world_.step(1.0 / 60);
    serveIt();
    const std::string first = hash();
    expectOk({{"do", "tune"}, {"path", "wind.speed"}, {"value", 20}});
    steps(60);
    expectOk({{"do", "reset"}});
    EXPECT_EQ(session_->live().now(), 7u);
    EXPECT_EQ(wind_.speed, 20);
    expectOk({{"do", "untune"}, {"path", "wind.speed"}});
    EXPECT_EQ(hash(), first);
}

TEST_F(Program, WhoDrivesIsNotOverruled) {
    serveIt();
    steps(60);
    EXPECT_EQ(car_.input.throttle, 0.3f);
    expectOk({{"do", "drive"}, {"vehicle", 0}, {"brake", 1}});
    steps(120);
    EXPECT_EQ(car_.input.throttle, 0);
    EXPECT_LT(std::abs(car_.telemetry().speed), 0.1f);
    expectOk({{"do", "tune"}, {"path", "vehicles.car.chassis.mass"}, {"value", 900}});
    EXPECT_EQ(car_.def().chassis.mass, 900);
}

TEST_F(Program, HasNoFiles) {
    serveIt();
    EXPECT_NE(errorOf({{"do", "saveTuning"}}), "");
    EXPECT_NE(errorOf({{"do", "loadTuning"}, {"name", "x"}}), "");
    EXPECT_NE(errorOf({{"do", "load"}, {"scene", "crash"}}), "");
}

TEST_F(Program, BadOptionsAreRefused) {
    options_.step = 0;
    EXPECT_THROW(LiveProgram(world_, options_), std::invalid_argument);
    options_.step = 1.0 / 60;
    options_.vehicles[0].vehicle = nullptr;
    EXPECT_THROW(LiveProgram(world_, options_), std::invalid_argument);
}

TEST_F(Program, ServesItselfOnAPortOfItsOwn) {
    options_.port = 0;
    PageView view(world_, options_);
    EXPECT_GT(view.port(), 0);
    EXPECT_EQ(view.url(), "http://127.0.0.1:" + std::to_string(view.port()) + "/");
    ServeOptions same = options_;
    same.port = view.port();
    World other;
    EXPECT_THROW(PageView(other, {.port = view.port()}), std::runtime_error);
    view.update();
    EXPECT_EQ(world_.stepCount(), 0u);
    EXPECT_THROW(PageView(other, {.page = "/no/such/file.html"}), AssetError);
}

TEST_F(Program, ServingEndsWhenItIsToldTo) {
    std::stop_source stop;
    options_.port = 0;
    options_.stop = stop.get_token();
    stop.request_stop();
    serve(world_, options_);
}

}  // namespace
}  // namespace ragtop::live
