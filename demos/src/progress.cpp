#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace ragtop::demos {

Progress::Progress(std::uint64_t steps) : steps_(steps), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (terminal_ && shown_ > 0) std::fputs("\r\033[K", stderr);
}

void Progress::show(std::uint64_t step, double ms) {
    const std::uint64_t parts = terminal_ ? 50 : 10;
    const std::uint64_t reached = steps_ > 0 ? step * parts / steps_ : parts;
    if (reached == shown_) return;
    shown_ = reached;
    if (terminal_) {
        const std::string bar(reached, '#'), rest(parts - reached, '.');
        fmt::print(stderr, "\r[{}{}] step {} of {}, {:.2f} ms", bar, rest, step, steps_, ms);
    } else {
        fmt::print(stderr, "step {} of {}, {:.2f} ms\n", step, steps_, ms);
    }
    std::fflush(stderr);
}

}  // namespace ragtop::demos
