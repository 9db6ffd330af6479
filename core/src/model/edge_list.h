#pragma once

#include <cstdint>

#include "model/records.h"

/// Lists of what hangs on a body, through the edges of records, one per side.
namespace ragtop {

template <class Records>
void link(Records& records, std::uint32_t& first, std::uint32_t key) {
    Edge& edge = records[key >> 1].edges[key & 1];
    edge = {kNone, first};
    if (first != kNone) records[first >> 1].edges[first & 1].previous = key;
    first = key;
}

template <class Records>
void unlink(Records& records, std::uint32_t& first, std::uint32_t key) {
    const Edge edge = records[key >> 1].edges[key & 1];
    if (edge.previous != kNone) records[edge.previous >> 1].edges[edge.previous & 1].next = edge.next;
    if (edge.next != kNone) records[edge.next >> 1].edges[edge.next & 1].previous = edge.previous;
    if (first == key) first = edge.next;
}

}  // namespace ragtop
