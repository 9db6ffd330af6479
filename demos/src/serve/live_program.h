#pragma once

#include "ragtop/serve.h"
#include "stage.h"

namespace ragtop::live {

/// The world of a program.
class LiveProgram : public Stage {
public:
    /// Throws std::invalid_argument when an option is not allowed.
    LiveProgram(World& world, const ServeOptions& options);

    Cast& cast() override { return cast_; }
    Tuning& tuning() override { return tuning_; }

private:
    void beforeStep(const std::vector<bool>& driven);

    ServeOptions options_;
    Tuning tuning_;
    Cast cast_;
};

}  // namespace ragtop::live
