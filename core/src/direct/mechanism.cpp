// RATTLE steps of a mechanism, see mechanism.h: half of the outside impulses; impulses along the Jacobian of the
// beginning such that the joints are closed at the end (Newton's method with the factor of the velocities before);
// free rotation; the other half; impulses along the Jacobian of the end such that the rows have no speed. Pace is in
// mechanism_pace.cpp, rows are in mechanism_rows.cpp.

#include "direct/mechanism.h"

#include <cmath>

#include "direct/joint_tuning.h"

namespace ragtop::direct {

namespace {

constexpr int kRounds = 8;              ///< solves per inner step that positions may take
constexpr double kClosed = 1e-9;        ///< error of a joint that is none, in the longest arm
constexpr double kProgress = 0.9;       ///< share of the error that a solve may leave
constexpr double kAlmostClosed = 1e-4;  ///< error that may be left where a mechanism is nearly singular
constexpr int kStillRounds = 4;         ///< solves per inner step that velocities may take
constexpr double kStill = 1e-11;        ///< speed of a row that is none, in longest arms per inner step

}  // namespace

Mechanism::Mechanism(std::pmr::memory_resource* memory)
    : bodies_(memory),
      startBodies_(memory),
      poses_(memory),
      next_(memory),
      startPoses_(memory),
      joints_(memory),
      places_(memory),
      rows_(memory),
      errors_(memory),
      aims_(memory),
      inertia_(memory),
      inverseInertia_(memory),
      moveImpulses_(memory),
      restImpulses_(memory),
      change_(memory),
      velocities_(memory),
      pairs_(memory),
      factor_(memory) {}

void Mechanism::resize(std::size_t moving, std::size_t others, std::size_t joints) {
    moving_ = moving;
    const std::size_t all = moving + others;
    bodies_.resizeForOverwrite(all);
    poses_.resizeForOverwrite(all);
    next_.resizeForOverwrite(all);
    startPoses_.resizeForOverwrite(all);
    startBodies_.resizeForOverwrite(moving);
    velocities_.resizeForOverwrite(all);
    for (AlignedArray<DSym3>* array : {&inertia_, &inverseInertia_}) array->resizeForOverwrite(moving);
    for (AlignedArray<Twist>* array : {&moveImpulses_, &restImpulses_, &change_}) array->resizeForOverwrite(moving);
    joints_.resizeForOverwrite(joints);
    places_.resizeForOverwrite(joints);
}

void Mechanism::begin() {
    static_assert(static_cast<int>(MechanismJointKind::fixed) == 2);
    constexpr std::uint32_t kRowCounts[] = {3, 5, 6};
    std::uint32_t rows = 0;
    reach_ = 0;
    pairs_.clear();
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const MechanismJoint& joint = joints_[j];
        Place& place = places_[j];
        place = {rows, kRowCounts[static_cast<int>(joint.kind)], 0, joint.a < moving_, joint.b < moving_};
        rows += place.rowCount;
        if (place.movesA && place.movesB) pairs_.push({joint.a, joint.b});
        for (const DVec3* arm : {&joint.anchorA, &joint.anchorB})
            if (const double r = length(*arm); r > reach_) reach_ = r;
    }
    rows_.resizeForOverwrite(rows);
    errors_.resizeForOverwrite(rows);
    aims_.resizeForOverwrite(rows);
    for (const Place& place : places_)
        for (std::uint32_t k = 0; k < place.rowCount; ++k) rows_[place.firstRow + k].unit = k < 3 ? 1 : reach_;
    factor_.update(static_cast<std::uint32_t>(moving_), pairs_.data(), pairs_.size());
    for (std::size_t j = 0; j < joints_.size(); ++j)
        if (places_[j].movesA && places_[j].movesB)
            places_[j].block = factor_.ordering().blockOf(joints_[j].a, joints_[j].b);
    ready_ = false;
    lastStep_ = 0;
    effort_.iterations = effort_.factorizations = 0;
    effort_.largestNeed = 0;
}

void Mechanism::changeVelocity(std::size_t index, const DVec3& linear, const DVec3& angular) {
    MechanismBody& body = bodies_[index];
    const DQuat& q = poses_[index].q;
    body.v = body.v + linear;
    body.w = body.w + angular;
    body.momentum = body.momentum + inWorld(q, body.moments) * angular;
}

bool Mechanism::step(double h, double closing) {
    if (!ready_) {
        if (!isNearlyAligned()) return false;
        errorsAt(poses_.data(), errors_.data());
        if (!refresh()) return false;
        updateLoads();
        lastStep_ = h;
        ready_ = true;
    }
    kick(0.5 * h);
    if (!closePositions(h, closing)) return false;
    for (std::size_t i = 0; i < poses_.size(); ++i) poses_[i] = next_[i];
    if (!refresh()) return false;
    kick(0.5 * h);
    closeVelocities();
    lastStep_ = h;
    return true;
}

/// Half of what acts from outside. Damping is implicit.
void Mechanism::kick(double h) {
    for (std::size_t i = 0; i < moving_; ++i) {
        MechanismBody& body = bodies_[i];
        body.v = (1 / (1 + h * body.damping)) * (body.v + h * body.acceleration);
        body.momentum = (1 / (1 + h * body.turnDamping)) * (body.momentum + h * body.torque);
        body.w = inverseInertia_[i] * body.momentum;
    }
}

