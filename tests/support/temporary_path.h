#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

/// A path for a file of one test: tests run at once, each in a process of its own.
inline std::filesystem::path temporaryPath(const std::string& name) {
    return std::filesystem::path(testing::TempDir()) / ("ragtop_" + std::to_string(getpid()) + "_" + name);
}
