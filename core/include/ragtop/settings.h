#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "ragtop/math.h"
#include "ragtop/tunables.h"

namespace ragtop {

/// How islands are solved: groups of moving bodies that contacts and joints connect.
enum class SolverChoice : std::int32_t {
    automatic,  ///< by iteration, and directly where iteration would not hold (docs/adr/0016)
    iterative,  ///< by iteration everywhere
    direct,     ///< directly wherever an island is small enough
};

/// Names in files, in the order of the values.
constexpr std::array<std::string_view, 3> enumNames(SolverChoice) { return {"automatic", "iterative", "direct"}; }

/// How a world moves. Tolerances inside are shares of the size of what touches, of gravity and of the step, so a scene
/// of another size needs no other settings. May be changed between steps.
struct WorldSettings {
    Vec3 gravity{0, -9.81f, 0};         ///< m/s²
    int substeps = 4;                   ///< solver substeps per step
    bool sleeping = true;               ///< islands at rest fall asleep and cost nothing
    bool continuous = true;             ///< fast bodies do not pass through walls
    float contactFrequency = 0.125f;    ///< of soft contacts, over the substep rate
    float contactDamping = 10.0f;       ///< damping ratio of soft contacts between moving bodies
    float staticContactDamping = 5.0f;  ///< the same against fixed bodies, with twice the frequency
    float jointFrequency = 0.25f;       ///< of joints, over the substep rate
    float jointDamping = 2.0f;          ///< damping ratio of joints
    float loadGain = 0.002f;            ///< share of λ − λ̂ by which the load λ̂ of a contact follows its impulse per step
    float staticLoadGain = 0.03f;       ///< the same against fixed bodies, at most
    SolverChoice solver = SolverChoice::automatic;
    /// Largest speed that an overlap adds to what the load takes, sizes per step; at most ½ √(gravity · size).
    float pushOut = 0.03f;
    bool sequentialFriction = false;    ///< friction after the normal rows of all contacts, not after those of each
    float restitutionSpeed = 2.0f;      ///< slowest impact that bounces, over gravity · step
    float sleepTime = 0.5f;             ///< s that an island must be at rest before it sleeps
    float sleepSpeed = 0.02f;           ///< a body is at rest below this speed, over √(gravity · size)
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
    visit(Tunable{"solver", "", 0, 0, "how islands are solved: chosen for each, by iteration, or directly"},
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
