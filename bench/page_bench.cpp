#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <thread>
#include <vector>

#include "../tests/demos/web_client.h"
#include "ragtop/serve.h"
#include "ragtop/world.h"
#include "subcommands.h"

/// What it costs to show a world of moving bodies to pages that read all they get, and how evenly they get it.
namespace ragtop::bench {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
    double seconds = 60;
    int bodies = 2000;
    double rate = 60;
};

double cpuSeconds(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The largest time between two of its events.
class Gap {
public:
    void mark() {
        const Clock::time_point now = Clock::now();
        if (count_++ > 0) largest_ = std::max(largest_, std::chrono::duration<double>(now - last_).count());
        last_ = now;
    }
    double milliseconds() const { return 1e3 * largest_; }
    int count() const { return count_; }

private:
    Clock::time_point last_;
    double largest_ = 0;
    int count_ = 0;
};

/// A page that reads all it gets, until the connection ends.
struct Reader {
    explicit Reader(int port) : client(port), thread([this] { read(); }) {}

    void read() {
        client.open();
        for (auto message = client.receive(); message; message = client.receive()) {
            bytes += message->payload.size();
            if (message->opcode == WebClient::kBinary) gap.mark();
        }
        cpu = cpuSeconds(CLOCK_THREAD_CPUTIME_ID);
    }

    WebClient client;
    Gap gap;  // between frames; only those of poses are sent while nothing is drawn for debugging
    std::size_t bytes = 0;
    double cpu = 0;
    std::jthread thread;
};

/// Bodies that fly about and never meet, so that every pose changes in every step, and steps cost little.
World flyingBodies(int count) {
    WorldSettings settings;
    settings.gravity = {};
    settings.sleeping = false;
    World world(settings);
    for (int i = 0; i < count; ++i) {
        const float turn = 1 + 0.01f * static_cast<float>(i % 100);
        BodyDef def;
        def.shapes.resize(1);
        def.shapes[0].geometry = Box{{0.1f, 0.2f, 0.3f}};
        def.pose.position = {5.0 * (i % 50), 5.0 * (i / 50), 0};
        def.linearVelocity = {0, 0, turn};
        def.angularVelocity = {turn, -turn, 0.3f};
        world.create(def);
    }
    return world;
}

struct Result {
    double wall, simulation, network, stepping;  // s
    std::uint64_t steps;
};

/// The cost of the steps themselves is taken from a world that is the same and is not shown, stepped in turn with it.
Result measure(const Options& options, std::vector<std::unique_ptr<Reader>>& readers, int pages) {
    World world = flyingBodies(options.bodies), twin = flyingBodies(options.bodies);
    auto view = std::make_unique<PageView>(world, ServeOptions{.port = 0, .step = 1 / options.rate});
    for (int i = 0; i < pages; ++i) readers.push_back(std::make_unique<Reader>(view->port()));
    const double processBefore = cpuSeconds(CLOCK_PROCESS_CPUTIME_ID);
    const double threadBefore = cpuSeconds(CLOCK_THREAD_CPUTIME_ID);
    double stepping = 0;
    const Clock::time_point start = Clock::now();
    const auto wall = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    while (wall() < options.seconds) {
        view->updateAndWait();
        const double before = cpuSeconds(CLOCK_THREAD_CPUTIME_ID);
        while (twin.stepCount() < world.stepCount()) twin.step(1 / options.rate);
        stepping += cpuSeconds(CLOCK_THREAD_CPUTIME_ID) - before;
    }
    const double seconds = wall();
    view.reset();
    double reading = 0;
    for (const auto& reader : readers) {
        reader->thread.join();
        reading += reader->cpu;
    }
    const double own = cpuSeconds(CLOCK_THREAD_CPUTIME_ID) - threadBefore;
    const double network = cpuSeconds(CLOCK_PROCESS_CPUTIME_ID) - processBefore - own - reading;
    return {seconds, own - 2 * stepping, network, stepping, world.stepCount()};
}

void measurePages(int pages, const Options& options) {
    std::vector<std::unique_ptr<Reader>> readers;
    const Result result = measure(options, readers, pages);
    const auto share = [&](double seconds) { return 100 * seconds / result.wall; };
    fmt::print(
        "{} page{}: {:.2f} % of a core to serve: {:.2f} % in the simulation's thread, {:.2f} % in the network's "
        "(the steps: {:.2f} %)\n",
        pages, pages == 1 ? "" : "s", share(result.simulation + result.network), share(result.simulation),
        share(result.network), share(result.stepping));
    for (const auto& reader : readers) {
        fmt::print("  {} frames of {} steps, {:.1f} MB/s, largest gap {:.1f} ms\n", reader->gap.count(), result.steps,
                   1e-6 * static_cast<double>(reader->bytes) / result.wall, reader->gap.milliseconds());
    }
}

void addPage(CLI::App& app) {
    CLI::App* page = app.add_subcommand("page", "Cost and evenness of showing moving bodies to one page and to two");
    const auto options = std::make_shared<Options>();
    page->add_option("--seconds", options->seconds, "How long for each number of pages, s")
        ->check(CLI::Range(0.1, 1e5))
        ->capture_default_str();
    page->add_option("--bodies", options->bodies, "All moving")->check(CLI::Range(1, 1000000))->capture_default_str();
    page->add_option("--rate", options->rate, "Steps, and frames, per second")
        ->check(CLI::Range(1.0, 1000.0))
        ->capture_default_str();
    page->callback([options] {
        double load = 0;
        getloadavg(&load, 1);
        fmt::print(
            "{} moving bodies, {:g} frames/s for {:g} s; gaps mean something while the load ({:.1f}) is below the "
            "number of processors ({})\n",
            options->bodies, options->rate, options->seconds, load, std::thread::hardware_concurrency());
        for (const int pages : {1, 2}) measurePages(pages, *options);
    });
}

const Subcommand page(addPage);

}  // namespace
}  // namespace ragtop::bench
