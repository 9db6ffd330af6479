#pragma once

namespace ragtop {

/// How often this program has asked the heap for memory in the ways of C++, on any thread.
long heapCalls();

}  // namespace ragtop
