#include "constraints/joint_ball_drives.h"

#include "constraints/joint_types.h"
#include "constraints/spring_lead.h"

namespace ragtop {
namespace {

// As for limits of the twist: within 0.1° of a half turn of swing it has no axis.
constexpr float kNoTwist = 1e-3f;

/// How far B is from the target along the basis, which it fills in: by the shortest way, or by the twist and the swing
/// that lead back to it.
Vec3 driveError(BallDrives& drives, const Quat& target, const Quat& b) {
    if (!drives.apart) {
        drives.basis = {};
        return rotationVector(b * conjugate(target));
    }
    const SwingTwist off = swingTwist(target, b);
    const Vec3 x = rotate(target, {1, 0, 0}), xB = rotate(b, {1, 0, 0});
    const Vec3 axis = off.cosHalfSwing > kNoTwist ? twistAxis(x, xB) : xB, y = perpendicular(axis);
    drives.basis = {axis, y, cross(axis, y)};
    const Vec3 swing = axisError(x, xB);
    const float sine = length(swing), longer = sine > 1e-6f ? off.swing / sine : 1.0f;
    return {off.twist, longer * dot(swing, drives.basis.cy), longer * dot(swing, drives.basis.cz)};
}

/// Has an axis of the basis another spring than the one before?
bool isNext(const BallDrives& drives, int k) { return k == 0 || (k == 1 && drives.apart); }

}  // namespace

TunedSpring tunedDrive(const BallDrives& drives, int k, float inverseInertia) {
    return (k == 0 && drives.apart ? drives.twist : drives.swing).at(inverseInertia);
}

bool needsDrives(const BallDef& def) {
    return def.twistSpring || !(def.targetSpeed == Vec3{}) || !(def.feedForward == Vec3{});
}

BallDrives compileDrives(const BallDef& def) {
    BallDrives drives;
    drives.swing = tuningOf(def.spring.value_or(Spring{}));
    drives.twist = tuningOf(def.twistSpring.value_or(Spring{}));
    drives.apart = def.twistSpring ? 1 : 0;
    drives.targetSpeed = def.targetSpeed;
    drives.feedForward = def.feedForward;
    return drives;
}

/// With λ = push − drag (ω − speed), along each axis of the basis.
void beginDrives(JointSim& joint, const JointPlace& place, float inverseInertia, float h) {
    BallDrives& drives = joint.drives;
    const Vec3 error = driveError(drives, place.a * joint.ball.target, place.b);
    drives.speed = transposeTimes(drives.basis, rotate(place.a, drives.targetSpeed));
    const Vec3 added = transposeTimes(drives.basis, rotate(place.a, drives.feedForward));
    TunedSpring spring{};
    SpringShares shares;
    for (int k = 0; k < 3; ++k) {
        if (isNext(drives, k)) {
            spring = tunedDrive(drives, k, inverseInertia);
            shares = springShares(spring.stiffness, spring.damping, inverseInertia, h);
        }
        drives.drag[0][k] = dragOf(shares.moving, inverseInertia);
        drives.drag[1][k] = dragOf(shares.resting, inverseInertia);
        drives.push[k] = h * (added[k] - spring.stiffness * error[k]);
    }
}

Vec3 leadDrives(const JointSim& joint, const JointPlace& place, float inverseInertia, float h, const Vec3& steady) {
    BallDrives drives = joint.drives;
    const Vec3 error = driveError(drives, place.a * joint.ball.target, place.b);
    const Vec3 added = transposeTimes(drives.basis, rotate(place.a, drives.feedForward));
    const Vec3 load = transposeTimes(drives.basis, steady);
    Vec3 push, share;
    TunedSpring spring{};
    float own = 0;
    for (int k = 0; k < 3; ++k) {
        if (isNext(drives, k)) {
            spring = tunedDrive(drives, k, inverseInertia);
            own = leadShare(spring.stiffness, spring.damping, inverseInertia, h);
        }
        push[k] = h * (added[k] - spring.stiffness * error[k]);
        share[k] = own;
    }
    const float size = length(push), longest = h * joint.ball.spring.most;
    if (size > longest) push = (longest / size) * push;
    return drives.basis * scale(share, push + load);
}

/// (D⁻¹ + P) λ = D⁻¹ push − (ω − P λ_old) in the basis; a row without drag is a force.
Vec3 solveDrives(JointSim& joint, const Vec3& spin, int pass, float longest) {
    constexpr float kNoDrag = 1e-6f;  // of the rows' admittance: eight roundings of a float
    const BallDrives& drives = joint.drives;
    const Vec3& drag = drives.drag[pass];
    const Vec3 push = drives.push + scale(drag, drives.speed);
    const Sym3 p = inBasis(joint.block.mass.rest, drives.basis);
    const auto compliance = [&](int k) {
        const float least = kNoDrag / (p.xx + p.yy + p.zz);
        return 1 / (drag[k] > least ? drag[k] : least);
    };
    const Vec3 c{compliance(0), compliance(1), compliance(2)};
    const Sym3 k{p.xx + c.x, p.xy, p.xz, p.yy + c.y, p.yz, p.zz + c.z};
    const Vec3 old = joint.ball.springImpulse;
    const Vec3 speed = transposeTimes(drives.basis, spin - joint.block.mass.rest * old);
    const Vec3 solved = drives.basis * solve(factorize(k, diagonal(k)), scale(c, push) - speed);
    const float size = length(solved);
    joint.ball.springImpulse = size > longest ? (longest / size) * solved : solved;
    return joint.ball.springImpulse - old;
}

}  // namespace ragtop
