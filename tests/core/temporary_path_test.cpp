#include "support/temporary_path.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace {

namespace fs = std::filesystem;

/// Runs it in a child of this process that ends as programs do; gives what it returns.
template <class Function>
std::string inChild(Function function) {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
        const std::string text = function();
        std::exit(write(ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size()) ? 0 : 1);
    }
    close(ends[1]);
    std::string text;
    char byte = 0;
    while (read(ends[0], &byte, 1) == 1) text += byte;
    close(ends[0]);
    int status = -1;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    return text;
}

TEST(TemporaryPath, GoesAwayWithItsProcess) {
    const fs::path path = inChild([] {
        fs::create_directories(temporaryPath("folder"));
        std::ofstream(temporaryPath("folder") / "file") << "left behind";
        return temporaryPath("folder").string();
    });
    EXPECT_EQ(path.filename(), "folder");
    EXPECT_EQ(path.parent_path().parent_path(), fs::temp_directory_path());
    EXPECT_FALSE(fs::exists(path.parent_path()));
}

TEST(TemporaryPath, StaysWhenAChildEnds) {
    const fs::path path = temporaryPath("file");
    std::ofstream(path) << "still needed";
    EXPECT_EQ(inChild([] { return temporaryPath("file").string(); }), path.string());
    EXPECT_TRUE(fs::exists(path));
}

}  // namespace
