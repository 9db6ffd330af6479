// The equations of a mechanism: errors of its joints, their rows, and (M + Jᵀ R⁻¹ J) Δv = Jᵀ R⁻¹ target.

#include <cmath>

#include "direct/joint_tuning.h"
#include "direct/mechanism.h"

namespace ragtop::direct {

namespace {

constexpr double kAligned = 0.5;  ///< cosine between the axes of a hinge

DVec3 unit(int k) { return {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}; }

double dot6(const double a[6], const double b[6]) {
    double s = 0;
    for (int k = 0; k < 6; ++k) s += a[k] * b[k];
    return s;
}

}  // namespace

/// C of all rows: the gap, and what turns the frames apart beyond what a joint leaves free.
void Mechanism::errorsAt(const MechanismPose* poses, double* errors) const {
    const auto write = [](double*& to, double error) { *to++ = error; };
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const MechanismJoint& joint = joints_[j];
        const MechanismPose &a = poses[joint.a], &b = poses[joint.b];
        const DVec3 gap = (b.x - a.x) + (rotate(b.q, joint.anchorB) - rotate(a.q, joint.anchorA));
        double* to = errors + places_[j].firstRow;
        write(to, gap.x), write(to, gap.y), write(to, gap.z);
        if (joint.kind == MechanismJointKind::ball) continue;
        const DQuat frameA = a.q * joint.frameA, frameB = b.q * joint.frameB;
        if (joint.kind == MechanismJointKind::hinge) {
            const DVec3 axis = axisX(frameB);
            write(to, dot(axis, axisY(frameA))), write(to, dot(axis, axisZ(frameA)));
        } else {
            const DQuat apart = frameB * conjugate(frameA);
            const double twice = apart.w < 0 ? -2 : 2;
            write(to, twice * apart.x), write(to, twice * apart.y), write(to, twice * apart.z);
        }
    }
}

/// The errors of axes tell which way to turn them only up to a quarter turn.
bool Mechanism::isNearlyAligned() const {
    for (const MechanismJoint& joint : joints_) {
        if (joint.kind != MechanismJointKind::hinge) continue;
        const DQuat frameA = poses_[joint.a].q * joint.frameA, frameB = poses_[joint.b].q * joint.frameB;
        if (!(dot(axisX(frameA), axisX(frameB)) > kAligned)) return false;
    }
    return true;
}

/// Bodies exchange impulses half way between their anchors.
void Mechanism::writeRows(std::size_t index) {
    const MechanismJoint& joint = joints_[index];
    const MechanismPose &a = poses_[joint.a], &b = poses_[joint.b];
    const DVec3 anchorA = rotate(a.q, joint.anchorA), anchorB = rotate(b.q, joint.anchorB);
    const DVec3 half = 0.5 * ((b.x - a.x) + (anchorB - anchorA)), armA = anchorA + half, armB = anchorB - half;
    Row* row = rows_.data() + places_[index].firstRow;
    for (int k = 0; k < 3; ++k, ++row) {
        const DVec3 d = unit(k);
        store(-1.0 * d, row->ja), store(-1.0 * cross(armA, d), row->ja + 3);
        store(d, row->jb), store(cross(armB, d), row->jb + 3);
        finishRow(index, *row);
    }
    if (joint.kind == MechanismJointKind::ball) return;
    const auto turning = [&](const DVec3& d) {
        store({}, row->ja), store(-1.0 * d, row->ja + 3);
        store({}, row->jb), store(d, row->jb + 3);
        finishRow(index, *row++);
    };
    if (joint.kind == MechanismJointKind::hinge) {
        const DQuat frameA = a.q * joint.frameA;
        const DVec3 axis = axisX(b.q * joint.frameB);
        turning(cross(axis, axisY(frameA)));
        turning(cross(axis, axisZ(frameA)));
    } else {
        for (int k = 0; k < 3; ++k) turning(unit(k));
    }
}

