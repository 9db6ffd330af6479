#include "direct/ordering.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace ragtop::direct {

Ordering::Ordering(std::pmr::memory_resource* memory)
    : pairs_(memory), neighbours_(memory), degree_(memory), place_(memory), begin_(memory), rows_(memory) {}

void Ordering::reserve(std::size_t count, std::size_t pairCount) {
    pairs_.reserve(pairCount);
    neighbours_.reserve(count * ((count + 63) / 64));
    degree_.reserve(count);
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

void Ordering::eliminate() {
    words_ = (count_ + 63) / 64;
    neighbours_.clear();
    neighbours_.resize(std::size_t{count_} * words_, 0);
    const auto rowOf = [&](std::uint32_t v) { return neighbours_.data() + std::size_t{v} * words_; };
    for (const BlockPair& pair : pairs_) {
        if (pair.a == pair.b) continue;
        rowOf(pair.a)[pair.b / 64] |= std::uint64_t{1} << (pair.b % 64);
        rowOf(pair.b)[pair.a / 64] |= std::uint64_t{1} << (pair.a % 64);
    }
    degree_.resizeForOverwrite(count_);
    place_.resizeForOverwrite(count_);
    begin_.resizeForOverwrite(std::size_t{count_} + 1);
    rows_.clear();
    constexpr std::uint32_t kDone = 0xffffffffu;  // no degree
    const auto countBits = [&](std::uint32_t v) {
        std::uint32_t n = 0;
        for (std::uint32_t w = 0; w < words_; ++w) n += static_cast<std::uint32_t>(std::popcount(rowOf(v)[w]));
        return n;
    };
    for (std::uint32_t v = 0; v < count_; ++v) degree_[v] = countBits(v);

    for (std::uint32_t k = 0; k < count_; ++k) {
        std::uint32_t best = kDone, chosen = 0;
        for (std::uint32_t v = 0; v < count_; ++v)
            if (degree_[v] < best) best = degree_[v], chosen = v;
        place_[chosen] = k;
        degree_[chosen] = kDone;
        begin_[k] = static_cast<std::uint32_t>(rows_.size());
        const std::uint64_t* row = rowOf(chosen);
        for (std::uint32_t w = 0; w < words_; ++w)
            for (std::uint64_t bits = row[w]; bits != 0; bits &= bits - 1)
                rows_.push(w * 64 + static_cast<std::uint32_t>(std::countr_zero(bits)));
        for (std::uint32_t i = begin_[k]; i < rows_.size(); ++i) {
            const std::uint32_t neighbour = rows_[i];
            std::uint64_t* other = rowOf(neighbour);
            for (std::uint32_t w = 0; w < words_; ++w) other[w] |= row[w];
            other[neighbour / 64] &= ~(std::uint64_t{1} << (neighbour % 64));
            other[chosen / 64] &= ~(std::uint64_t{1} << (chosen % 64));
            degree_[neighbour] = countBits(neighbour);
        }
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
