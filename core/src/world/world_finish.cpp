#include "world/world_impl.h"

namespace ragtop {

/// All but those of independent trees, which have done it.
void WorldImpl::finishBodies() {
    const bool independent = partition.direct.multirate.independentCount > 0;
    if (partition.direct.multirate.independentCount == tables.bodies.awake.size()) return;
    const BodyStage stage = bodyStage();
    machine.runner.parallelFor(static_cast<int>(tables.bodies.awake.size()), 64, [&](int begin, int end, int) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            if (!independent ||
                (partition.direct.multirate.marks[tables.bodies.awake[i]] & Multirate::kIndependent) == 0)
                stage.finish(i);
    });
}

/// Once in a step, after the last stage that reads what bears on what.
void WorldImpl::makeRoomToFinish() {
    machine.stageMemory.begin(StageMemory::bytesOf<StartPose>(tables.bodies.awake.size()));
    collision.swept.starts = machine.stageMemory.take<StartPose>(tables.bodies.awake.size());
    collision.swept.starts.resizeForOverwrite(tables.bodies.awake.size());
    collision.swept.flags.resizeForOverwrite(tables.bodies.awake.size());
}

}  // namespace ragtop
