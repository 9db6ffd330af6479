#include <cstring>

#include "ragtop/tasks.h"
#include "ragtop/world.h"

/// A step on several threads with a modify callback. `racing` breaks the contract of callbacks: all threads write one
/// variable, as they would the same body, in every step: round contacts are always found anew. The thread sanitizer must then end the program with an error.
int main(int argc, char** argv) {
    using namespace ragtop;
    const bool racing = argc > 1 && std::strcmp(argv[1], "racing") == 0;
    World world({}, {.tasks = threadTasks(4)});
    float shared = 0;
    WorldCallbacks callbacks;
    callbacks.modify = [&](const PairInfo&, ContactSurface& surface) {
        if (racing) shared += surface.friction;
    };
    world.setCallbacks(callbacks);
    world.create(StaticBody{.shape = Box{{100, 1, 100}}, .position = {0, -1, 0}});
    for (int i = 0; i < 400; ++i)
        world.create(DynamicBody{.shape = Sphere{}, .position = {1.25 * (i % 20), 0.5, 1.25 * (i / 20)}});
    for (int i = 0; i < 20; ++i) world.step(1.0 / 60);
    return shared >= 0 ? 0 : 2;
}
