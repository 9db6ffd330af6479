#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "ragtop/math.h"
#include "ragtop/tunables.h"

namespace ragtop {

/// Who solves the constraints of an island, bodies that joints and contacts link.
enum class SolverChoice : std::int32_t {
    automatic,  ///< iteration, and the direct solver for islands that need it
    iterative,  ///< iteration everywhere
    direct,     ///< the direct solver wherever it fits
};

/// Names in files, in the order of the values.
constexpr std::array<std::string_view, 3> enumNames(SolverChoice) { return {"automatic", "iterative", "direct"}; }

/// How a world moves. Lengths and speeds inside are relative to the size of what touches and to gravity and step, so
/// a scene of other size needs no other settings. May be changed between steps.
struct WorldSettings {
    Vec3 gravity{0, -9.81f, 0};         ///< m/s²
    int substeps = 4;                   ///< solver substeps per step
    bool sleeping = true;               ///< islands at rest cost nothing
    bool continuous = true;             ///< fast bodies do not pass through walls
    float contactFrequency = 0.125f;    ///< of soft contacts, times the substep rate
    float contactDamping = 10.0f;       ///< damping ratio of soft contacts between moving bodies
    float staticContactDamping = 5.0f;  ///< the same against static bodies, which are twice as stiff
    float jointFrequency = 0.25f;       ///< of joints, times the substep rate
    float jointDamping = 2.0f;          ///< damping ratio of joints
    float loadGain = 0.002f;            ///< share of a contact's load carried into the next step's rest point
    float staticLoadGain = 0.03f;       ///< the same against static bodies
    SolverChoice solver = SolverChoice::automatic;
    float pushOut = 0.03f;              ///< speed that an overlap adds at most to what the load takes, in sizes per step
    bool sequentialFriction = false;    ///< friction after all normal forces instead of beside each
    float restitutionSpeed = 2.0f;      ///< slowest impact that bounces, in speeds gravity gives per step
    float sleepTime = 0.5f;             ///< s at rest before an island sleeps
    float sleepSpeed = 0.02f;           ///< at rest below this, times √(gravity · size)
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const WorldSettings*) {
    visit(Tunable{"gravity", "m/s²", -1000, 1000, "acceleration of free fall"}, self.gravity);
    visit(Tunable{"substeps", "", 1, 64, "solver substeps per step"}, self.substeps);
    visit(Tunable{"sleeping", "", 0, 1, "islands at rest cost nothing"}, self.sleeping);
    visit(Tunable{"continuous", "", 0, 1, "fast bodies do not pass through walls"}, self.continuous);
    visit(Tunable{"contactFrequency", "1", 0.001, 0.25, "frequency of soft contacts over the substep rate"},
          self.contactFrequency);
    visit(Tunable{"contactDamping", "1", 0, 100, "damping ratio of contacts between moving bodies"},
          self.contactDamping);
    visit(Tunable{"staticContactDamping", "1", 0, 100, "damping ratio of contacts with static bodies"},
          self.staticContactDamping);
    visit(Tunable{"jointFrequency", "1", 0.001, 0.25, "frequency of joints over the substep rate"},
          self.jointFrequency);
    visit(Tunable{"jointDamping", "1", 0, 100, "damping ratio of joints"}, self.jointDamping);
    visit(Tunable{"loadGain", "1", 0, 0.05, "share of a contact's load carried into its rest point per step"},
          self.loadGain);
    visit(Tunable{"staticLoadGain", "1", 0, 0.05, "the same of contacts with static bodies"}, self.staticLoadGain);
    visit(
        Tunable{"solver", "", 0, 0, "who solves: chosen per island, iteration everywhere, or direct wherever it fits"},
        self.solver);
    visit(Tunable{"pushOut", "sizes/step", 0.001, 10, "largest speed that an overlap adds to what the load takes"}, self.pushOut);
    visit(Tunable{"sequentialFriction", "", 0, 1, "friction after all normal forces instead of beside each"},
          self.sequentialFriction);
    visit(Tunable{"restitutionSpeed", "g·step", 0, 1000, "slowest impact that bounces"}, self.restitutionSpeed);
    visit(Tunable{"sleepTime", "s", 0, 1000, "time at rest before an island sleeps"}, self.sleepTime);
    visit(Tunable{"sleepSpeed", "√(g·size)", 0, 10, "an island below this speed is at rest"}, self.sleepSpeed);
}

/// Empty when the settings are usable; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const WorldSettings& settings);

}  // namespace ragtop
