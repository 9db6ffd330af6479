#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace ragtop {

/// What a function in a child process came to: its bytes, or why there are none.
struct ChildResult {
    std::vector<char> bytes;
    std::string failure;  ///< empty on success
};

/// Runs `work` in a copy of this process, without its output, and returns the bytes it gives. A crash, running out
/// of time or of memory becomes a `failure`. Throws std::system_error when no process can be made.
ChildResult runInChild(const std::function<std::vector<char>()>& work, std::chrono::milliseconds timeout);

}  // namespace ragtop
