#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "../support/temporary_path.h"
#include "chart/csv.h"
#include "chart/journal.h"
#include "chart/sweep.h"
#include "scenery.h"

namespace ragtop::chart {
namespace {

using stability::BodyMotion;
using stability::Engine;
using stability::Trial;

/// Falls by explicit Euler steps, so that after a second it is off by g h/2; or misbehaves.
struct Falling : Engine {
    enum class Way { well, hangs, sleeps, dies, isLost, complains, throws, cannot };
    explicit Falling(Way chosen) : way(chosen) {
        if (way == Way::cannot) throw stability::Unsupported("cannot fall");
        if (way == Way::throws) throw std::runtime_error("out of order");
    }
    void step(double dt) override {
        y += v * dt;
        v -= stability::kGravity * dt;
        while (way == Way::hangs) volatileStep();
        if (way == Way::sleeps) ::pause();
        if (way == Way::dies) ::raise(SIGSEGV);
    }
    static void volatileStep() {
        static volatile bool read;
        (void)read;
    }
    BodyMotion motion(int) const override {
        BodyMotion motion;
        motion.pose.position.y = way == Way::isLost && y < -1 ? kNone : y;
        return motion;
    }
    void setVelocity(int, const Vec3&, const Vec3&) override {}
    void push(int, const Vec3&, const DVec3&) override {}
    void remove(int) override {}
    double normalForce(int, int) const override { return 0; }
    std::string complaint() const override { return way == Way::complains && y < -1 ? "its buffer is full" : ""; }

