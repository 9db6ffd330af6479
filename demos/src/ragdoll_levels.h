#pragma once

#include <vector>

#include "ragdoll_trial.h"

namespace ragtop::demos {

/// Thrown, and changed from level to level of detail as it flies.
std::vector<RagdollFigure> levels(const RagdollSubject& subject, const RagdollTrialOptions& options);

}  // namespace ragtop::demos
