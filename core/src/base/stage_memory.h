#pragma once

#include <cassert>
#include <cstddef>
#include <memory_resource>
#include <new>
#include <type_traits>

#include "base/aligned_array.h"

namespace ragtop {

/// An array of plain data in memory that is not its own, with room for a fixed number of elements.
template <class T>
class StageArray {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    StageArray() = default;
    StageArray(T* data, std::size_t room) : data_(data), room_(room) {}

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    std::size_t room() const { return room_; }
    T* data() { return data_; }
    T& operator[](std::size_t i) { return data_[i]; }
    const T& operator[](std::size_t i) const { return data_[i]; }
    T& back() { return data_[size_ - 1]; }
    T* begin() { return data_; }
    T* end() { return data_ + size_; }
    const T* begin() const { return data_; }
    const T* end() const { return data_ + size_; }

    void clear() { size_ = 0; }
    void push(const T& value) {
        assert(size_ < room_);
        ::new (static_cast<void*>(data_ + size_)) T(value);
        ++size_;
    }
    /// New elements have unspecified values.
    void resizeForOverwrite(std::size_t size) {
        assert(size <= room_);
        size_ = size;
    }

private:
    T* data_ = nullptr;
    std::size_t size_ = 0, room_ = 0;
};

/// Memory that stages of a step use one after the other, so that a world holds as much as the greediest of them and not
/// what all of them want. What a stage has taken is there until another one begins.
class StageMemory {
public:
    explicit StageMemory(std::pmr::memory_resource* memory) : bytes_(memory) {}

    /// What taking an array adds to what a stage wants.
    template <class T>
    static constexpr std::size_t bytesOf(std::size_t count) {
        return (count * sizeof(T) + kLine - 1) / kLine * kLine;
    }
    /// A stage wants so many bytes; all that was taken before is gone.
    void begin(std::size_t bytes) {
        bytes_.clear();
        bytes_.resizeForOverwrite(bytes);
        taken_ = 0;
    }
    /// Empty.
    template <class T>
    StageArray<T> take(std::size_t room) {
        std::byte* const first = bytes_.data() + taken_;
        taken_ += bytesOf<T>(room);
        assert(taken_ <= bytes_.size());
        return {reinterpret_cast<T*>(first), room};
    }
    std::size_t capacity() const { return bytes_.capacity(); }

private:
    static constexpr std::size_t kLine = 64;  ///< bytes, of a cache

    AlignedArray<std::byte> bytes_;
    std::size_t taken_ = 0;
};

}  // namespace ragtop
