#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <new>
#include <type_traits>

#include "base/aligned_array.h"

namespace ragtop {

/// A growing array of plain data in pages of the same size: what is there stays where it is and is never copied. While
/// there is one page it grows by its own size, then by a page in 128, and one more. Elements are beside each other as
/// far as a page reaches, which starts at a multiple of kPage.
template <class T>
class PagedArray {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    static constexpr std::size_t kPage = std::bit_floor((std::size_t{1} << 16) / sizeof(T));  ///< elements
    static constexpr unsigned kPageBits = std::countr_zero(kPage);

    explicit PagedArray(std::pmr::memory_resource* memory) : memory_(memory), pages_(memory) {}
    PagedArray(const PagedArray&) = delete;
    PagedArray& operator=(const PagedArray&) = delete;
    ~PagedArray() {
        for (void* page : pages_) memory_->deallocate(page, bytesOfPage(), kAlignment);
    }

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    T& operator[](std::size_t i) { return static_cast<T*>(pages_[i >> kPageBits])[i & (kPage - 1)]; }
    const T& operator[](std::size_t i) const { return static_cast<const T*>(pages_[i >> kPageBits])[i & (kPage - 1)]; }
    void* const* pages() const { return pages_.data(); }
    /// The elements while the array does not grow, for loops: what they write cannot be where the pages are.
    class View {
    public:
        explicit View(void* const* pages) : pages_(pages) {}
        T& operator[](std::size_t i) const { return static_cast<T*>(pages_[i >> kPageBits])[i & (kPage - 1)]; }

    private:
        void* const* pages_;
    };
    View view() { return View(pages_.data()); }
    std::size_t capacity() const { return capacity_; }
    std::size_t bytes() const { return capacity_ * sizeof(T) + pages_.bytes(); }

    /// New elements are `value`.
    void resize(std::size_t size, const T& value) {
        reserve(size);
        for (std::size_t i = size_; i < size; ++i) ::new (static_cast<void*>(&(*this)[i])) T(value);
        size_ = size;
    }
    void clear() { size_ = 0; }

    /// Calls visit(bytes, count) for the memory of each page in order.
    template <class Visit>
    void forEachPart(Visit&& visit) const {
        for (std::size_t first = 0; first < size_; first += kPage)
            visit(pages_[first >> kPageBits], (size_ - first < kPage ? size_ - first : kPage) * sizeof(T));
    }
    /// Takes the elements from memory of any alignment.
    void restore(const void* elements, std::size_t count) {
        reserve(count);
        size_ = count;
        const auto* from = static_cast<const std::byte*>(elements);
        forEachPart([&](void* to, std::size_t bytes) {
            std::memcpy(to, from, bytes);
            from += bytes;
        });
    }

private:
    static constexpr std::size_t kAlignment = 64, kFew = 16;  ///< bytes; elements

    std::size_t bytesOfPage() const { return (capacity_ < kPage ? capacity_ : kPage) * sizeof(T); }
    void* allocate(std::size_t count) { return memory_->allocate(count * sizeof(T), kAlignment); }

    void reserve(std::size_t size) {
        if (size > capacity_ && capacity_ < kPage) growFirst(size);
        if (size <= capacity_) return;
        const std::size_t wanted = size + pages_.size() / 128 * kPage;
        for (; capacity_ < wanted; capacity_ += kPage) pages_.push(allocate(kPage));
    }
    void growFirst(std::size_t size) {
        std::size_t grown = capacity_ > 0 ? 2 * capacity_ : kFew;
        if (grown < size) grown = size;
        if (grown > kPage) grown = kPage;
        void* page = allocate(grown);
        if (pages_.empty()) {
            pages_.push(page);
        } else {
            if (size_ > 0) std::memcpy(page, pages_[0], size_ * sizeof(T));
            memory_->deallocate(pages_[0], bytesOfPage(), kAlignment);
            pages_[0] = page;
        }
        capacity_ = grown;
    }

    std::pmr::memory_resource* memory_;
    AlignedArray<void*> pages_;
    std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace ragtop
