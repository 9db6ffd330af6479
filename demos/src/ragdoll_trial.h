#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "ragdoll_subject.h"

/// What a good ragdoll does, measured.
namespace ragtop::demos {

struct RagdollFigure {
    std::string test, name;  ///< the name ends with its unit: _m, _deg, _m_s, _j, _n, _n_m, _ratio, _share
    double value = 0, bound = 0;
    bool atLeast = false;  ///< the bound is the least allowed, else the most
    std::string where{};   ///< of the worst: seed, limb, joint, time

    bool passes() const { return atLeast ? value >= bound : value <= bound; }
};

struct RagdollTrialOptions {
    int seeds = 100;
    double hz = 60;       ///< steps a second
    float push = 300;     ///< N s
    float stroke = 1;     ///< m, by which `shake` moves the hand up and down from the middle
    float shakeRate = 1;  ///< Hz
    std::string clip{};   ///< that `track` follows; empty: the first that walks, else the first
};

struct RagdollTest {
    std::string_view name, meaning;
    std::vector<RagdollFigure> (*run)(const RagdollSubject&, const RagdollTrialOptions&);
};

/// All tests, in the order in which they run.
const std::vector<RagdollTest>& ragdollTests();

}  // namespace ragtop::demos
