#include "plan.h"

namespace ragtop::chart {

std::vector<Task> plan(const std::vector<const ChartScene*>& scenes, const std::vector<const Variant*>& variants,
                       Effort effort, const MeasureOptions& options) {
    std::vector<Task> tasks;
    for (const ChartScene* scene : scenes)
        for (const Variant* variant : variants)
            for (const Setting& setting : settingsOf(*variant, effort))
                tasks.push_back({scene, &caseOf(*scene), variant, pointOf(*scene, *variant, setting, options)});
    return tasks;
}

}  // namespace ragtop::chart
