#pragma once

#include <vector>

#include "ragtop/body_pose.h"
#include "ragtop/inverse_dynamics.h"
#include "ragtop/muscles.h"

/// A human that breaks its fall.
namespace ragtop {

/// Reaches with both arms for the ground where the body is about to meet it, gives way in the knees and keeps the head
/// away from it: the chin in when falling backwards, up when falling forwards. By the joints alone, as Balance does it.
/// World, ragdoll and muscles must outlive it and stay where they are. Steps neither throw nor allocate.
class Brace {
public:
    /// Throws std::invalid_argument where the body has no chest or no two arms.
    Brace(World& world, const Ragdoll& ragdoll, Muscles& muscles);

    /// Sets targets and gains of all muscles for the next step of the world, of a body that falls.
    void step();
    /// Gives the gains of the muscles back to their profile.
    void release();

private:
    World* world_;
    const Ragdoll* ragdoll_;
    Muscles* muscles_;
    BodyAxes axes_;
    InverseDynamics dynamics_;
    int chest_ = -1;
    std::vector<Quat> turns_;
    std::vector<int> joints_;  ///< of the arms
};

}  // namespace ragtop
