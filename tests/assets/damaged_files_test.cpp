#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "damage.h"
#include "import_support.h"
#include "ragtop/character.h"
#include "ragtop/ragdoll_file.h"
#include "ragtop/robot.h"
#include "ragtop/scene.h"
#include "ragtop/vehicle_file.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

std::string contentOf(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

/// Models of a folder and of all in it, in the order of their names.
std::vector<fs::path> filesIn(const fs::path& folder) {
    constexpr std::uintmax_t kLargest = 8'000'000;  // bytes
    const std::string others = " .png .jpg .jpeg .bmp .tga .dds .txt .md .html .bin .mtl .material .exp .skin .source ";
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::recursive_directory_iterator at(folder, error), end; at != end; at.increment(error)) {
        if (!at->is_regular_file() || at->file_size() > kLargest) continue;
        const std::string extension = at->path().extension().string();
        if (!extension.empty() && others.find(" " + extension + " ") == std::string::npos) files.push_back(at->path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// A file in a folder of its own, beside links to those that the original lies beside.
class DamagedCopy {
public:
    DamagedCopy(const fs::path& original, const std::string& content)
        : folder_(temporaryPath("damaged")), path_(folder_ / original.filename()) {
        fs::create_directories(folder_);
        for (const fs::directory_entry& each : fs::directory_iterator(original.parent_path()))
            if (each.path() != original) fs::create_symlink(each.path(), folder_ / each.path().filename());
        std::ofstream(path_, std::ios::binary) << content;
    }
    ~DamagedCopy() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    DamagedCopy(const DamagedCopy&) = delete;
    DamagedCopy& operator=(const DamagedCopy&) = delete;
    const fs::path& path() const { return path_; }

private:
    fs::path folder_, path_;
};

/// How many files are damaged: a few in every run, two thousand in ./check --matrix.
int damageCount(int few) {
    const char* asked = std::getenv("RAGTOP_DAMAGED_FILES");
    return asked ? std::atoi(asked) : few;
}

std::string nameEnd(const fs::path& path) {
    const std::string name = path.filename().string();
    return name.substr(std::min(name.find('.'), name.size()));
}

/// As `ragtop inspect` reads it, which goes by the name.
void readAny(const fs::path& path) {
    const std::string end = nameEnd(path);
    if (end.ends_with(".car.json")) return void(loadVehicle(path));
    if (end.ends_with(".ragdoll.json")) return void(loadRagdoll(path));
    if (end.ends_with(".json")) return void(loadScene(path));
    if (end.ends_with(".urdf") || end.ends_with(".xml")) return void(loadRobot(path));
    try {
        const Character character = loadCharacter(path);
        try {
            makeRagdoll(character);
        } catch (const std::invalid_argument& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        }
    } catch (const AssetError& error) {
        if (std::string(error.what()).find("has no bones") == std::string::npos) throw;
        loadMesh(path);
    }
}

/// Makes and reads `count` damaged copies of `files`; none may end this program, take longer than the importer may, or
/// be refused in more than a line.
void readDamaged(const std::vector<fs::path>& files, int count, const char* label, bool oneLine = true) {
    int refused = 0;
    double slowest = 0;
    for (int i = 0; i < count; ++i) {
        const auto seed = static_cast<std::uint32_t>(i);
        std::mt19937 random(seed + 1'000'000);
        const fs::path& from = files[random() % files.size()];
        const DamagedCopy copy(from, damaged(contentOf(from), seed));
        SCOPED_TRACE(from.string() + ", seed " + std::to_string(seed));
        const auto begin = Clock::now();
        if (oneLine) {
            refused += importError(copy.path(), [&] { readAny(copy.path()); }) == "" ? 0 : 1;
        } else {
            // A line for each independent mistake.
            try {
                readAny(copy.path());
            } catch (const AssetError& error) {
                ++refused;
                EXPECT_EQ(std::string(error.what()).find(copy.path().string()), 0u) << error.what();
            }
        }
        const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        slowest = std::max(slowest, seconds);
    }
    testing::Test::RecordProperty(std::string(label) + "_refused", refused);
    std::printf("%s: %d of %d damaged copies of %zu files refused, slowest %.2f s\n", label, refused, count,
                files.size(), slowest);
}

TEST(DamagedFiles, ModelsNeverEndTheProgram) {
    RAGTOP_MODEL(sample, "invalid/empty.obj");
    std::vector<fs::path> files = filesIn(sample.parent_path().parent_path());
    for (const char* folder : {"characters", "vehicles"})
        for (const fs::path& file : filesIn(fs::path(RAGTOP_SHARED_DIR) / "data" / folder)) files.push_back(file);
    readDamaged(files, damageCount(40), "models");
}

TEST(DamagedFiles, RigsAndRobotsNeverEndTheProgram) {
    std::vector<fs::path> files = filesIn(fs::path(RAGTOP_SOURCE_DIR) / "tests" / "data");
    ASSERT_FALSE(files.empty());
    std::erase_if(files, [](const fs::path& path) { return path.extension() == ".json"; });
    for (const fs::path& robot : filesIn(fs::path(RAGTOP_SHARED_DIR) / "data" / "robots"))
        if (robot.extension() == ".urdf") files.push_back(robot);
    readDamaged(files, damageCount(100), "rigs");
}

TEST(DamagedFiles, OwnFilesNeverEndTheProgram) {
    std::vector<fs::path> files = filesIn(fs::path(RAGTOP_SOURCE_DIR) / "assets" / "data");
    std::erase_if(files, [](const fs::path& path) {
        return path.extension() != ".json" || path.parent_path().filename() == "manoeuvres";
    });
    ASSERT_FALSE(files.empty());
    readDamaged(files, damageCount(100), "own", false);
}

}  // namespace
}  // namespace ragtop
