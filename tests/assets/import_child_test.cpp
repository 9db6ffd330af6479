#include <cstdlib>
#include <thread>

#include "assimp_scene.h"
#include "byte_stream.h"
#include "child_process.h"
#include "import_support.h"

namespace ragtop {
namespace {

using std::chrono::milliseconds;

TEST(ChildProcess, GivesBackItsBytes) {
    // More than a pipe holds.
    const ChildResult result = runInChild([] { return std::vector<char>(3'000'000, 'x'); }, milliseconds(10000));
    EXPECT_EQ(result.failure, "");
    EXPECT_EQ(result.bytes.size(), 3'000'000u);
}

TEST(ChildProcess, CrashesTimeoutsAndExceptionsAreFailures) {
    EXPECT_NE(runInChild([]() -> std::vector<char> { std::abort(); }, milliseconds(10000)).failure.find("crashes"),
              std::string::npos);
    EXPECT_NE(runInChild([]() -> std::vector<char> { throw 1; }, milliseconds(10000)).failure, "");
    const auto greedy = []() -> std::vector<char> { throw std::bad_alloc(); };
    EXPECT_NE(runInChild(greedy, milliseconds(10000)).failure.find("memory"), std::string::npos);
    const auto endless = []() -> std::vector<char> {
        while (true) std::this_thread::sleep_for(milliseconds(10));
    };
    EXPECT_NE(runInChild(endless, milliseconds(200)).failure.find("longer than"), std::string::npos);
}

TEST(ChildProcess, OtherFaultsAreNotTakenForRecursion) {
    const auto nowhere = []() -> std::vector<char> { return {*reinterpret_cast<volatile char*>(8)}; };
    EXPECT_NE(runInChild(nowhere, milliseconds(10000)).failure, "");
    EXPECT_EQ(runInChild(nowhere, milliseconds(10000)).failure.find("nests"), std::string::npos);
}

/// Libraries recurse on frames within frames; a million end in a line with the limit.
TEST(ImportScene, FramesDeeperThanTheStackAreRefusedWithItsSize) {
    std::string deep = "xof 0303txt 0032\n";
    for (int i = 0; i < 1'000'000; ++i) deep += "Frame a {\n";
    const TemporaryFile file("deep.x", deep);
    const std::string error = importError(file.path(), [&] { importScene(file.path(), ImportedDetail::skeleton); });
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    EXPECT_NE(error.find("nests deeper than the 64 MiB of the importer's stack hold"), std::string::npos) << error;
#endif
}

TEST(ImportScene, EndlessAndGreedyFilesEndInOneLine) {
    RAGTOP_MODEL(file, "invalid/OutOfMemory.off");
    EXPECT_NE(importError(file, [&] { importScene(file, ImportedDetail::skeleton, milliseconds(1500)); }), "");
}

TEST(ImportScene, MalformedModelsNeverCrashTheCaller) {
    RAGTOP_MODEL(sample, "invalid/empty.obj");
    int refused = 0, read = 0;
    for (const auto& entry : std::filesystem::directory_iterator(sample.parent_path())) {
        if (!entry.is_regular_file() || entry.path().filename() == "OutOfMemory.off") continue;
        importError(entry.path(), [&] { importScene(entry.path(), ImportedDetail::surface); }) == "" ? ++read
                                                                                                     : ++refused;
    }
    EXPECT_GT(refused, 10);
    RecordProperty("read", read);
}

TEST(ByteStream, ReadsBackWhatItWrote) {
    ByteWriter writer;
    writer(std::string("text"));
    writer(std::vector<int>{1, 2, 3});
    const std::vector<char> bytes = std::move(writer).taken();
    ByteReader reader(bytes);
    std::string text;
    std::vector<int> numbers;
    reader(text);
    reader(numbers);
    EXPECT_EQ(text, "text");
    EXPECT_EQ(numbers, (std::vector<int>{1, 2, 3}));
    EXPECT_TRUE(reader.atEnd());
    EXPECT_THROW(reader(numbers), std::length_error);
    const std::vector<char> wrong(8, '\x7f');
    ByteReader greedy(wrong);
    EXPECT_THROW(greedy(numbers), std::length_error);
}

TEST(Affine, InverseUndoesShearAndMirror) {
    const Affine a{{{2, 0, 0}, {1, -3, 0}, {0, 0.5f, 1}}, {4, 5, 6}};
    const Affine back = inverse(a);
    for (const Vec3& p : {Vec3{1, 2, 3}, Vec3{-4, 0, 7}})
        EXPECT_LT(length(transformPoint(back, transformPoint(a, p)) - p), 1e-5f);
    EXPECT_FLOAT_EQ(determinant(a.linear), -6.0f);
}

}  // namespace
}  // namespace ragtop
