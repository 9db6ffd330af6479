#include "ragtop/serve.h"

#include <fmt/format.h>

#include <cstdio>

#include "live_program.h"
#include "serve_loop.h"

namespace ragtop {

struct PageView::Impl {
    live::ServeLoop loop;

    static std::optional<std::filesystem::path> given(const std::filesystem::path& page) {
        return page.empty() ? std::nullopt : std::optional(page);
    }
    Impl(World& world, const ServeOptions& options)
        : loop(std::make_unique<live::LiveProgram>(world, options),
               {.port = options.port, .page = live::findPage(given(options.page))},
               {.snapshotBytes = options.snapshotBytes, .playing = options.playing}) {}
};

PageView::PageView(World& world, const ServeOptions& options) : impl_(std::make_unique<Impl>(world, options)) {}
PageView::~PageView() = default;
PageView::PageView(PageView&&) noexcept = default;
PageView& PageView::operator=(PageView&&) noexcept = default;

int PageView::port() const { return impl_->loop.port(); }
std::string PageView::url() const { return fmt::format("http://127.0.0.1:{}/", port()); }
void PageView::update() { impl_->loop.update(); }
void PageView::updateAndWait() { impl_->loop.turn(); }

void serve(World& world, const ServeOptions& options) {
    PageView view(world, options);
    fmt::print("{} at {}\nCtrl-C ends.\n", options.name, view.url());
    std::fflush(stdout);
    while (!options.stop.stop_requested()) view.updateAndWait();
}

}  // namespace ragtop
