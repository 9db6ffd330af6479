#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/tunables.h"

/// Structs as bytes, one field after the other in the order of their `describe` (ragtop/tunables.h): numbers, enums and
/// truth values as they are in memory (little-endian); an optional one a byte that says whether it follows; a list or
/// a text its length in 4 bytes and then its elements.
namespace ragtop {

template <class T>
inline constexpr bool kIsPlain = std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, Vec3> ||
                                 std::is_same_v<T, Quat> || std::is_same_v<T, Frame>;
static_assert(sizeof(Vec3) == 12 && sizeof(Quat) == 16 && sizeof(Frame) == 28, "they are read as they lie");

/// Appends fields to bytes.
class FieldWriter {
public:
    template <class T>
    void operator()(const Tunable&, const T& field) {
        put(field);
    }

    template <class T>
    void put(const T& field) {
        if constexpr (kIsPlain<T>) {
            append(&field, sizeof field);
        } else {
            putFields(field);
        }
    }
    void put(const std::string& text) {
        put(static_cast<std::uint32_t>(text.size()));
        append(text.data(), text.size());
    }
    template <class T>
    void put(const std::optional<T>& field) {
        put(static_cast<std::uint8_t>(field.has_value()));
        if (field) put(*field);
    }
    template <class T, std::size_t N>
    void put(const std::array<T, N>& fields) {
        for (const T& field : fields) put(field);
    }
    template <class T>
    void put(const std::vector<T>& fields) {
        put(static_cast<std::uint32_t>(fields.size()));
        if constexpr (kIsPlain<T>)
            append(fields.data(), fields.size() * sizeof(T));
        else
            for (const T& field : fields) put(field);
    }

    std::vector<std::byte> bytes;

private:
    void append(const void* from, std::size_t size) {
        const auto* first = static_cast<const std::byte*>(from);
        bytes.insert(bytes.end(), first, first + size);
    }
    template <class T>
    void putFields(const T& field) {
        describe(*this, field, static_cast<const T*>(nullptr));
    }
};

/// Takes them off again. Throws std::invalid_argument where the bytes end too soon, or a number cannot be what it is
/// for.
class FieldReader {
public:
    explicit FieldReader(std::span<const std::byte> bytes) : left_(bytes) {}

    template <class T>
    void operator()(const Tunable&, T& field) {
        get(field);
    }

    template <class T>
    void get(T& field) {
        if constexpr (std::is_same_v<T, bool>) {
            field = flag();
        } else if constexpr (kIsPlain<T>) {
            std::memcpy(static_cast<void*>(&field), take(sizeof field), sizeof field);
            if constexpr (requires { enumNames(T{}); })
                if (static_cast<std::size_t>(field) >= enumNames(T{}).size())
                    throw std::invalid_argument("has a choice that there is not");
        } else {
            describe(*this, field, static_cast<const T*>(nullptr));
        }
    }
    void get(std::string& text) {
        const std::size_t size = count(1);
        text.assign(reinterpret_cast<const char*>(take(size)), size);
    }
    template <class T>
    void get(std::optional<T>& field) {
        field.reset();
        if (flag()) get(field.emplace());
    }
    template <class T, std::size_t N>
    void get(std::array<T, N>& fields) {
        for (T& field : fields) get(field);
    }
    template <class T>
    void get(std::vector<T>& fields) {
        if constexpr (kIsPlain<T>) {
            fields.resize(count(sizeof(T)));
            if (!fields.empty())
                std::memcpy(static_cast<void*>(fields.data()), take(fields.size() * sizeof(T)),
                            fields.size() * sizeof(T));
        } else {
            fields.resize(count(1));
            for (T& field : fields) get(field);
        }
    }
    template <class T>
    T take() {
        T field{};
        get(field);
        return field;
    }
    /// The length of a list whose elements have at least so many bytes.
    std::size_t count(std::size_t least) {
        const auto size = take<std::uint32_t>();
        if (size > left_.size() / least) throw std::invalid_argument("has a list that is longer than it");
        return size;
    }
    std::span<const std::byte> bytes(std::size_t size) { return {take(size), size}; }
    std::size_t left() const { return left_.size(); }

private:
    bool flag() {
        const auto value = take<std::uint8_t>();
        if (value > 1) throw std::invalid_argument("has a truth value that is neither 0 nor 1");
        return value == 1;
    }
    const std::byte* take(std::size_t size) {
        if (size > left_.size()) throw std::invalid_argument("ends too soon");
        const std::byte* at = left_.data();
        left_ = left_.subspan(size);
        return at;
    }

    std::span<const std::byte> left_;
};

}  // namespace ragtop
