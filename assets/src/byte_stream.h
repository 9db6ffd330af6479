#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace ragtop {

/// Bytes that one process writes and another one, built from the same source, reads. Both are called with the same
/// fields in the same order.
class ByteWriter {
public:
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void operator()(const T& value) {
        const std::size_t at = bytes_.size();
        bytes_.resize(at + sizeof value);
        std::memcpy(bytes_.data() + at, &value, sizeof value);
    }
    void operator()(const std::string& text) {
        (*this)(static_cast<std::uint64_t>(text.size()));
        bytes_.insert(bytes_.end(), text.begin(), text.end());
    }
    template <class T>
    void operator()(const std::vector<T>& values) {
        (*this)(static_cast<std::uint64_t>(values.size()));
        if constexpr (std::is_trivially_copyable_v<T>) {
            const auto* bytes = reinterpret_cast<const char*>(values.data());
            bytes_.insert(bytes_.end(), bytes, bytes + values.size() * sizeof(T));
        } else {
            for (const T& value : values) each(value);
        }
    }
    std::vector<char> taken() && { return std::move(bytes_); }

private:
    template <class T>
    void each(const T& value) {
        if constexpr (requires { (*this)(value); })
            (*this)(value);
        else
            fields(*this, value);
    }
    std::vector<char> bytes_;
};

/// Throws std::length_error when the bytes end too early.
class ByteReader {
public:
    explicit ByteReader(const std::vector<char>& bytes) : bytes_(bytes) {}

    template <class T>
    requires std::is_trivially_copyable_v<T>
    void operator()(T& value) { std::memcpy(&value, take(sizeof value), sizeof value); }
    void operator()(std::string& text) {
        const std::size_t size = count();
        text.assign(take(size), size);
    }
    template <class T>
    void operator()(std::vector<T>& values) {
        const std::size_t size = count();
        values.clear();
        if constexpr (std::is_trivially_copyable_v<T>) {
            const char* from = take(size, sizeof(T));
            values.resize(size);
            if (size > 0) std::memcpy(values.data(), from, size * sizeof(T));
        } else {
            for (std::size_t i = 0; i < size; ++i) each(values.emplace_back());
        }
    }
    bool atEnd() const { return at_ == bytes_.size(); }

private:
    template <class T>
    void each(T& value) {
        if constexpr (requires { (*this)(value); })
            (*this)(value);
        else
            fields(*this, value);
    }
    /// Every element has at least one byte, so a count beyond what is left is wrong.
    std::size_t count() {
        std::uint64_t value = 0;
        (*this)(value);
        if (value > bytes_.size() - at_) throw std::length_error("count");
        return static_cast<std::size_t>(value);
    }
    const char* take(std::size_t count, std::size_t each = 1) {
        if (count > (bytes_.size() - at_) / each) throw std::length_error("bytes");
        const char* from = bytes_.data() + at_;
        at_ += count * each;
        return from;
    }
    const std::vector<char>& bytes_;
    std::size_t at_ = 0;
};

}  // namespace ragtop
