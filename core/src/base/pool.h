#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace ragtop {

/// Objects in slots that never move, named by ids (Id<Tag>) that are never reused. Slots freed last are used first, so
/// the same calls give the same ids. All state is four arrays and numbers, for saving and restoring.
template <class T, class IdType>
class Pool {
public:
    static constexpr std::uint32_t kEnd = 0xffffffffu;   ///< of the list of free slots
    static constexpr std::uint32_t kLive = 0xfffffffeu;  ///< link of a slot in use

    struct Header {
        std::uint32_t freeList = kEnd;
        std::uint32_t size = 0;
    };

    explicit Pool(std::pmr::memory_resource* memory) : values_(memory), generations_(memory), links_(memory) {}

    void reserve(std::size_t slots) {
        values_.reserve(slots);
        generations_.reserve(slots);
        links_.reserve(slots);
    }

    IdType insert(T value = T{}) {
        std::uint32_t index = freeList_;
        if (index != kEnd) {
            freeList_ = links_[index];
            links_[index] = kLive;
            values_[index] = std::move(value);
        } else {
            index = static_cast<std::uint32_t>(values_.size());
            if (index >= kLive) throw std::length_error("more objects than ids can name");
            // A failed allocation leaves longer spare arrays at most: values_ is the one that counts, and grows last.
            links_.resize(index + std::size_t{1}, kLive);
            links_[index] = kLive;
            generations_.resize(index + std::size_t{1}, 1);
            values_.push_back(std::move(value));
        }
        ++size_;
        return {index, generations_[index]};
    }

    /// The object's value is replaced by a default one at once. A slot whose generations are used up retires.
    void erase(IdType id) {
        assert(isValid(id));
        values_[id.index] = T{};
        --size_;
        if (++generations_[id.index] == 0) {
            links_[id.index] = kEnd;
            return;
        }
        links_[id.index] = freeList_;
        freeList_ = id.index;
    }

    bool isValid(IdType id) const {
        return id.index < values_.size() && links_[id.index] == kLive && generations_[id.index] == id.generation;
    }
    bool isLive(std::uint32_t index) const { return index < values_.size() && links_[index] == kLive; }
    IdType idOf(std::uint32_t index) const { return {index, generations_[index]}; }

    T& operator[](IdType id) {
        assert(isValid(id));
        return values_[id.index];
    }
    const T& operator[](IdType id) const {
        assert(isValid(id));
        return values_[id.index];
    }
    T& operator[](std::uint32_t index) { return values_[index]; }
    const T& operator[](std::uint32_t index) const { return values_[index]; }

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    /// Slots, in use or not; indices are below this.
    std::uint32_t slotCount() const { return static_cast<std::uint32_t>(values_.size()); }

    /// Calls visit(index, value) for each object in the order of the indices.
    template <class Visit>
    void forEach(Visit&& visit) {
        for (std::uint32_t i = 0; i < slotCount(); ++i) {
            if (links_[i] == kLive) visit(i, values_[i]);
        }
    }
    template <class Visit>
    void forEach(Visit&& visit) const {
        for (std::uint32_t i = 0; i < slotCount(); ++i) {
            if (links_[i] == kLive) visit(i, values_[i]);
        }
    }

    Header header() const { return {freeList_, size_}; }
    std::span<T> values() { return values_; }
    std::span<const T> values() const { return values_; }
    std::span<const std::uint32_t> generations() const { return {generations_.data(), values_.size()}; }
    std::span<const std::uint32_t> links() const { return {links_.data(), values_.size()}; }
    /// Brings back what header(), values(), generations() and links() gave; the spans have equal lengths.
    void restore(const Header& header, std::span<const T> values, std::span<const std::uint32_t> generations,
                 std::span<const std::uint32_t> links) {
        restoreLinks(header, generations, links);
        values_.assign(values.begin(), values.end());
    }
    /// The same without the values, for those that are no plain data: the slots keep theirs, new ones get T{}.
    void restoreLinks(const Header& header, std::span<const std::uint32_t> generations,
                      std::span<const std::uint32_t> links) {
        generations_.assign(generations.begin(), generations.end());
        links_.assign(links.begin(), links.end());
        values_.resize(links.size());
        freeList_ = header.freeList;
        size_ = header.size;
    }

private:
    std::pmr::vector<T> values_;
    std::pmr::vector<std::uint32_t> generations_;
    std::pmr::vector<std::uint32_t> links_;  ///< kLive, or the next free slot
    std::uint32_t freeList_ = kEnd;
    std::uint32_t size_ = 0;
};

}  // namespace ragtop
