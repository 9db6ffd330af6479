#pragma once

#include <memory>

namespace ragtop {

/// How a world uses threads: one function that runs `count` tasks, possibly at once, and returns when all have ended. A
/// game's job system is wrapped in it. Tasks may start late, or only after others have ended. Results do not depend on
/// it. Calls never nest. What a runner must keep is in docs/threading.md.
struct TaskRunner {
    using Task = void (*)(void* context, int index);

    int workers = 1;  ///< tasks that may run at once, the calling thread's included; 1 to 64
    void (*run)(void* user, int count, Task task, void* context) = nullptr;  ///< null: a loop on the calling thread
    void* user = nullptr;
    std::shared_ptr<void> keepAlive;  ///< owner of `user`, released with the world
};

/// Everything on the calling thread.
TaskRunner serialTasks();
/// Threads of oneTBB, in an arena of `workers`. Falls back to threadTasks where the library was built without it.
TaskRunner tbbTasks(int workers);
/// `workers` − 1 own threads that sleep between steps, and the calling one.
TaskRunner threadTasks(int workers);

}  // namespace ragtop
