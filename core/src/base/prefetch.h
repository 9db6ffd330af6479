#pragma once

namespace ragtop {

/// Asks for the cache line that holds an address. To g++ 12 a function that only asks is pure, and calls whose result
/// nobody uses go; the empty statement keeps them.
inline void prefetch(const void* address) {
    __builtin_prefetch(address);
    asm volatile("");
}

}  // namespace ragtop
