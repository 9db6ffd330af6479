#pragma once

#include <cstdint>

#include "constraints/axes_block.h"
#include "constraints/joint_path.h"

namespace ragtop {

struct JointSim;

/// What the coordinates of a joint have counted: whole turns, and the way along a curve. A pose alone does not tell.
struct AxesCounts {
    CountedAngle axes[AxesBlock::kMostFree];
    PathPlace path;
};

/// When a step begins.
void keepCounts(JointSim& joint);
/// Where a step, or part of it, is taken back: as they were when it began.
void restoreCounts(JointSim& joint);

}  // namespace ragtop
