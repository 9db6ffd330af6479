#pragma once

#include <cstdint>

namespace ragtop::demos {

/// Tells on the error stream how far a run is: a bar on a terminal, a line per tenth elsewhere.
class Progress {
public:
    explicit Progress(std::uint64_t steps);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(std::uint64_t step, double ms);

private:
    std::uint64_t steps_;
    std::uint64_t shown_ = 0;
    bool terminal_;
};

}  // namespace ragtop::demos
