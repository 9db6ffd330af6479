#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <type_traits>
#include <utility>

namespace ragtop {

/// A growing array of plain data on a caller's memory resource, aligned for the widest lanes. New elements are zero
/// bytes or a given value. Its memory is its value, so that a world is saved by copying. It grows by its own size while
/// that is small, and by a sixteenth of it where the rest would count.
template <class T>
class AlignedArray {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    explicit AlignedArray(std::pmr::memory_resource* memory) : memory_(memory) {}
    AlignedArray(AlignedArray&& other) noexcept
        : memory_(other.memory_), data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)),
          capacity_(std::exchange(other.capacity_, 0)) {}
    AlignedArray(const AlignedArray&) = delete;
    AlignedArray& operator=(const AlignedArray&) = delete;
    AlignedArray& operator=(AlignedArray&&) = delete;
    ~AlignedArray() {
        if (data_) memory_->deallocate(data_, capacity_ * sizeof(T), kAlignment);
    }

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    T* data() { return data_; }
    const T* data() const { return data_; }
    T& operator[](std::size_t i) { return data_[i]; }
    const T& operator[](std::size_t i) const { return data_[i]; }
    T* begin() { return data_; }
    T* end() { return data_ + size_; }
    const T* begin() const { return data_; }
    const T* end() const { return data_ + size_; }
    T& back() { return data_[size_ - 1]; }
    std::size_t capacity() const { return capacity_; }
    std::size_t bytes() const { return capacity_ * sizeof(T); }
    bool isLarge() const { return bytes() >= kLarge; }

    void reserve(std::size_t capacity) {
        if (capacity <= capacity_) return;
        if (size_ == 0) release();
        T* grown = static_cast<T*>(memory_->allocate(capacity * sizeof(T), kAlignment));
        if (size_ > 0) std::memcpy(static_cast<void*>(grown), data_, size_ * sizeof(T));
        if (data_) memory_->deallocate(data_, capacity_ * sizeof(T), kAlignment);
        data_ = grown;
        capacity_ = capacity;
    }
    /// New elements are `value`.
    void resize(std::size_t size, const T& value) {
        if (size > capacity_) reserve(grownFor(size));
        for (std::size_t i = size_; i < size; ++i) ::new (static_cast<void*>(data_ + i)) T(value);
        size_ = size;
    }
    /// New elements have unspecified values; for memory that is overwritten at once.
    void resizeForOverwrite(std::size_t size) {
        if (size > capacity_) reserve(grownFor(size));
        size_ = size;
    }
    void push(const T& value) {
        if (size_ == capacity_) {
            const T copy = value;
            reserve(grownFor(size_ + 1));
            ::new (static_cast<void*>(data_ + size_)) T(copy);
        } else {
            ::new (static_cast<void*>(data_ + size_)) T(value);
        }
        ++size_;
    }
    void pop() { --size_; }
    void clear() { size_ = 0; }
    /// Gives all memory back.
    void release() {
        if (data_) memory_->deallocate(data_, bytes(), kAlignment);
        data_ = nullptr;
        size_ = capacity_ = 0;
    }

private:
    static constexpr std::size_t kAlignment = 64;  ///< bytes, a cache line and a vector of 16 floats
    static constexpr std::size_t kFew = 16, kLarge = std::size_t{1} << 20;  ///< elements, bytes

    std::size_t grownFor(std::size_t size) const {
        const std::size_t more = isLarge() ? capacity_ / 16 : capacity_;
        const std::size_t grown = capacity_ + more > kFew ? capacity_ + more : kFew;
        return grown > size ? grown : size;
    }

    std::pmr::memory_resource* memory_;
    T* data_ = nullptr;
    std::size_t size_ = 0, capacity_ = 0;
};

/// Indices with generations: the place of a destroyed object is used again under another generation.
class Slots {
public:
    explicit Slots(std::pmr::memory_resource* memory) : generations_(memory), free_(memory) {}

    std::uint32_t acquire() {
        if (!free_.empty()) {
            const std::uint32_t index = free_.back();
            free_.pop();
            ++generations_[index];
            return index;
        }
        generations_.push(1);
        return static_cast<std::uint32_t>(generations_.size() - 1);
    }
    /// What is in use has been moved to the first `used` indices: the rest is free.
    void compact(std::uint32_t used) {
        free_.clear();
        for (std::uint32_t i = 0; i < count(); ++i) generations_[i] = i < used ? 1 : 2;
        for (std::uint32_t i = count(); i > used; --i) free_.push(i - 1);
    }
    /// Odd generations are in use, even ones free.
    void release(std::uint32_t index) {
        ++generations_[index];
        free_.push(index);
    }
    bool isUsed(std::uint32_t index) const { return index < generations_.size() && (generations_[index] & 1) != 0; }
    bool isValid(std::uint32_t index, std::uint32_t generation) const {
        return isUsed(index) && generations_[index] == generation;
    }
    std::uint32_t generation(std::uint32_t index) const { return generations_[index]; }
    std::uint32_t count() const { return static_cast<std::uint32_t>(generations_.size()); }
    std::uint32_t used() const { return static_cast<std::uint32_t>(generations_.size() - free_.size()); }

    template <class Archive>
    void archive(Archive& archive) {
        archive(generations_);
        archive(free_);
    }

private:
    AlignedArray<std::uint32_t> generations_;
    AlignedArray<std::uint32_t> free_;
};

}  // namespace ragtop
