#pragma once

#include <cstddef>

#include "constraints/contact_layout.h"

namespace ragtop {

/// One contact at a time in the first lane of a bundle of its own, for kernels that must not meet two contacts of a
/// body in one bundle, as the direct list has them.
class SingleBundle {
public:
    explicit SingleBundle(int lanes) : stride_(static_cast<std::size_t>(lanes)) {}

    /// kernel(bundles, begin, end) on a copy of the lane, which is written back.
    template <class Kernel>
    void visit(float* lane, Kernel&& kernel) {
        for (std::size_t f = 0; f < contact::kFields; ++f) fields_[f * stride_] = lane[f * stride_];
        kernel(static_cast<float*>(fields_), 0, 1);
        for (std::size_t f = 0; f < contact::kFields; ++f) lane[f * stride_] = fields_[f * stride_];
    }

private:
    static constexpr std::size_t kMostLanes = 16;  ///< of KernelTable
    std::size_t stride_;
    alignas(64) float fields_[contact::kFields * kMostLanes] = {};
};

}  // namespace ragtop