    Way way;
    double y = 0, v = 0;
};

void fall(Trial& trial) {
    Scene scene;
    stability::add(scene, stability::solidBody(Sphere{1}, {}, 1, {}));
    stability::Run run = trial.start(scene);
    run.advance(1);
    trial.expectNear("height", run.height(0), -stability::kGravity / 2, 1, "m");
}

const stability::Case kFall{"fall", fall};
const ChartScene kScene{"fall", "A ball falls", "", "fall", {"height"}, ReferenceKind::closedForm,
                        1,      1e-6,           3,  10,     true,       ""};

Variant variantOf(Falling::Way way, const std::string& name) {
    Variant variant{"test", name, "1.0", "", {1.0 / 64, 1, 0}, {1}, {0}, true, {}};
    variant.make = [way](const Scene&, const Setting&) { return std::make_unique<Falling>(way); };
    return variant;
}

std::vector<Task> tasksOf(const std::vector<Variant>& variants, const std::vector<int>& rates = {64, 128}) {
    std::vector<Task> tasks;
    for (const Variant& variant : variants)
        for (const int rate : rates)
            tasks.push_back({&kScene, &kFall, &variant, pointOf(kScene, variant, {1.0 / rate, 1, 0}, {})});
    return tasks;
}

Points swept(const std::vector<Variant>& variants, SweepOptions options = {}) {
    return sweep(tasksOf(variants), options, [](const Point&) {});
}

std::string without(Points points) {
    for (Point& point : points) {
        point.alone = true;
        point.cpuMs = point.cpuMsLow = point.cpuMsHigh = kNone;
    }
    return toCsv(points);
}

std::string contentOf(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::string messageOf(const std::function<void()>& work) {
    try {
        work();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "nothing is wrong";
}

TEST(ChartSweep, MeasuresTheErrorOfAFirstOrderMethod) {
    const std::vector<Variant> variants{variantOf(Falling::Way::well, "well")};
    Points points = swept(variants);
    addSelfConsistency(points);
    ASSERT_EQ(points.size(), 2u);
    for (const Point& point : points) {
        EXPECT_EQ(point.outcome, Outcome::measured) << point.reason;
        EXPECT_NEAR(point.error, stability::kGravity * point.setting.step / 2, 1e-9);
        EXPECT_GT(point.cpuMs, 0);
    }
    EXPECT_TRUE(points[0].isDefault);
    EXPECT_NEAR(points[0].selfConsistency, points[0].error - points[1].error, 1e-9);
    EXPECT_TRUE(std::isnan(points[1].selfConsistency));
}

TEST(ChartSweep, TakesAnEngineThatFailsForAFailedPointAndGoesOn) {
    using Way = Falling::Way;
    const std::vector<Variant> variants{variantOf(Way::dies, "dies"),           variantOf(Way::isLost, "lost"),
                                        variantOf(Way::complains, "complains"), variantOf(Way::throws, "throws"),
                                        variantOf(Way::cannot, "cannot"),       variantOf(Way::well, "well")};
    const Points points = swept(variants);
    ASSERT_EQ(points.size(), 12u);
    const auto reasonOf = [&](std::size_t i) { return points[2 * i].reason; };
    EXPECT_EQ(reasonOf(0), "Segmentation fault");
    EXPECT_EQ(reasonOf(1), "body 0 is nowhere after 0.469 s");
    EXPECT_NEAR(points[2].failedAt, 0.469, 0.001);
    EXPECT_EQ(reasonOf(2), "its buffer is full");
    EXPECT_EQ(reasonOf(3), "out of order");
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(points[i].outcome, Outcome::failed);
    EXPECT_EQ(points[8].outcome, Outcome::unsupported);
    EXPECT_EQ(points[9].outcome, Outcome::unsupported);
    EXPECT_EQ(reasonOf(4), "cannot fall");
    EXPECT_EQ(points[11].outcome, Outcome::measured);
}

TEST(ChartSweep, EndsAnEngineThatTakesTooLong) {
    const std::vector<Variant> variants{variantOf(Falling::Way::hangs, "hangs"), variantOf(Falling::Way::well, "well")};
    SweepOptions options;
    options.limit = 1;
    const Points points = sweep(tasksOf(variants, {64}), options, [](const Point&) {});
    EXPECT_EQ(points[0].outcome, Outcome::failed);
    EXPECT_EQ(points[0].reason, "took longer than its 1 s");
    EXPECT_EQ(points[1].outcome, Outcome::measured);
}

TEST(ChartSweep, EndsAnEngineThatSleepsForEver) {
    const std::vector<Variant> variants{variantOf(Falling::Way::sleeps, "sleeps"),
                                        variantOf(Falling::Way::well, "well")};
    SweepOptions options;
    options.limit = 0.1;
    options.patience = 0.5;
    const Points points = sweep(tasksOf(variants, {64}), options, [](const Point&) {});
    EXPECT_EQ(points[0].outcome, Outcome::failed);
    EXPECT_EQ(points[0].reason, "took longer than its 1 s");
    EXPECT_EQ(points[1].outcome, Outcome::measured);
}

TEST(ChartJournal, GoesOnToTheSamePointsWhereverItWasCutOff) {
    const std::filesystem::path file = temporaryPath("journal");
    const std::vector<Variant> variants{variantOf(Falling::Way::well, "well"), variantOf(Falling::Way::isLost, "lost")};
    SweepOptions options;
    options.journal = file;
    const std::string whole = without(swept(variants, options));
    const std::string journal = contentOf(file);
    options.resume = true;
    for (std::size_t length = 0; length <= journal.size(); length += 97) {
        std::ofstream(file, std::ios::binary) << journal.substr(0, length);
        EXPECT_EQ(without(swept(variants, options)), whole) << length << " bytes were left";
    }
}

TEST(ChartJournal, IsNotTakenForThatOfAnotherSweep) {
    SweepOptions options;
    options.journal = temporaryPath("journal");
    swept({variantOf(Falling::Way::well, "well")}, options);
    options.resume = true;
    EXPECT_EQ(messageOf([&] { swept({variantOf(Falling::Way::well, "other")}, options); }),
              options.journal->string() + ":1: is of another sweep; go on with its options, or leave out --resume");
}

TEST(ChartJournal, SaysWhereItCannotBeWritten) {
    SweepOptions options;
    options.journal = "/dev/null/journal";
    EXPECT_EQ(messageOf([&] { swept({variantOf(Falling::Way::well, "well")}, options); }),
              "/dev/null/journal: cannot be written: Not a directory");
}

TEST(ChartJournal, MeasuresAnewWhatOthersDisturbedWhereItIsAsked) {
    const std::filesystem::path file = temporaryPath("journal");
    const std::vector<Variant> variants{variantOf(Falling::Way::well, "well")};
    SweepOptions options;
    options.journal = file;
    options.jobs = 2;  // which marks all points as disturbed
    swept(variants, options);
    options.jobs = 1;
    options.resume = true;
    const auto measured = [&] {
        int count = 0;
        sweep(tasksOf(variants), options, [&](const Point&) { ++count; });
        return count;
    };
    EXPECT_EQ(measured(), 0);
    options.again = true;
    EXPECT_EQ(measured(), 2);
}

TEST(ChartJournal, SaysThatTheDiskIsFull) {
    SweepOptions options;
    options.journal = temporaryPath("journal");
    const std::filesystem::path draft = options.journal->string() + ".part";
    std::filesystem::create_symlink("/dev/full", draft);
    EXPECT_EQ(messageOf([&] { swept({variantOf(Falling::Way::well, "well")}, options); }),
              options.journal->string() + ": cannot be written: No space left on device");
    EXPECT_FALSE(std::filesystem::is_symlink(draft));
}

TEST(ChartCsv, KeepsEveryBitOfAPoint) {
    Points points = swept({variantOf(Falling::Way::well, "well"), variantOf(Falling::Way::isLost, "lost")});
    points[0].reason = "says \"no\", and more";
    const std::filesystem::path file = temporaryPath("chart.csv");
    writeWhole(file, toCsv(points));
    const Points read = readCsv(file);
    EXPECT_EQ(toCsv(read), toCsv(points));
    EXPECT_EQ(read[0].reason, points[0].reason);
    EXPECT_EQ(read[0].error, points[0].error);
}

TEST(ChartCsv, IsRefusedWhereItIsCutOffOrOfAnotherVersion) {
    const std::string text = toCsv(swept({variantOf(Falling::Way::well, "well")}));
    const std::filesystem::path file = temporaryPath("chart.csv");
    const auto messageAbout = [&](const std::string& content) {
        std::ofstream(file, std::ios::binary) << content;
        const std::string message = messageOf([&] { readCsv(file); }), start = file.string() + ":";
        EXPECT_TRUE(message.starts_with(start)) << message;
        return message.substr(std::min(message.size(), start.size()));
    };
    EXPECT_EQ(messageAbout(""), "1: does not begin with the columns of ragtop-chart-1");
    EXPECT_EQ(messageAbout(text.substr(0, text.size() - 1)), "3: is cut off");
    const std::size_t lastLine = text.rfind('\n', text.size() - 2) + 1;
    EXPECT_EQ(messageAbout(text.substr(0, lastLine)), " is cut off after 1 of 2 points");
    std::string other = text;
    other.replace(lastLine, 14, "ragtop-chart-2");
    EXPECT_EQ(messageAbout(other), "3: schema is \"ragtop-chart-2\", must be ragtop-chart-1");
    std::string broken = text;
    broken.replace(text.find(",0.015625,"), 10, ",quickly,");
    EXPECT_EQ(messageAbout(broken), "2: step_s is \"quickly\", must be a number or empty");
}

}  // namespace
}  // namespace ragtop::chart