void Mechanism::give(const Twist* impulses) {
    for (std::size_t i = 0; i < moving_; ++i) {
        MechanismBody& body = bodies_[i];
        body.v = body.v + body.inverseMass * load(impulses[i].at);
        body.momentum = body.momentum + load(impulses[i].at + 3);
        body.w = inverseInertia_[i] * body.momentum;
    }
}

/// Half of what the joints gave in the substep before, as what they gave at the end of a step as long.
void Mechanism::updateLoads() {
    for (std::size_t i = 0; i < moving_; ++i) restImpulses_[i] = {};
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const MechanismJoint& joint = joints_[j];
        const DVec3 force = (0.5 / effort_.pace) * joint.force, torque = (0.5 / effort_.pace) * joint.torque;
        const auto push = [&](std::uint32_t body, const DVec3& anchor, double sign) {
            if (body >= moving_) return;
            const DVec3 arm = rotate(poses_[body].q, anchor);
            add(sign * force, restImpulses_[body].at);
            add(sign * (cross(arm, force) + torque), restImpulses_[body].at + 3);
        };
        push(joint.a, joint.anchorA, -1);
        push(joint.b, joint.anchorB, 1);
    }
}

/// Newton's method with the factor of the beginning, from the impulses that the step before ended with. Where the
/// mechanism passes a singular pose within the step, that factor leads away from the answer in one direction, in which
/// next to nothing is left to do: what was best is taken then.
bool Mechanism::closePositions(double h, double closing) {
    for (std::size_t r = 0; r < rows_.size(); ++r) aims_[r] = (1 - closing) * errors_[r];
    const double ratio = h / lastStep_;
    for (std::size_t i = 0; i < moving_; ++i)
        for (int k = 0; k < 6; ++k) moveImpulses_[i].at[k] = ratio * restImpulses_[i].at[k];
    give(moveImpulses_.data());
    double worst = tryPositions(h), last = worst;
    for (int round = 0; worst > kClosed * reach_ && round < kRounds; ++round) {
        for (std::size_t r = 0; r < rows_.size(); ++r) rows_[r].target = (aims_[r] - errors_[r]) / h;
        solveTargets();
        addChange(moveImpulses_.data(), 1);
        last = worst;
        worst = tryPositions(h);
        if (worst < kProgress * last) continue;
        addChange(moveImpulses_.data(), -1);
        worst = tryPositions(h);
        break;
    }
    return worst <= kAlmostClosed * reach_;
}

/// Where the bodies would be after h; the largest error.
double Mechanism::tryPositions(double h) {
    moveFreely(h);
    errorsAt(next_.data(), errors_.data());
    double worst = 0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const double error = rows_[r].unit * std::fabs(errors_[r] - aims_[r]);
        if (!(error <= worst)) worst = error;
    }
    return worst;
}

void Mechanism::closeVelocities() {
    for (std::size_t i = 0; i < moving_; ++i) restImpulses_[i] = {};
    for (int round = 0; round < kStillRounds; ++round) {
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            store(bodies_[i].v, velocities_[i].at);
            store(bodies_[i].w, velocities_[i].at + 3);
        }
        double worst = 0;
        for (std::size_t j = 0; j < joints_.size(); ++j)
            for (std::uint32_t k = 0; k < places_[j].rowCount; ++k) {
                Row& row = rows_[places_[j].firstRow + k];
                row.target = -speedOf(j, row, velocities_.data());
                const double speed = row.unit * std::fabs(row.target);
                if (!(speed <= worst)) worst = speed;
            }
        if (worst * lastStep_ <= kStill * reach_) return;
        solveTargets();
        addChange(restImpulses_.data(), 1);
    }
}

void Mechanism::moveFreely(double h) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const MechanismBody& body = bodies_[i];
        next_[i].x = poses_[i].x + h * body.v;
        next_[i].q = i < moving_ ? turnFreely(poses_[i].q, body.momentum, body.inverseMoments, h)
                                 : normalized(turnBy(h * body.w) * poses_[i].q);
    }
}

/// The least loads that give the impulses of the last step solve  min |Jᵀλ − ΔP|²_M⁻¹ + R |λ|².
void Mechanism::findLoads() {
    for (std::size_t i = 0; i < moving_; ++i) {
        const double* move = moveImpulses_[i].at;
        const double* rest = restImpulses_[i].at;
        store((effort_.pace * bodies_[i].inverseMass) * (load(move) + load(rest)), velocities_[i].at);
        store(static_cast<double>(effort_.pace) * (inverseInertia_[i] * (load(move + 3) + load(rest + 3))),
              velocities_[i].at + 3);
    }
    for (std::size_t i = moving_; i < bodies_.size(); ++i) velocities_[i] = {};
    for (std::size_t j = 0; j < joints_.size(); ++j)
        for (std::uint32_t k = 0; k < places_[j].rowCount; ++k) {
            Row& row = rows_[places_[j].firstRow + k];
            row.target = speedOf(j, row, velocities_.data());
        }
    solveTargets();
    for (std::size_t i = 0; i < moving_; ++i) velocities_[i] = change_[i];
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        MechanismJoint& joint = joints_[j];
        joint.force = joint.torque = {};
        for (std::uint32_t k = 0; k < places_[j].rowCount; ++k) {
            const Row& row = rows_[places_[j].firstRow + k];
            const double load = (row.target - speedOf(j, row, velocities_.data())) / row.resistance;
            if (k < 3)
                joint.force = joint.force + load * direct::load(row.jb);
            else
                joint.torque = joint.torque + load * direct::load(row.jb + 3);
        }
    }
}

}  // namespace ragtop::direct
