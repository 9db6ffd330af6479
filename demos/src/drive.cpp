#include "drive.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "drive_plot.h"
#include "ragtop/data_folder.h"
#include "ragtop/manoeuvre.h"
#include "ragtop/vehicle_file.h"

namespace ragtop::demos {
namespace {

namespace fs = std::filesystem;

fs::path findCar(const std::string& nameOrPath) {
    std::error_code ignored;
    if (fs::is_regular_file(nameOrPath, ignored)) return nameOrPath;
    const fs::path shipped = dataFolder() / "vehicles" / (nameOrPath + ".car.json");
    if (fs::is_regular_file(shipped, ignored)) return shipped;
    throw AssetError(nameOrPath + ": no such car, must be a file or the name of one in " +
                     shipped.parent_path().string());
}

std::ofstream openFile(const std::string& path) {
    std::ofstream file(path);
    if (!file) throw AssetError(path + ": cannot be written");
    return file;
}

nlohmann::ordered_json rowOf(const Manoeuvre& manoeuvre, const VehicleDef& def, float hz, const TrackValue& value) {
    nlohmann::ordered_json row;
    row["manoeuvre"] = manoeuvre.name;
    row["car"] = def.name;
    row["hz"] = hz;
    row["level"] = static_cast<int>(def.level);
    row["name"] = value.name;
    row["value"] = value.value;
    row["unit"] = value.unit;
    row["reference"] = value.reference ? nlohmann::ordered_json(*value.reference) : nlohmann::ordered_json();
    row["error"] = value.error ? nlohmann::ordered_json(*value.error) : nlohmann::ordered_json();
    row["pass"] = value.pass;
    return row;
}

void print(const Manoeuvre& manoeuvre, const TrackValue& value) {
    const std::string reference =
        value.reference ? fmt::format("{:>10.5g} {:>+8.2f} %", *value.reference, 100 * *value.error) : "";
    fmt::print("{:<4}  {:<18} {:<28} {:>10.5g} {:<6} {}\n", value.pass ? "pass" : "FAIL", manoeuvre.name, value.name,
               value.value, value.unit, reference);
}

void writeCsv(const std::string& path, const TrackRun& run) {
    std::ofstream file = openFile(path);
    for (std::size_t i = 0; i < kTrackChannels.size(); ++i)
        file << (i > 0 ? "," : "") << fmt::format("{} [{}]", kTrackChannels[i].name, kTrackChannels[i].unit);
    file << '\n';
    for (const auto& sample : run.samples) file << fmt::format("{:.9g}\n", fmt::join(sample, ","));
}

}  // namespace

bool drive(const DriveOptions& options) {
    const std::filesystem::path car = findCar(options.car);
    VehicleDef def = loadVehicle(car);
    if (options.level) def.level = static_cast<VehicleLevel>(*options.level);
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) throw AssetError(car.string() + ": " + wrong);
    std::vector<Manoeuvre> manoeuvres;
    if (options.manoeuvre == "all") {
        for (const std::string& name : shippedManoeuvres()) manoeuvres.push_back(loadManoeuvre(findManoeuvre(name)));
    } else {
        manoeuvres.push_back(loadManoeuvre(findManoeuvre(options.manoeuvre)));
    }
    if (manoeuvres.empty()) throw AssetError((dataFolder() / "manoeuvres").string() + ": has no manoeuvres");
    auto rows = nlohmann::ordered_json::array();
    bool good = true;
    for (const Manoeuvre& manoeuvre : manoeuvres) {
        if (def.level < manoeuvre.leastLevel) {
            const std::string needs =
                fmt::format("{:<18} is of level {} and above", manoeuvre.name, static_cast<int>(manoeuvre.leastLevel));
            if (options.manoeuvre != "all") throw AssetError(needs);
            fmt::print("----  {}\n", needs);
            continue;
        }
        const TrackRun run = ragtop::drive(manoeuvre, def, {options.hz, options.seconds, options.friction, def.level});
        for (const TrackValue& value : run.values) {
            print(manoeuvre, value);
            rows.push_back(rowOf(manoeuvre, def, options.hz, value));
            good = good && value.pass;
        }
        if (&manoeuvre != &manoeuvres.back()) continue;
        if (options.csv) writeCsv(*options.csv, run);
        if (options.svg) openFile(*options.svg) << plotOf(manoeuvre, run);
    }
    if (options.json) openFile(*options.json) << rows.dump(2) << '\n';
    return good;
}

}  // namespace ragtop::demos
