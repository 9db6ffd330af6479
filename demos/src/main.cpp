#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <exception>
#include <string>
#include <vector>

#include "cook_command.h"
#include "drive.h"
#include "fit_command.h"
#include "inspect.h"
#include "ragdoll_command.h"
#include "ragtop/data_folder.h"
#include "ragtop/scene.h"
#include "run.h"
#include "serve/serve_scene.h"

namespace {

using namespace ragtop;

constexpr int kFailed = 1, kBadInput = 2;

/// Splits "key=value"; throws CLI::ValidationError, which is a usage error, where there is no key.
std::vector<SceneOverride> parseOverrides(const std::vector<std::string>& texts) {
    std::vector<SceneOverride> overrides;
    for (const std::string& text : texts) {
        const auto equals = text.find('=');
        if (equals == std::string::npos || equals == 0) {
            throw CLI::ValidationError("--set", "is \"" + text + "\", must be key=value");
        }
        overrides.push_back({text.substr(0, equals), text.substr(equals + 1)});
    }
    return overrides;
}

void list() {
    dataFolder();  // or tells where it has looked
    std::size_t width = 0;
    for (const std::string& name : shippedScenes()) width = std::max(width, name.size());
    for (const std::string& name : shippedScenes()) {
        fmt::print("{:{}}  {}\n", name, width, sceneDescription(findScene(name)));
    }
}

/// Ends the serving; a second signal kills as usual.
volatile std::sig_atomic_t signalled = 0;
extern "C" void endServing(int signal) {
    signalled = 1;
    std::signal(signal, SIG_DFL);
}

void serve(const live::ServeSceneOptions& options) {
    std::signal(SIGINT, endServing);
    std::signal(SIGTERM, endServing);
    live::serveScene(options, [] { return signalled != 0; });
}

struct Command {
    demos::RunOptions run;
    live::ServeSceneOptions serve;
    demos::DriveOptions drive;
    demos::RagdollCommand ragdoll;
    demos::FitCommand fit;
    demos::CookCommand cook;
    std::vector<std::string> settings;
    std::string asset;
    bool json = false;
};

CLI::App* addRun(CLI::App& app, Command& command) {
    CLI::App* run = app.add_subcommand("run", "Run a scene and print what it came to");
    run->add_option("scene", command.run.scene, "Name of a scene (see list) or a scene file")->required();
    run->add_option("--seconds", command.run.seconds, "Simulated time instead of the scene's duration, s")
        ->check(CLI::Range(0.0, 1e6));
    run->add_option("--steps", command.run.steps, "Number of the last step")->check(CLI::Range(0, 1000000000));
    run->add_option("--threads", command.run.threads, "Threads that solve")->check(CLI::Range(1, 64));
    run->add_option("--lanes", command.run.lanes, "Width of the solver; 0 is the machine's best")
        ->check(CLI::IsMember({0, 4, 8, 16}));
    run->add_option("--set", command.settings, "key=value: a setting of the world, or a path in the scene file")
        ->take_all();
    run->add_option("--save-at", command.run.saveAt, "Write the state after this step to state_STEP.bin");
    run->add_option("--restore", command.run.restore, "Go on from a state that --save-at wrote");
    run->add_option("--poses", command.run.poses, "Write the poses of all bodies, once a second, to this CSV file");
    run->add_option("--out", command.run.out, "Folder for recording.glb, telemetry.csv, summary.json and states");
    return run;
}

CLI::App* addServe(CLI::App& app, Command& command) {
    live::ServeSceneOptions& options = command.serve;
    CLI::App* serve = app.add_subcommand("serve", "Run a scene in real time and show it in a browser");
    serve->add_option("scene", options.scene, "Name of a scene (see list) or a scene file")->capture_default_str();
    serve->add_option("--port", options.port, "On 127.0.0.1; 0 takes any free one")
        ->check(CLI::Range(0, 65535))
        ->capture_default_str();
    serve->add_option("--page", options.page, "The page's HTML file instead of the one that comes along");
    serve->add_option("--threads", options.world.threads, "Threads that solve")->check(CLI::Range(1, 64));
    serve->add_option("--lanes", options.world.lanes, "Width of the solver; 0 is the machine's best")
        ->check(CLI::IsMember({0, 4, 8, 16}));
    serve->add_option("--set", command.settings, "key=value: a setting of the world, or a path in the scene file")
        ->take_all();
    serve->add_option("--tuning", options.world.tunings, "Folder of saved tunings")->capture_default_str();
    return serve;
}

CLI::App* addDrive(CLI::App& app, Command& command) {
    demos::DriveOptions& options = command.drive;
    CLI::App* drive = app.add_subcommand("drive", "Put a car through manoeuvres and tell what was measured");
    drive->add_option("car", options.car, "Name of a car that comes with ragtop or a vehicle file")->required();
    drive->add_option("--manoeuvre", options.manoeuvre, "Name or file of a manoeuvre, or all")->capture_default_str();
    drive->add_option("--hz", options.hz, "Steps per second")->check(CLI::Range(10.0, 10000.0))->capture_default_str();
    drive->add_option("--level", options.level, "Of the car's model, instead of its own")->check(CLI::Range(0, 3));
    drive->add_option("--surface", options.friction, "Friction of the ground instead of the manoeuvre's")
        ->check(CLI::Range(0.0, 10.0));
    drive->add_option("--seconds", options.seconds, "Simulated time instead of the manoeuvre's duration, s")
        ->check(CLI::Range(0.01, 1e4));
    drive->add_option("--json", options.json, "Write a row per value to this file");
    drive->add_option("--csv", options.csv, "Write all channels of the last manoeuvre to this file");
    drive->add_option("--svg", options.svg, "Write its plot to this file");
    return drive;
}

CLI::App* addRagdoll(CLI::App& app, Command& command) {
    demos::RagdollCommand& options = command.ragdoll;
    std::vector<std::string> names;
    std::string help = "Only this test, or several:";
    for (const demos::RagdollTest& test : demos::ragdollTests()) {
        names.emplace_back(test.name);
        help += fmt::format("{} {} ({})", names.size() > 1 ? "," : "", test.name, test.meaning);
    }
    names.emplace_back("none");
    help += ", none (to see what a body is taken for)";
    CLI::App* ragdoll = app.add_subcommand("ragdoll", "Test a ragdoll, character or robot; 1 when a figure fails");
    ragdoll->add_option("asset", options.asset, "Ragdoll file, character or URDF file")->required();
    ragdoll->add_option("--test", options.tests, help)->check(CLI::IsMember(names));
    ragdoll->add_option("--seeds", options.trial.seeds, "Runs of drop, push and flight")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str();
    ragdoll->add_option("--clips", options.clips, "Another character, whose clips are carried over to its bones");
    ragdoll->add_option("--clip", options.trial.clip, "Clip that `track` follows; the first that walks");
    ragdoll->add_option("--hz", options.trial.hz, "Steps a second")->check(CLI::Range(10, 1000))->capture_default_str();
    ragdoll->add_option("--push", options.trial.push, "Impulse on the chest, N s")
        ->check(CLI::Range(0, 100000))
        ->capture_default_str();
    ragdoll->add_flag("--holding", options.holding, "Servos of a robot hold every joint");
    ragdoll->add_option("--json", options.json, "Write the figures, and what a character was taken for, to this file");
    ragdoll->add_option("--out", options.out,
                        "Write NAME.fitted.ragdoll.json and, where there is none, NAME.ragdoll.json for changes to it");
    return ragdoll;
}

CLI::App* addFit(CLI::App& app, Command& command) {
    demos::FitCommand& options = command.fit;
    CLI::App* fit = app.add_subcommand("fit", "Take a closed mesh apart into convex pieces; 1 when they do not fit");
    fit->add_option("mesh", options.asset, "OBJ, STL, PLY, glTF or another mesh file")->required();
    fit->add_option("--pieces", options.limits.maxPieces, "Most pieces")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    fit->add_option("--vertices", options.limits.maxVertices, "Most vertices of a piece")
        ->check(CLI::Range(8, 128))
        ->capture_default_str();
    fit->add_option("--error", options.limits.maxError, "From the solid to the farthest air in a piece, m")
        ->check(CLI::Range(1e-6, 1e5))
        ->capture_default_str();
    fit->add_option("--volume", options.limits.maxVolume, "Of the pieces together, over that of the solid")
        ->check(CLI::Range(1.001, 1e6))
        ->capture_default_str();
    fit->add_option("--simplify", options.simplify, "Make the mesh simpler first, within this, m")
        ->check(CLI::Range(0.0, 1e5));
    fit->add_option("--threads", options.threads, "Threads that work")->check(CLI::Range(1, 64))->capture_default_str();
    fit->add_flag("--json", options.json, "As JSON, with the vertices of all pieces");
    fit->add_option("--out", options.out, "Write the pieces to this OBJ file, an object each");
    return fit;
}

CLI::App* addCook(CLI::App& app, Command& command) {
    demos::CookCommand& options = command.cook;
    CLI::App* cook =
        app.add_subcommand("cook", "Write a character, ragdoll, robot or mesh as one file that games load at once");
    cook->add_option("asset", options.asset, "Character, ragdoll file, robot or mesh")->required();
    cook->add_option("--out", options.out, "The file, NAME.ragtop")->required();
    cook->add_option("--clips", options.clips, "Other characters, whose clips are carried over to its bones");
    cook->add_option("--simplify", options.simplify, "Make a mesh simpler first, within this, m")
        ->check(CLI::Range(0.0, 1e5));
    CLI::Option* pieces =
        cook->add_option("--pieces", options.limits.maxPieces, "Add convex pieces of a mesh, at most so many")
            ->check(CLI::Range(1, 256));
    cook->add_option("--error", options.limits.maxError, "From the solid to the farthest air in a piece, m")
        ->needs(pieces)
        ->check(CLI::Range(1e-6, 1e5))
        ->capture_default_str();
    return cook;
}

/// What is wrong with the arguments, in one line.
std::string usageError(const CLI::App& app, const CLI::ParseError& error) {
    const auto unknown = app.remaining();
    if (app.get_subcommands().empty() && !unknown.empty()) {
        std::vector<std::string> commands;
        for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
            commands.push_back(command->get_name());
        }
        return fmt::format("\"{}\" is unknown, must be one of {}", unknown[0], fmt::join(commands, ", "));
    }
    std::string line = error.what();
    std::replace(line.begin(), line.end(), '\n', ' ');
    return line;
}