/// R is a small part of J M⁻¹ Jᵀ.
void Mechanism::finishRow(std::size_t index, Row& row) const {
    double k = 0;
    const auto part = [&](bool moves, std::uint32_t body, const double j[6]) {
        if (!moves) return;
        const DVec3 linear = load(j), turn = load(j + 3);
        k += bodies_[body].inverseMass * dot(linear, linear) + dot(turn, inverseInertia_[body] * turn);
    };
    part(places_[index].movesA, joints_[index].a, row.ja);
    part(places_[index].movesB, joints_[index].b, row.jb);
    row.resistance = tuning::kRowResistance * k;
}

void Mechanism::addJoint(std::size_t index) {
    const Place& place = places_[index];
    const std::uint32_t a = joints_[index].a, b = joints_[index].b;
    const bool couples = place.movesA && place.movesB;
    const bool rowsOfB = couples && factor_.rowsAreOf(b, a);
    for (std::uint32_t k = 0; k < place.rowCount; ++k) {
        const Row& row = rows_[place.firstRow + k];
        const double weight = 1 / row.resistance;
        if (place.movesA) addSquare(factor_.diagonal(a), weight, row.ja);
        if (place.movesB) addSquare(factor_.diagonal(b), weight, row.jb);
        if (!couples) continue;
        addOuter(factor_.coupling(place.block), weight, rowsOfB ? row.jb : row.ja, rowsOfB ? row.ja : row.jb);
    }
}

/// Rows and factor where the bodies are.
bool Mechanism::refresh() {
    factor_.setZero();
    for (std::size_t i = 0; i < moving_; ++i) {
        inertia_[i] = inWorld(poses_[i].q, bodies_[i].moments);
        inverseInertia_[i] = inWorld(poses_[i].q, bodies_[i].inverseMoments);
        bodies_[i].w = inverseInertia_[i] * bodies_[i].momentum;
        const DSym3& m = inertia_[i];
        double* at = factor_.diagonal(static_cast<std::uint32_t>(i)).at;
        for (int k = 0; k < 3; ++k) at[7 * k] = 1 / bodies_[i].inverseMass;
        at[21] = m.xx, at[22] = m.xy, at[23] = m.xz;
        at[28] = m.yy, at[29] = m.yz;
        at[35] = m.zz;
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        writeRows(j);
        addJoint(j);
    }
    ++effort_.factorizations;
    return factor_.factorize();
}

double Mechanism::speedOf(std::size_t index, const Row& row, const Twist* velocities) const {
    return dot6(row.ja, velocities[joints_[index].a].at) + dot6(row.jb, velocities[joints_[index].b].at);
}

/// change_ ← the changes of velocity that give the rows their targets.
void Mechanism::solveTargets() {
    for (std::size_t i = 0; i < moving_; ++i) change_[i] = {};
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const Place& place = places_[j];
        for (std::uint32_t k = 0; k < place.rowCount; ++k) {
            const Row& row = rows_[place.firstRow + k];
            const double push = row.target / row.resistance;
            for (int i = 0; i < 6; ++i) {
                if (place.movesA) change_[joints_[j].a].at[i] += push * row.ja[i];
                if (place.movesB) change_[joints_[j].b].at[i] += push * row.jb[i];
            }
        }
    }
    factor_.solve(change_.data()->at);
    ++effort_.iterations;
}

/// Gives the bodies what was solved for, and adds it to a sum of impulses.
void Mechanism::addChange(Twist* impulses, double sign) {
    for (std::size_t i = 0; i < moving_; ++i) {
        MechanismBody& body = bodies_[i];
        const DVec3 linear = sign * load(change_[i].at), spin = sign * load(change_[i].at + 3);
        const DVec3 turn = inertia_[i] * spin;
        body.v = body.v + linear;
        body.momentum = body.momentum + turn;
        body.w = body.w + spin;
        add((1 / body.inverseMass) * linear, impulses[i].at);
        add(turn, impulses[i].at + 3);
    }
}

}  // namespace ragtop::direct
