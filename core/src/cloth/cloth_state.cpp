#include "cloth/cloth_state.h"

#include <cstring>
#include <type_traits>

#include "base/hash.h"

namespace ragtop::cloth {
namespace {

/// Calls visit(value) for everything that is saved, as plain memory.
template <class Sim, class Visit>
void visitState(Sim& sim, Visit&& visit) {
    auto& state = sim.state;
    visit(state.origin);
    for (std::size_t i = 0; i < index(sim.count); ++i) {
        visit(state.points[i].place);
        visit(state.velocities[i].v);
        visit(state.leaves[i]);
    }
    for (auto& held : state.held) {
        visit(held.id);
        visit(held.fixed);
    }
    visit(state.wind);
    visit(state.quiet);
    visit(state.awake);
    visit(state.follows);
    for (auto* list : {&state.skinFrom, &state.skinTo})
        for (auto& place : *list) visit(place);
    for (auto& normal : state.skinNormals) visit(normal);
}

}  // namespace

std::size_t saveSize(const ClothSim& sim) {
    std::size_t size = sizeof sim.digest;
    visitState(sim, [&](const auto& value) { size += sizeof value; });
    return size;
}

void save(const ClothSim& sim, std::span<std::byte> into) {
    std::byte* to = into.data();
    const auto put = [&](const auto& value) {
        static_assert(std::is_trivially_copyable_v<std::remove_cvref_t<decltype(value)>>);
        std::memcpy(to, &value, sizeof value);
        to += sizeof value;
    };
    put(sim.digest);
    visitState(sim, put);
}

bool fits(const ClothSim& sim, std::span<const std::byte> from) {
    std::uint64_t digest = 0;
    std::memcpy(&digest, from.data(), sizeof digest);
    return digest == sim.digest;
}

void restore(ClothSim& sim, std::span<const std::byte> from) {
    const std::byte* at = from.data() + sizeof sim.digest;
    visitState(sim, [&](auto& value) {
        std::memcpy(&value, at, sizeof value);
        at += sizeof value;
    });
    findBlocks(sim);
}

std::uint64_t hashOf(const ClothSim& sim) {
    StateHash hash;
    visitState(sim, [&](const auto& value) { hash.add(value); });
    return hash.value();
}

}  // namespace ragtop::cloth
