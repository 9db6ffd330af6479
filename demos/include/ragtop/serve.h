#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "ragtop/cloth.h"
#include "ragtop/debug_draw.h"
#include "ragtop/id.h"
#include "ragtop/ragdoll.h"
#include "ragtop/tuning.h"
#include "ragtop/vehicle.h"
#include "ragtop/world.h"

/// A world in a browser: pages show it, step and scrub it, grab, shoot, drive, plot and tune (docs/serve.md).
namespace ragtop {

/// How a program shows its world. All that it points to must outlive the serving.
struct ServeOptions {
    int port = 8080;               ///< on 127.0.0.1; 0: any free one
    std::filesystem::path page{};  ///< empty: the page that comes along
    double step = 1.0 / 60;        ///< s
    bool playing = true;           ///< from when the first page comes; false: it waits for somebody to press play
    /// Before each step. What it does must depend on the world and its time alone, or steps back are not exact; state
    /// of the program's own belongs into a StepModule. Vehicles that a page drives keep the input from there.
    std::function<void(double dt)> beforeStep{};

    std::string name = "world", description{};
    std::function<std::string(BodyId)> nameOf{};
    std::function<std::optional<Color>(BodyId)> colorOf{};  ///< empty: by the type of the body

    struct ServedVehicle {
        std::string name{};
        Vehicle* vehicle = nullptr;
        VehiclePlacement start{};  ///< where a page's reset puts it
    };
    struct ServedRagdoll {
        std::string name{};
        Ragdoll* ragdoll = nullptr;
    };
    struct ServedCloth {
        std::string name{};
        const Cloth* cloth = nullptr;
        std::optional<Color> color{};
    };
    std::vector<ServedCloth> cloths{};      ///< to look at
    std::vector<ServedVehicle> vehicles{};  ///< to drive, plot and tune
    std::vector<ServedRagdoll> ragdolls{};  ///< to tune
    /// Numbers of the program's own: addTunables(wind, "wind", "wind", options.tunables) for a described struct. They
    /// are set between steps, and set back when a page steps back.
    std::vector<TunableRef> tunables{};

    std::size_t snapshotBytes = std::size_t{512} << 20;  ///< that may be kept to step back
    std::stop_token stop{};                              ///< ends serve()
};

/// Pages that watch a world which the program steps through them:
///
///     PageView view{world, {.port = 8080}};
///     for (;;) { view.update(); … }
///
/// The world must stay where it is, and only the pages and `beforeStep` may step or change it meanwhile.
class PageView {
public:
    /// Throws std::runtime_error when the port is taken, std::invalid_argument when an option is not allowed.
    explicit PageView(World& world, const ServeOptions& options = {});
    ~PageView();
    PageView(PageView&&) noexcept;
    PageView& operator=(PageView&&) noexcept;

    int port() const;
    std::string url() const;
    /// Takes the pages' messages, makes the steps that are due in real time and sends what has changed. Does not wait.
    void update();
    /// update(), then waits until there is more to do, at most a quarter of a second.
    void updateAndWait();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Serves a world until options.stop is requested (where it cannot be: until the program ends); prints where to look.
void serve(World& world, const ServeOptions& options = {});

}  // namespace ragtop
