#include "ragtop/vehicle_file.h"

#include "asset_reference.h"
#include "described_file.h"
#include "ragtop/tire_file.h"

namespace ragtop {

/// Names of files become paths that hold wherever the definition goes, and are equal where the files are.
static void findModels(const JsonValue& at, VehicleVisualDef& visual) {
    const auto find = [&](const char* key, std::string& path) {
        at.attempt(key, [&](const JsonValue& name) {
            const auto file = std::filesystem::absolute(assetFile(name));
            path = (std::filesystem::canonical(file.parent_path()) / file.filename()).string();
        });
    };
    find("chassis", visual.chassis);
    if (!visual.wheel.empty()) find("wheel", visual.wheel);
}

/// What a tire property file says holds; the rest of the definition stays.
static void readTire(const JsonValue& at, TireDef& tire) {
    at.attempt("file", [&](const JsonValue& name) {
        const TireDef read = loadTire(assetFile(name)).tire;
        tire.magicFormula = read.magicFormula;
        tire.radialStiffness = read.radialStiffness;
        tire.relaxationLength = read.relaxationLength;
        tire.rollingResistance = read.rollingResistance;
        tire.file.clear();
    });
}

VehicleDef readVehicle(const JsonDocument& document) {
    Faults faults(document);
    VehicleDef def = readDocument<VehicleDef>(document, faults);
    if (def.visual) findModels(JsonValue(document, &faults).at("visual"), *def.visual);
    for (std::size_t i = 0; i < def.wheels.size(); ++i) {
        if (def.wheels[i].tire.file.empty()) continue;
        readTire(JsonValue(document, &faults).at("wheels").at(i).at("tire"), def.wheels[i].tire);
    }
    faults.throwIfAny();
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) failInvalid(document, wrong);
    return def;
}

VehicleDef loadVehicle(const std::filesystem::path& path) { return readVehicle(loadExtended(path)); }

void saveVehicle(const VehicleDef& def, const std::filesystem::path& path) {
    if (const std::string wrong = whyInvalid(def); !wrong.empty()) {
        throw AssetError(path.string() + ": is not written, the vehicle is not usable: " + wrong);
    }
    writeJson(writeValue(def), path);
}

}  // namespace ragtop