int execute(int argc, char** argv) {
    CLI::App app{"Game physics with cars and ragdolls", "ragtop"};
    app.set_version_flag("--version", "ragtop " RAGTOP_VERSION);
    app.require_subcommand(0, 1);
    Command command;
    CLI::App* listed = app.add_subcommand("list", "List the scenes that come with ragtop");
    CLI::App* run = addRun(app, command);
    CLI::App* served = addServe(app, command);
    CLI::App* driven = addDrive(app, command);
    CLI::App* ragdoll = addRagdoll(app, command);
    CLI::App* fit = addFit(app, command);
    CLI::App* cooked = addCook(app, command);
    CLI::App* inspect = app.add_subcommand("inspect", "Tell what a file has in it");
    inspect->add_option("asset", command.asset, "Vehicle, ragdoll, scene, character, robot or mesh")->required();
    inspect->add_flag("--json", command.json, "As JSON, with every element of a robot's file counted");
    try {
        app.parse(argc, argv);
        command.run.overrides = command.serve.world.overrides = parseOverrides(command.settings);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        fmt::print(stderr, "ragtop: {}\n", usageError(app, error));
        return kBadInput;
    }
    if (app.get_subcommands().empty()) {
        fmt::print(stderr, "{}", app.help());
        return kBadInput;
    }
    if (listed->parsed()) list();
    if (run->parsed()) demos::run(command.run);
    if (served->parsed()) serve(command.serve);
    if (driven->parsed() && !demos::drive(command.drive)) return kFailed;
    if (ragdoll->parsed() && !demos::testRagdoll(command.ragdoll)) return kFailed;
    if (fit->parsed() && !demos::fit(command.fit)) return kFailed;
    if (cooked->parsed()) {
        command.cook.pieces = cooked->count("--pieces") > 0;
        demos::cookAsset(command.cook);
    }
    if (inspect->parsed())
        fmt::print("{}", command.json ? demos::inspectAsJson(command.asset) : demos::inspect(command.asset));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return execute(argc, argv);
    } catch (const AssetError& error) {
        fmt::print(stderr, "{}\n", error.what());
        return kBadInput;
    } catch (const std::exception& error) {
        fmt::print(stderr, "ragtop: {}\n", error.what());
        return 1;
    }
}
