#pragma once

#include <optional>
#include <string>

namespace ragtop::demos {

struct DriveOptions {
    std::string car;                ///< name or file
    std::string manoeuvre = "all";  ///< name, file or all
    float hz = 60;
    std::optional<int> level;         ///< of the model, instead of the car's
    std::optional<float> seconds;     ///< instead of the manoeuvre's duration
    std::optional<float> friction;    ///< of the ground, instead of the manoeuvre's
    std::optional<std::string> json;  ///< file of the rows
    std::optional<std::string> csv;   ///< file of all channels of the last manoeuvre
    std::optional<std::string> svg;   ///< file of its plot
};

/// Puts a car through manoeuvres and prints a row per value. False where a value failed. Throws AssetError on bad
/// input.
bool drive(const DriveOptions& options);

}  // namespace ragtop::demos
