#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "../stability/isolation.h"

namespace ragtop::chart {

using Work = std::function<std::string(std::size_t number)>;
using Done = std::function<void(std::size_t number, const stability::Outcome& outcome)>;

/// This program's processes under mpirun: the first hands out numbers of works, the others do them. One alone where
/// nobody started several.
class Ranks {
public:
    /// Throws std::runtime_error where mpirun started several and the program was built without Open MPI.
    Ranks();
    ~Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    int count() const { return count_; }
    bool isFirst() const { return rank_ == 0; }

    /// Of the first: hands out these numbers in their order and tells what became of each, as it comes.
    void handOut(std::span<const std::size_t> numbers, const Done& done) const;
    /// Of the first: nothing more will come.
    void dismiss() const;
    /// Of the others: does what it is handed, each in a process of its own, until it is dismissed.
    void serve(const Work& work, double limit) const;

private:
    int count_ = 1, rank_ = 0;
};

}  // namespace ragtop::chart
