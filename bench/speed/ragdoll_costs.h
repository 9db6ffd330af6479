#pragma once

#include <string>
#include <vector>

namespace ragtop::speed {

/// What ragdolls and their secondary motion cost, beside what they are to cost.
struct RagdollCost {
    std::string name;
    double value = 0;
    std::string unit;
    double bound = 0;      ///< of the value
    bool atLeast = false;  ///< or else at most
    bool holds() const { return atLeast ? value >= bound : value <= bound; }
};

/// The rows of docs/speed.md#ragdolls, on one thread by the processor's time but where the name says otherwise. Those
/// that are timed again and again are the medians of `runs`.
std::vector<RagdollCost> measureRagdolls(int runs);

std::string costLine(const RagdollCost& cost);
/// A list of objects.
std::string toJson(const std::vector<RagdollCost>& costs);

}  // namespace ragtop::speed
