#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "../subcommands.h"
#include "fleet.h"
#include "ragtop/data_folder.h"
#include "ragtop/driver.h"
#include "ragtop/vehicle_file.h"

namespace ragtop {
namespace fleet {

int Course::side() const { return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(cars)))); }

/// Circles are about the crossings of streets, where there are any.
DVec3 Course::placeOf(int car) const {
    const int half = side() / 2;
    return {kApart * (car % side() - half) + static_cast<double>(kRadius), 0, kApart * (car / side() - half)};
}

float Course::wheelAngle(const VehicleDef& def) { return -std::atan(wheelbase(def) / kRadius); }

float Course::reach() const { return static_cast<float>(0.5 * kApart * (side() + 1)); }

float Course::throttleAt(float speed) { return std::clamp(0.3f * (kSpeed - speed) + 0.2f, 0.0f, 1.0f); }

double now(const Course& course) {
    if (course.processorTime) return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace fleet

namespace {

using fleet::Course;
using fleet::Result;
using Json = nlohmann::ordered_json;

struct Arguments {
    Course course;
    int runs = 5;
    bool tax = false;
    std::string json;
};

double medianOf(std::vector<double> values) {
    std::ranges::sort(values);
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

/// The run of median time, as it is.
Result middleOf(std::vector<Result> runs) {
    std::ranges::sort(runs, {}, &Result::microseconds);
    return runs[runs.size() / 2];
}

Json toJson(const Course& course, const char* engine, const Result& result) {
    Json row{{"engine", engine},
             {"cars", course.cars},
             {"ground", course.ground},
             {"level", static_cast<int>(course.level)},
             {"threads", course.threads},
             {"asleep", course.asleep},
             {"clock", course.processorTime ? "processor" : "wall"},
             {"microseconds", result.microseconds},
             {"speed", result.speed},
             {"driving", result.driving}};
    if (result.parts.empty()) return row;
    for (const auto& [name, time] : result.parts) row["parts"][name] = time;
    row["stateBytes"] = result.stateBytes;
    row["allocations"] = result.allocations;
    return row;
}

void print(const char* engine, const Course& course, const Result& result) {
    fmt::print("{:<7} {:>4} cars, level {}, {:<5} {} thread{}  {:7.2f} us per car-step   {:4.1f} m/s, {} driving\n",
               engine, course.cars, static_cast<int>(course.level), course.ground, course.threads,
               course.threads == 1 ? " " : "s", result.microseconds, result.speed, result.driving);
    if (result.parts.empty()) return;
    for (const auto& [name, time] : result.parts) fmt::print("    {:<18} {:7.3f} us\n", name, time);
    fmt::print("    {:.0f} bytes of state per car, {:.2f} allocations per step\n", result.stateBytes,
               result.allocations);
}

void write(const std::string& path, const Json& rows) {
    if (path.empty()) return;
    std::ofstream file(path, std::ios::binary);
    file << rows.dump(2) << '\n';
    if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

void printTaxes(const Arguments& arguments, const VehicleDef& def) {
    Json rows = Json::array();
    for (const fleet::Tax& tax : measureTaxes(arguments.course, def)) {
        fmt::print("{:<11} {:8.1f} us a step, {:8.1f} beside a car that takes {:5.1f}: {:+.1f} %\n", tax.others,
                   tax.without, tax.with, tax.car, 100 * tax.share());
        rows.push_back({{"others", tax.others}, {"without", tax.without}, {"with", tax.with}, {"car", tax.car}});
    }
    write(arguments.json, rows);
}

void runVehicles(const Arguments& arguments) {
    const Course& course = arguments.course;
    VehicleDef def = loadVehicle(dataFolder() / "vehicles" / "hatchback.car.json");
    def.level = course.level;
    if (arguments.tax) return printTaxes(arguments, def);
    const fleet::Terrain terrain = fleet::makeTerrain(course.ground, course.reach());
    Course peerCourse = course;
    peerCourse.threads = 1;
    std::vector<Result> own, peer;
    std::vector<double> ratios;
    for (int run = 0; run < arguments.runs; ++run) {
        own.push_back(driveRagtop(course, terrain, def));
        const std::optional<Result> other = course.asleep ? std::nullopt : driveBullet(peerCourse, terrain, def);
        if (!other) continue;
        peer.push_back(*other);
        ratios.push_back(other->microseconds / own.back().microseconds);
    }
    Json rows{toJson(course, "ragtop", middleOf(own))};
    print("ragtop", course, middleOf(own));
    if (!peer.empty()) {
        rows.push_back(toJson(peerCourse, "bullet", middleOf(peer)));
        print("bullet", peerCourse, middleOf(peer));
        fmt::print("ragtop is {:.2f} times as fast, median of {} runs in turn\n", medianOf(ratios), arguments.runs);
    }
    write(arguments.json, rows);
}

void addVehicles(CLI::App& app) {
    CLI::App* command = app.add_subcommand("vehicles", "Time cars beside Bullet's btRaycastVehicle");
    const auto arguments = std::make_shared<Arguments>();
    command->add_option("--cars", arguments->course.cars, "How many")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command->add_option("--ground", arguments->course.ground, "What they drive on")
        ->check(CLI::IsMember({"flat", "hills", "mesh", "city"}))
        ->capture_default_str();
    command
        ->add_option_function<int>(
            "--level", [arguments](int level) { arguments->course.level = static_cast<VehicleLevel>(level); },
            "Of the model of Ragtop's cars; 2 where absent")
        ->check(CLI::Range(0, 3));
    command->add_option("--threads", arguments->course.threads, "Of Ragtop; Bullet has one")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command->add_option("--runs", arguments->runs, "Of each engine, in turn; medians count")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_option("--json", arguments->json, "Write the rows to this file");
    command->add_flag("--asleep", arguments->course.asleep, "Cars that are parked and sleep");
    command->add_flag("--tax", arguments->tax, "What one car costs others that it has nothing to do with");
    command->add_flag("--processor-time", arguments->course.processorTime,
                      "Count processor time, which for one thread is right on a busy machine too");
    command->callback([arguments] { runVehicles(*arguments); });
}

const bench::Subcommand vehiclesCommand(addVehicles);

}  // namespace
}  // namespace ragtop
