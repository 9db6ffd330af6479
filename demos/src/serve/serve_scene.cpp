#include "serve_scene.h"

#include <fmt/format.h>

#include <cstdio>

#include "serve_loop.h"

namespace ragtop::live {

void serveScene(const ServeSceneOptions& options, const std::function<bool()>& stop) {
    auto stage = std::make_unique<LiveScene>(options.scene, options.world);
    for (const std::string& warning : stage->cast().warnings) fmt::print(stderr, "warning: {}\n", warning);
    ServeLoop loop(std::move(stage), {.port = options.port, .page = findPage(options.page)},
                   {.playing = options.playing});
    fmt::print("{} at http://127.0.0.1:{}/\nCtrl-C ends.\n", options.scene, loop.port());
    std::fflush(stdout);
    while (!stop()) loop.turn();
}

}  // namespace ragtop::live
