#pragma once

#include <cstddef>
#include <memory_resource>

namespace ragtop::test {

/// Tells how much is held, the most that ever was, and how often it was asked.
class CountedMemory : public std::pmr::memory_resource {
public:
    std::size_t held = 0, peak = 0;  ///< bytes
    long calls = 0;

private:
    void* do_allocate(std::size_t bytes, std::size_t alignment) override {
        held += bytes;
        peak = held > peak ? held : peak;
        ++calls;
        return std::pmr::new_delete_resource()->allocate(bytes, alignment);
    }
    void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
        held -= bytes;
        std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
    }
    bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
};

}  // namespace ragtop::test
