#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ragdoll_trial.h"

namespace ragtop::demos {

struct RagdollCommand {
    std::string asset;
    std::vector<std::string> tests;  ///< names of ragdollTests(); empty: all
    std::string clips;               ///< another character, whose clips come first; empty: none
    bool holding = false;            ///< motors of a robot hold every joint
    RagdollTrialOptions trial;
    std::optional<std::string> json;  ///< file of the figures
    std::optional<std::string> out;   ///< file of the ragdoll, to be edited; then only the tests that are named
};

/// Puts a ragdoll file, a character or a robot to the tests and prints one line per figure with its bound; true when
/// all are within theirs. Throws AssetError on bad input.
bool testRagdoll(const RagdollCommand& command);

}  // namespace ragtop::demos
