#pragma once

#include <cstdint>
#include <span>

#include "contacts/narrow_phase.h"
#include "contacts/shape_bounds.h"
#include "continuous/meetings.h"
#include "events/contact_events.h"
#include "islands/direct_view.h"
#include "iteration/iteration.h"
#include "model/indices.h"
#include "model/joint_bodies.h"
#include "world/body_stage.h"
#include "world/multirate.h"
#include "world/world_parts.h"
#include "world/world_regions.h"

namespace ragtop {

/// A world: its parts, and the step itself. It alone knows all systems; these know what the step hands them. Between
/// two calls every fact of World::validate holds.
struct WorldImpl {
    WorldImpl(const WorldSettings& worldSettings, const WorldConfig& config);

    void step(World& world, double dt);
    void setVelocity(std::uint32_t body, const Vec3& linear, const Vec3& angular);
    /// Whether a body can be given what is finite or not; what is not throws, but not within a step.
    bool takes(bool finite, const char* what);

    // world_state.cpp
    template <class Archive>
    void archive(Archive& archive);
    void forgetDerived();
    std::uint64_t hash() const;

    /// Of the stages before poses move; those after them give the poses of the beginning.
    GhostView ghostView(std::span<const StartPose> starts = {}) const;
    // What systems are handed that read and write several tables (world_views.cpp).
    ShapeBounds shapeBounds();
    ContactWriter contactWriter();
    NarrowPhase narrowPhase();
    Activity activity();
    Scene scene();
    DirectView directView();
    Iteration iteration();
    ContactEvents contactEvents();
    BodyStage bodyStage();
    GuardView guardView();
    ClosingView closingView();
    MultirateView multirateView();
    RegionView regionView();

    WorldSettings settings;
    WorldCallbacks callbacks;
    Machine machine;
    Tables tables;
    Collision collision;
    Partition partition;
    EventLog events;
    StepClock clock;
    ModuleWork moduleWork;
    Solving solving;
    Guards guards;
    Reports reports;

private:
    // The stages of a step that are not those of one system.
    void beginStep(World& world, double dt);
    void updatePairs(const Activity& active, bool longer);
    void createPairs(const Activity& active, bool obstaclesToo);
    void updateContacts();
    void chooseSolvers(const Activity& active, const DirectView& direct);
    void prepareBodies();
    void solveSubsteps(World& world, const DirectView& direct, const Iteration& iterate);
    void endSolve(const DirectView& direct, const Iteration& iterate);
    void makeRoomToFinish();
    void finishBodies();
    void stopOutOfRange();
    void sweepFast();
    void mendPoses();
    void endStep(World& world, double dt);
};

}  // namespace ragtop
