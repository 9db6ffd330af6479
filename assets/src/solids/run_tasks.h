#pragma once

#include <cstddef>

#include "ragtop/tasks.h"

namespace ragtop {

/// Calls a function with every number below `count`, possibly at once.
template <class Function>
void runTasks(const TaskRunner& tasks, std::size_t count, Function&& function) {
    if (!tasks.run) {
        for (std::size_t i = 0; i < count; ++i) function(i);
        return;
    }
    const auto task = [](void* user, int index) { (*static_cast<Function*>(user))(static_cast<std::size_t>(index)); };
    tasks.run(tasks.user, static_cast<int>(count), task, &function);
}

}  // namespace ragtop
