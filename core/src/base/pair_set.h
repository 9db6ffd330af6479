#pragma once

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <span>
#include <vector>

#include "base/prefetch.h"

namespace ragtop {

/// One key for the pair of two indices, whichever comes first.
constexpr std::uint64_t pairKey(std::uint32_t a, std::uint32_t b) {
    return a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
}

/// A map from 64-bit keys to 32-bit values: open addressing with linear probing and deletion by shifting back [Knuth,
/// The Art of Computer Programming 3, 1998, 6.4 algorithm R], so that it never fills with marks of the dead. The same
/// calls give the same table, which is plain memory to save.
class PairSet {
    static constexpr std::uint32_t kUnused = ~std::uint32_t{0};

public:
    /// The key is in two halves, so that an entry is twelve bytes and not sixteen.
    struct Entry {
        std::uint32_t low = 0, high = 0;
        std::uint32_t value = kUnused;

        std::uint64_t key() const { return std::uint64_t{high} << 32 | low; }
        bool used() const { return value != kUnused; }
    };

    explicit PairSet(std::pmr::memory_resource* memory) : entries_(memory) {}

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }

    /// Makes room for this many keys without further memory.
    void reserve(std::size_t keys) {
        const std::size_t wanted = std::bit_ceil(std::max<std::size_t>(keys + keys / 3 + 1, kSmallest));
        if (wanted > entries_.size()) rehash(wanted);
    }

    /// False, and nothing changes, when the key is there already. The greatest value marks what is unused.
    bool insert(std::uint64_t key, std::uint32_t value) {
        assert(value != kUnused);
        reserve(size_ + 1);
        const std::size_t at = placeOf(key);
        if (entries_[at].used()) return false;
        entries_[at] = {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32), value};
        ++size_;
        return true;
    }

    /// The value of a key, or null; valid until the next insert or erase.
    const std::uint32_t* find(std::uint64_t key) const {
        if (size_ == 0) return nullptr;
        const Entry& entry = entries_[placeOf(key)];
        return entry.used() ? &entry.value : nullptr;
    }
    std::uint32_t* find(std::uint64_t key) {
        return const_cast<std::uint32_t*>(static_cast<const PairSet*>(this)->find(key));
    }
    /// Asks for the memory that looking for a key will read.
    void prefetch(std::uint64_t key) const {
        if (size_ > 0) ragtop::prefetch(&entries_[homeOf(key)]);
    }
    bool contains(std::uint64_t key) const { return find(key) != nullptr; }

    /// False when the key is not there.
    bool erase(std::uint64_t key) {
        if (size_ == 0) return false;
        std::size_t hole = placeOf(key);
        if (!entries_[hole].used()) return false;
        // An entry behind the hole moves into it unless its home lies behind the hole as well.
        const std::size_t mask = entries_.size() - 1;
        for (std::size_t i = (hole + 1) & mask; entries_[i].used(); i = (i + 1) & mask) {
            const std::size_t home = homeOf(entries_[i].key());
            if (((i - home) & mask) >= ((i - hole) & mask)) {
                entries_[hole] = entries_[i];
                hole = i;
            }
        }
        entries_[hole] = {};
        --size_;
        return true;
    }

    /// Forgets the keys and keeps the memory.
    void clear() {
        std::fill(entries_.begin(), entries_.end(), Entry{});
        size_ = 0;
    }

    std::span<const Entry> entries() const { return entries_; }
    /// Brings back what entries() gave, from memory of any alignment.
    void restore(const void* entries, std::size_t count) {
        entries_.resize(count);
        if (count > 0) std::memcpy(static_cast<void*>(entries_.data()), entries, count * sizeof(Entry));
        size_ = static_cast<std::size_t>(
            std::count_if(entries_.begin(), entries_.end(), [](const Entry& entry) { return entry.used(); }));
    }

private:
    static constexpr std::size_t kSmallest = 16;  ///< entries

    /// The high bits of a product depend on all bits of the key (Fibonacci hashing).
    std::size_t homeOf(std::uint64_t key) const {
        const std::uint64_t mixed = (key ^ (key >> 32)) * 0x9e3779b97f4a7c15u;
        return static_cast<std::size_t>(mixed >> (64 - std::countr_zero(entries_.size())));
    }

    /// Where the key is, or the free entry where it belongs. At most three of four entries are used, so one is free.
    std::size_t placeOf(std::uint64_t key) const {
        const std::size_t mask = entries_.size() - 1;
        std::size_t at = homeOf(key);
        while (entries_[at].used() && entries_[at].key() != key) at = (at + 1) & mask;
        return at;
    }

    void rehash(std::size_t capacity) {
        std::pmr::vector<Entry> old(capacity, Entry{}, entries_.get_allocator());
        old.swap(entries_);
        for (const Entry& entry : old) {
            if (entry.used()) entries_[placeOf(entry.key())] = entry;
        }
    }

    std::pmr::vector<Entry> entries_;  ///< a power of two
    std::size_t size_ = 0;
};

}  // namespace ragtop
