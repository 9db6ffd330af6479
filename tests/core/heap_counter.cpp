#include "heap_counter.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

// Replaces the global operators of the program; in a file of its own, so that no compiler sees one half inlined.
namespace {

std::atomic<long> calls{0};

void* countedAllocate(std::size_t size, std::size_t alignment) {
    calls.fetch_add(1, std::memory_order_relaxed);
    const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
    void* memory = std::aligned_alloc(alignment, rounded > 0 ? rounded : alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

long ragtop::heapCalls() { return calls.load(std::memory_order_relaxed); }

void* operator new(std::size_t size) { return countedAllocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    return countedAllocate(size, static_cast<std::size_t>(alignment));
}
// The standard library's would call the above; a sanitizer's would not, and then meet our delete.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept try {
    return countedAllocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
} catch (const std::bad_alloc&) {
    return nullptr;
}
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
