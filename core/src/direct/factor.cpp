#include "direct/factor.h"

#include <cstring>

namespace ragtop::direct {

BlockFactor::BlockFactor(std::pmr::memory_resource* memory)
    : kernels_(&selectBlockKernels()),
      ordering_(memory),
      diagonal_(memory),
      lower_(memory),
      targets_(memory),
      permuted_(memory) {}

void BlockFactor::reserve(std::size_t count, std::size_t pairCount) {
    ordering_.reserve(count, pairCount);
    diagonal_.reserve(count);
    permuted_.reserve(6 * count);
    // Those of the matrix; elimination adds few where there are few variables.
    lower_.reserve(pairCount);
    targets_.reserve(2 * pairCount);
}

bool BlockFactor::update(std::uint32_t count, const BlockPair* pairs, std::size_t pairCount) {
    if (!ordering_.update(count, pairs, pairCount)) return false;
    diagonal_.resizeForOverwrite(count);
    lower_.resizeForOverwrite(ordering_.blockCount());
    permuted_.resizeForOverwrite(6 * std::size_t{count});
    targets_.clear();
    for (std::uint32_t k = 0; k < count; ++k)
        for (std::uint32_t b = ordering_.columnBegin(k); b < ordering_.columnBegin(k + 1); ++b) {
            const std::uint32_t column = ordering_.row(b);
            std::uint32_t at = ordering_.columnBegin(column);
            for (std::uint32_t a = b + 1; a < ordering_.columnBegin(k + 1); ++a) {
                while (ordering_.row(at) != ordering_.row(a)) ++at;
                targets_.push(at);
            }
        }
    return true;
}

void BlockFactor::setZero() {
    std::memset(static_cast<void*>(diagonal_.data()), 0, diagonal_.size() * sizeof(Block6));
    if (!lower_.empty()) std::memset(static_cast<void*>(lower_.data()), 0, lower_.size() * sizeof(Block6));
}

BlockMatrix BlockFactor::matrix() {
    return {ordering_.count(), ordering_.columns(), ordering_.rows(), targets_.data(), diagonal_.data(), lower_.data()};
}

bool BlockFactor::factorize() { return kernels_->factorize(matrix()); }

void BlockFactor::solve(double* x) {
    const std::uint32_t n = ordering_.count();
    double* y = permuted_.data();
    for (std::uint32_t v = 0; v < n; ++v) std::memcpy(y + 6 * ordering_.place(v), x + 6 * v, 6 * sizeof(double));
    kernels_->solve(matrix(), y);
    for (std::uint32_t v = 0; v < n; ++v) std::memcpy(x + 6 * v, y + 6 * ordering_.place(v), 6 * sizeof(double));
}

}  // namespace ragtop::direct
