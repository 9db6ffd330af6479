#include "direct/ordering.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace ragtop::direct {

Ordering::Ordering(std::pmr::memory_resource* memory)
    : pairs_(memory),
      neighbours_(memory),
      least_(memory),
      filled_(memory),
      place_(memory),
      begin_(memory),
      rows_(memory) {}

void Ordering::reserve(std::size_t count, std::size_t pairCount) {
    pairs_.reserve(pairCount);
    neighbours_.reserve(count * ((count + 63) / 64));
    least_.reserve(2 * std::bit_ceil(count));
    filled_.reserve((count + 63) / 64);
    place_.reserve(count);
    begin_.reserve(count + 1);
    rows_.reserve(pairCount);
}

bool Ordering::update(std::uint32_t count, const BlockPair* pairs, std::size_t pairCount) {
    const std::size_t bytes = pairCount * sizeof(BlockPair);
    if (count == count_ && pairCount == pairs_.size() && (bytes == 0 || std::memcmp(pairs, pairs_.data(), bytes) == 0))
        return false;
    count_ = count;
    pairs_.resizeForOverwrite(pairCount);
    if (bytes > 0) std::memcpy(static_cast<void*>(pairs_.data()), pairs, bytes);
    eliminate();
    return true;
}

/// Bits of all pairs, and who has fewest.
void Ordering::beginElimination() {
    words_ = (count_ + 63) / 64;
    neighbours_.clear();
    neighbours_.resize(std::size_t{count_} * words_, 0);
    for (const BlockPair& pair : pairs_) {
        if (pair.a == pair.b) continue;
        neighboursOf(pair.a)[pair.b / 64] |= std::uint64_t{1} << (pair.b % 64);
        neighboursOf(pair.b)[pair.a / 64] |= std::uint64_t{1} << (pair.a % 64);
    }
    leaves_ = std::bit_ceil(count_);
    least_.clear();
    least_.resize(2 * std::size_t{leaves_}, kDone);
    for (std::uint32_t v = 0; v < count_; ++v) {
        std::uint64_t degree = 0;
        for (std::uint32_t w = 0; w < words_; ++w)
            degree += static_cast<std::uint64_t>(std::popcount(neighboursOf(v)[w]));
        least_[leaves_ + v] = degree << 32 | v;
    }
    for (std::uint32_t i = leaves_; i-- > 1;) least_[i] = std::min(least_[2 * i], least_[2 * i + 1]);
}

void Ordering::setRank(std::uint32_t variable, std::uint64_t rank) {
    std::size_t i = leaves_ + variable;
    least_[i] = rank;
    while (i > 1) {
        i /= 2;
        const std::uint64_t least = std::min(least_[2 * i], least_[2 * i + 1]);
        if (least_[i] == least) return;
        least_[i] = least;
    }
}

/// All neighbours of a variable become neighbours of each other.
void Ordering::join(std::uint32_t chosen, std::uint32_t firstRow) {
    const std::uint64_t* row = neighboursOf(chosen);
    for (std::size_t i = firstRow; i < rows_.size(); ++i) {
        const std::uint32_t neighbour = rows_[i];
        std::uint64_t* other = neighboursOf(neighbour);
        std::uint64_t more = 0;
        for (const std::uint32_t w : filled_) {
            const std::uint64_t added = row[w] & ~other[w];
            if (added == 0) continue;
            other[w] |= added;
            more += static_cast<std::uint64_t>(std::popcount(added));
        }
        other[neighbour / 64] &= ~(std::uint64_t{1} << (neighbour % 64));
        other[chosen / 64] &= ~(std::uint64_t{1} << (chosen % 64));
        constexpr std::uint64_t kGone = 2;  // itself, which was added, and the chosen one
        const std::uint64_t degree = (least_[leaves_ + neighbour] >> 32) + more - kGone;
        setRank(neighbour, degree << 32 | neighbour);
    }
}

void Ordering::eliminate() {
    beginElimination();
    place_.resizeForOverwrite(count_);
    begin_.resizeForOverwrite(std::size_t{count_} + 1);
    rows_.clear();
    for (std::uint32_t k = 0; k < count_; ++k) {
        const auto chosen = static_cast<std::uint32_t>(least_[1]);
        place_[chosen] = k;
        setRank(chosen, kDone);
        begin_[k] = static_cast<std::uint32_t>(rows_.size());
        const std::uint64_t* row = neighboursOf(chosen);
        filled_.clear();
        for (std::uint32_t w = 0; w < words_; ++w) {
            if (row[w] == 0) continue;
            filled_.push(w);
            for (std::uint64_t bits = row[w]; bits != 0; bits &= bits - 1)
                rows_.push(w * 64 + static_cast<std::uint32_t>(std::countr_zero(bits)));
        }
        join(chosen, begin_[k]);
    }
    begin_[count_] = static_cast<std::uint32_t>(rows_.size());
    for (std::uint32_t& row : rows_) row = place_[row];
    for (std::uint32_t k = 0; k < count_; ++k) std::sort(rows_.begin() + begin_[k], rows_.begin() + begin_[k + 1]);
}

std::uint32_t Ordering::blockOf(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t pa = place_[a], pb = place_[b];
    const std::uint32_t column = pa < pb ? pa : pb, row = pa < pb ? pb : pa;
    const std::uint32_t* first = rows_.begin() + begin_[column];
    const std::uint32_t* last = rows_.begin() + begin_[column + 1];
    return static_cast<std::uint32_t>(std::lower_bound(first, last, row) - rows_.begin());
}

}  // namespace ragtop::direct
