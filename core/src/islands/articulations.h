#pragma once

#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"
#include "contacts/tables.h"
#include "islands/direct_set.h"

namespace ragtop {

/// Bodies that joints hold together, and nothing else holds: they fly as one body does, and joints of those that are
/// small free trees close without a leak. They outlive the step while joints, the bodies that are awake and the direct
/// islands stay the same.
class Articulations {
public:
    explicit Articulations(std::pmr::memory_resource* memory)
        : bodies_(memory),
          starts_(memory),
          masses_(memory),
          parent_(memory),
          place_(memory),
          jointCount_(memory),
          isFreeTree_(memory) {}

    /// Joints, the bodies that are awake or the direct islands have changed.
    void forget() { known_ = false; }
    /// Finds them anew if they were forgotten.
    void find(const ConstTables& tables, const DirectSet& direct);
    /// They were found in this step.
    bool areFresh() const { return fresh_; }

    std::size_t count() const { return starts_.empty() ? 0 : starts_.size() - 1; }
    std::uint32_t firstBody(std::size_t articulation) const { return bodies_[starts_[articulation]]; }
    /// Tells a joint what it is a part of.
    void classify(const ConstTables& tables, std::uint32_t joint, JointSim& sim) const;
    /// The position map of integratePositions for the common motion of one: its centre of mass moves by h v − ½ h² a
    /// with the smooth part of its acceleration, and all its bodies alike, so that no joint is strained.
    void move(std::uint32_t articulation, float h, Bodies& bodies) const;

private:
    void list(const ConstTables& tables);
    void countJoints(const ConstTables& tables);
    bool isOfFreeTree(const ConstTables& tables, std::uint32_t joint) const;

    AlignedArray<std::uint32_t> bodies_, starts_;          ///< members; where those of each begin, and the end
    AlignedArray<float> masses_;                           ///< kg, of the members
    AlignedArray<std::uint32_t> parent_, place_;           ///< per body, of those awake; 0: held by the world
    AlignedArray<std::uint32_t> jointCount_, isFreeTree_;  ///< per body that is a parent of itself
    bool known_ = false, fresh_ = false;
};

}  // namespace ragtop
