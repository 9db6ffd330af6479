#pragma once

#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"
#include "base/paged_array.h"
#include "constraints/joint_sim.h"

namespace ragtop {

/// The solver's joints of a world by number, each where it stays: those of kinds with axes, which are seldom and three
/// times as large, beside the others.
class JointSims {
public:
    explicit JointSims(std::pmr::memory_resource* memory)
        : slots_(memory), at_(memory), plain_(memory), withAxes_(memory) {}

    std::size_t size() const { return at_.size(); }
    JointSim& operator[](std::size_t joint) { return *at_[joint]; }
    const JointSim& operator[](std::size_t joint) const { return *at_[joint]; }
    JointSim* const* data() const { return at_.data(); }
    std::size_t bytes() const {
        return slots_.bytes() + at_.bytes() + plain_.joints.bytes() + plain_.free.bytes() + withAxes_.joints.bytes() +
               withAxes_.free.bytes();
    }

    /// Room for a joint of the kind, with all values as they are declared; its definitions keep the kind.
    void acquire(std::uint32_t joint, JointKind kind) {
        if (joint >= slots_.size()) slots_.resize(joint + 1, kNoJointSlot), at_.resize(joint + 1, nullptr);
        const auto first = [&] { return hasAxes(kind) ? withAxes_.first() : plain_.first(); };
        const void* before = first();
        slots_[joint] = hasAxes(kind) ? 2 * withAxes_.acquire() + 1 : 2 * plain_.acquire();
        if (first() != before)
            place();
        else
            at_[joint] = find(slots_[joint]);
    }
    void release(std::uint32_t joint) {
        const std::uint32_t slot = slots_[joint];
        (slot % 2 != 0 ? withAxes_.free : plain_.free).push(slot / 2);
        slots_[joint] = kNoJointSlot;
        at_[joint] = nullptr;
    }
    template <class Archive>
    void archive(Archive& archive) {
        archive(slots_);
        plain_.archive(archive);
        withAxes_.archive(archive);
        place();
    }

private:
    static constexpr std::uint32_t kNoJointSlot = 0xffffffffu;  ///< of a number that no joint has

    template <class Sim>
    struct Pool {
        explicit Pool(std::pmr::memory_resource* memory) : joints(memory), free(memory) {}
        /// The first page moves as it grows, and all that are there with it; none does later.
        const void* first() const { return joints.empty() ? nullptr : &joints[0]; }
        std::uint32_t acquire() {
            if (!free.empty()) {
                const std::uint32_t index = free.back();
                free.pop();
                joints[index] = Sim{};
                return index;
            }
            joints.resize(joints.size() + 1, Sim{});
            return static_cast<std::uint32_t>(joints.size() - 1);
        }
        template <class Archive>
        void archive(Archive& archive) {
            archive(joints);
            archive(free);
        }
        PagedArray<Sim> joints;
        AlignedArray<std::uint32_t> free;
    };

    JointSim* find(std::uint32_t slot) {
        if (slot == kNoJointSlot) return nullptr;
        return slot % 2 != 0 ? &withAxes_.joints[slot / 2] : &plain_.joints[slot / 2];
    }
    void place() {
        at_.resizeForOverwrite(slots_.size());
        for (std::size_t joint = 0; joint < slots_.size(); ++joint) at_[joint] = find(slots_[joint]);
    }

    AlignedArray<std::uint32_t> slots_;  ///< 2 · index + 1 of those with axes, 2 · index of others
    AlignedArray<JointSim*> at_;         ///< derived
    Pool<JointSim> plain_;
    Pool<AxesJointSim> withAxes_;
};

}  // namespace ragtop
