#include <dlfcn.h>

#include "../engine.h"

namespace ragtop::stability {

std::unique_ptr<Engine> makeBulletDouble(const Scene& scene, const BulletOptions& options) {
    using Make = Engine* (*)(const Scene*, const BulletOptions*);
    static const Make make = [] {
        // Its own names come before those of the single precision that this program has.
        void* module = ::dlopen(RAGTOP_BULLET_DOUBLE, RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
        void* function = module ? ::dlsym(module, "ragtopMakeBulletDouble") : nullptr;
        if (!function) throw Missing(::dlerror());
        return reinterpret_cast<Make>(function);
    }();
    return std::unique_ptr<Engine>(make(&scene, &options));
}

}  // namespace ragtop::stability
