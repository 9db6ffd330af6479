#include "programs.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace ragtop::chart {
namespace {

using Json = nlohmann::json;

/// Names are parts of keys and of lines.
bool isName(const std::string& text) {
    return !text.empty() &&
           text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-") ==
               std::string::npos;
}

std::vector<int> numbersOf(const Json& hello, const char* name, int least, int standard) {
    const auto numbers = hello.value(name, std::vector<int>{standard});
    for (const int number : numbers)
        if (number < least) throw std::runtime_error(fmt::format("{} has {}, must be {} or more", name, number, least));
    return numbers;
}

Variant variantOf(const Json& hello, const std::string& command, double patience) {
    Variant variant;
    variant.name = variant.engine = hello.at("name").get<std::string>();
    if (!isName(variant.name))
        throw std::runtime_error(
            fmt::format("name is \"{}\", must be of letters, digits, dots, dashes and underscores", variant.name));
    variant.version = hello.value("version", "unknown");
    variant.what = hello.value("what", "spoken to by the protocol");
    const Json standard = hello.value("standard", Json::object());
    variant.standard = {1.0 / standard.value("rate", 60), standard.value("substeps", 1),
                        standard.value("iterations", 0)};
    variant.substeps = numbersOf(hello, "substeps", 1, variant.standard.substeps);
    variant.iterations = numbersOf(hello, "iterations", 0, variant.standard.iterations);
    variant.engineCommand = command;
    variant.timed = hello.value("timed", true);
    variant.make = [command, patience](const Scene& scene, const Setting& setting) {
        return stability::makeProgram(
            scene,
            {.command = command, .substeps = setting.substeps, .iterations = setting.iterations, .patience = patience});
    };
    return variant;
}

}  // namespace

Variant programVariant(const std::string& command, double patience) {
    try {
        Variant variant = variantOf(Json::parse(stability::programHello(command, patience)), command, patience);
        for (const Variant& known : allVariants())
            if (known.engine == variant.engine)
                throw std::runtime_error(fmt::format("name is \"{}\", must be none that is known", variant.name));
        return variant;
    } catch (const std::exception& error) {
        throw std::runtime_error(fmt::format("--engine-command {}: {}", command, error.what()));
    }
}

}  // namespace ragtop::chart
