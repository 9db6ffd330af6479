#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "ragtop/tire_file.h"
#include "ragtop/vehicle_file.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

/// A file that is there for a test.
struct Written {
    std::filesystem::path path;
    Written(const std::string& name, const std::string& text) : path(temporaryPath(name)) {
        std::ofstream(path) << text;
    }
    ~Written() { std::filesystem::remove(path); }
};

// A tire that was made up.
const std::string kTire = R"([MDI_HEADER]
FILE_TYPE = 'tir'
[UNITS]
LENGTH = 'meter'
FORCE  = 'newton'
ANGLE  = 'radians'
[MODEL]
PROPERTY_FILE_FORMAT = 'PAC2002'  $ a comment
FITTYP = 52
[DIMENSION]
UNLOADED_RADIUS = 0.31
[SHAPE]
{radial width}
 1.0    0.0
[VERTICAL]
VERTICAL_STIFFNESS = 2.1e5
FNOMIN = 4200
[LONGITUDINAL_COEFFICIENTS]
PCX1 = 1.6
PDX1 = +1.15
PKX1 = 24
[LATERAL_COEFFICIENTS]
pcy1 = 1.35
PDY1 = 1.02   ! another
PKY1 = -21
PKY2 = 1.6
PTY1 = 2.1
PTY2 = 2
QSY1 = 0.011
QSZ9 = 3
)";

float of(const TireFile& file, std::size_t index) { return file.tire.magicFormula->values[index]; }

TEST(TirFile, IsReadWithItsUnitsAndDefaults) {
    const Written file("made.tir", kTire);
    const TireFile read = loadTire(file.path);
    EXPECT_EQ(of(read, magicIndex("FITTYP")), 52);
    EXPECT_EQ(of(read, magicIndex("FNOMIN")), 4200);
    EXPECT_EQ(of(read, magicIndex("PDX1")), 1.15f);
    EXPECT_EQ(of(read, magicIndex("PCY1")), 1.35f);
    EXPECT_EQ(of(read, magicIndex("PEY1")), 0);
    EXPECT_EQ(of(read, magicIndex("LMUX")), 1);
    EXPECT_EQ(of(read, magicIndex("PKY4")), 2);
    EXPECT_EQ(read.tire.radialStiffness, 2.1e5f);
    EXPECT_EQ(read.tire.rollingResistance, 0.011f);
    EXPECT_NEAR(read.tire.relaxationLength, 2.1f * 0.8f * 0.31f, 1e-6f);
    EXPECT_EQ(read.leftOut, std::vector<std::string>{"QSZ9"});
    EXPECT_NEAR(tireNumbers(read.tire, 4200).longitudinalFriction, 1.15f, 1e-5f);
}

std::string complaint(std::string from, const std::string& what, const std::string& with) {
    from.replace(from.find(what), what.size(), with);
    const Written file("broken.tir", from);
    try {
        loadTire(file.path);
    } catch (const AssetError& error) {
        std::string said = error.what();
        for (std::size_t at; (at = said.find(file.path.string())) != std::string::npos;)
            said.replace(at, file.path.string().size(), "F");
        return said;
    }
    return "nothing";
}

TEST(TirFile, TellsWhatIsWrongInWhichLine) {
    EXPECT_EQ(complaint(kTire, "'newton'", "'pound'"), "F:5: FORCE is 'pound', must be one of NEWTON, N");
    EXPECT_EQ(complaint(kTire, "'PAC2002'", "'FTIRE'"),
              "F:8: PROPERTY_FILE_FORMAT is 'FTIRE', must be one of PAC2002, MF-TYRE, MF-SWIFT, MF_05, MF52, MF61, "
              "MF62, USER");
    EXPECT_EQ(complaint(kTire, "PDX1 = +1.15", "PDX1 = much"),
              "F:20: PDX1 is much, must be a number in [0.001, 1000000]");
    EXPECT_EQ(complaint(kTire, "PKY1 = -21", "PKY1 = 21"), "F:25: PKY1 is 21, must be in [-1000000, -0.001]");
    EXPECT_EQ(complaint(kTire, "FNOMIN = 4200", "FNOMIN = -1"), "F:17: FNOMIN is -1 N, must be in [0.001, 1e+09]");
    EXPECT_EQ(complaint(kTire, "FNOMIN = 4200\n", ""), "F: FNOMIN is not given, must be");
    EXPECT_EQ(complaint(kTire, "PKX1 = 24", "PKX1 = 24\nPKX1 = 25"),
              "F:22: PKX1 is given again, must be in one line: line 21 has it");
    EXPECT_EQ(complaint(kTire, "PKX1 = 24", "PKX1 24"),
              "F:21: 'PKX1 24' is no line of this format, must be NAME = value\nF: PKX1 is not given, must be");
    EXPECT_EQ(complaint(kTire, "[MODEL]", "[MODEL"), "F:7: [MODEL is a section without its end, must have ]");
    EXPECT_THROW(loadTire("nowhere.tir"), AssetError);
}

TEST(VehicleFile, TakesTiresFromPropertyFiles) {
    const Written tire("made.tir", kTire);
    VehicleDef def = loadVehicle(std::filesystem::path(RAGTOP_SOURCE_DIR) / "assets/data/vehicles/hatchback.car.json");
    def.visual.reset();
    const auto plain = temporaryPath("plain.car.json");
    saveVehicle(def, plain);
    std::string text;
    std::getline(std::ifstream(plain), text, '\0');
    const std::string key = "\"file\": \"\"";
    text.replace(text.find(key), key.size(), "\"file\": \"" + tire.path.generic_string() + "\"");
    const Written car("tired.car.json", text);
    std::filesystem::remove(plain);
    const VehicleDef read = loadVehicle(car.path);
    ASSERT_TRUE(read.wheels[0].tire.magicFormula);
    EXPECT_EQ(read.wheels[0].tire.magicFormula->values[magicIndex("PKX1")], 24);
    EXPECT_EQ(read.wheels[0].tire.radialStiffness, 2.1e5f);
    EXPECT_TRUE(read.wheels[0].tire.file.empty());
    EXPECT_FALSE(read.wheels[1].tire.magicFormula);
    // What was read is written in full.
    const Written again("again.car.json", "");
    saveVehicle(read, again.path);
    EXPECT_EQ(loadVehicle(again.path).wheels[0].tire.magicFormula->values, read.wheels[0].tire.magicFormula->values);
}

}  // namespace
}  // namespace ragtop
