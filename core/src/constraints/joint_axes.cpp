#include "constraints/axes_writer.h"

// Joints that are an AxesBlock: which rows are rigid, which are free, and how far each is off.
namespace ragtop {
namespace {

Vec3 axisZ(const Quat& q) { return rotate(q, {0, 0, 1}); }

/// Both x axes on one line: two rows across B's.
void alignAxes(AxesWriter& write, const JointPlace& place) {
    const Vec3 xB = axisX(place.b), yA = axisY(place.a);
    const Vec3 y = normalized(yA - dot(yA, xB) * xB, perpendicular(xB)), z = cross(xB, y);
    const Vec3 error = axisError(axisX(place.a), xB);
    write.rigid({{}, y}, dot(error, y));
    write.rigid({{}, z}, dot(error, z));
}

void travel(AxesWriter& write, const JointPlace& place, const Vec3& direction, bool free) {
    const float along = dot(direction, place.gap);
    const PairVector row = travelRow(direction, place.gap);
    if (free)
        write.free(row, static_cast<double>(along));
    else
        write.rigid(row, along);
}

void refreshCylindrical(AxesWriter& write, const JointPlace& place) {
    alignAxes(write, place);
    travel(write, place, axisY(place.a), false);
    travel(write, place, axisZ(place.a), false);
    write.free({{}, axisX(place.b)}, write.turn(hingeAngle(place.a, place.b)));
    travel(write, place, axisX(place.a), true);
}

void refreshPlane(AxesWriter& write, const JointPlace& place) {
    alignAxes(write, place);
    travel(write, place, axisX(place.a), false);
    write.free({{}, axisX(place.b)}, write.turn(hingeAngle(place.a, place.b)));
    travel(write, place, axisY(place.a), true);
    travel(write, place, axisZ(place.a), true);
}

/// The travel is the pitch times the angle with all its turns.
void refreshScrew(AxesWriter& write, const JointPlace& place, float pitch) {
    alignAxes(write, place);
    travel(write, place, axisY(place.a), false);
    travel(write, place, axisZ(place.a), false);
    const Vec3 x = axisX(place.a), xB = axisX(place.b);
    const double angle = write.turn(hingeAngle(place.a, place.b));
    PairVector row = travelRow(x, place.gap);
    row.angular -= pitch * xB;
    write.rigid(row, static_cast<float>(static_cast<double>(dot(x, place.gap)) - static_cast<double>(pitch) * angle));
    write.free({{}, xB}, angle);
}

/// A cross of A's x and B's y axis, which stay at a right angle: ω = α' x_A + β' y_B, regular at any angles.
void refreshUniversal(AxesWriter& write, const JointPlace& place) {
    write.rigid({{1, 0, 0}, {}}, place.gap.x);
    write.rigid({{0, 1, 0}, {}}, place.gap.y);
    write.rigid({{0, 0, 1}, {}}, place.gap.z);
    const Vec3 xA = axisX(place.a), yB = axisY(place.b), xB = axisX(place.b);
    const Vec3 normal = normalized(cross(xA, yB), axisZ(place.a));
    write.rigid({{}, normal}, -dot(xA, yB));
    write.free({{}, xA}, write.turn(arcTan2(dot(yB, axisZ(place.a)), dot(yB, axisY(place.a)))));
    write.free({{}, yB}, write.turn(arcTan2(dot(xB, cross(yB, xA)), dot(xB, xA))));
}

void writeRows(AxesWriter& write, JointSim& joint, const JointPlace& place) {
    if (joint.kind == JointKind::cylindrical) refreshCylindrical(write, place);
    if (joint.kind == JointKind::plane) refreshPlane(write, place);
    if (joint.kind == JointKind::screw) refreshScrew(write, place, withAxes(joint).thread.pitch);
    if (joint.kind == JointKind::universal) refreshUniversal(write, place);
    if (joint.kind == JointKind::path) writePath(write, withAxes(joint).path, place);
    if (joint.kind == JointKind::sixDof) writeSixDof(write, place);
    write.block.rigidRows = write.rigidRows;
    write.block.freeRows = write.freeRows;
}

}  // namespace

namespace {

/// The impulse that friction is measured by: across the axis, of a screw that of the flanks of its thread.
float frictionLoad(const JointSim& joint, const JointPlace& place) {
    const AxesJointSim& own = withAxes(joint);
    const AxesBlock& block = own.axes;
    if (joint.kind == JointKind::screw && own.thread.radius > 0) {
        // With the thrust λ, the friction's torque τ and the tangent t of the lead, the flank at radius r bears
        // N = (λ (1 + t²) − τ t/r) cos(lead), and friction μ N along it has the torque μ N r/cos(lead).
        const float lead = own.thread.pitch / own.thread.radius, thrust = block.impulse[4];
        const float load = thrust * (1 + lead * lead) - block.axis[0].frictionImpulse * lead / own.thread.radius;
        return load < 0 ? -load : load;
    }
    const Vec3 carried = warmStartImpulse(block).linear, x = axisX(place.b);
    return length(carried - dot(carried, x) * x);
}

}  // namespace

void refreshAxes(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh) {
    AxesBlock& block = withAxes(joint).axes;
    AxesWriter write{block};
    writeRows(write, joint, place);
    refreshMass(block, pair.mass(joint.arms));
    if (!refresh.begins) return;
    beginAxes(block, pair, joint.arms, frictionLoad(joint, place), refresh.context);
}

namespace {

/// Where the velocities lead that the rigid rows leave, by how much does each row go another way than its rate says?
/// Angles that turn by more than half a radian are not foreseen, as in `curving`, nor vague ones, which may jump.
/// Returns the largest change of what rigid rows bend by, of the speed, squared.
float bendOnce(JointSim& joint, const JointPlace& place, const BodyPair& pair, const JointContext& context) {
    AxesBlock& block = withAxes(joint).axes;
    const BodyPair holds = held(block, pair, joint.arms, true);
    const PairVector u = holds.velocity(joint.arms);
    const Turning w = holds.turns();
    const PathPlace onPath = withAxes(joint).path.at;
    AxesPlace ahead;
    AxesWriter write{block, &ahead};
    writeRows(write, joint, placeAhead(place, joint.arms, holds, context.h));
    withAxes(joint).path.at = onPath;
    const float a = dot(w.a, w.a), b = dot(w.b, w.b), square = context.h * context.h * (a > b ? a : b);
    const float share = 1 / (1 + 9 * square * square);
    const float arms = a * lengthSquared(joint.arms.a) + b * lengthSquared(joint.arms.b);
    const float along = lengthSquared(u.linear), linear = along > arms ? along : arms;
    float largest = 0;
    for (std::uint32_t i = 0; i < block.rigidRows; ++i) {
        const float bend =
            share * (context.inverseH * (ahead.error[i] - block.error[i]) - speedAlong(block.rigid[i], u));
        const float change = bend - block.rigidBend[i], speed = block.rigid[i].linear == Vec3{} ? a + b : linear;
        if (change * change > largest * speed) largest = change * change / speed;
        block.rigidBend[i] = bend;
    }
    for (std::uint32_t f = 0; f < block.freeRows; ++f) {
        block.freeBend[f] = 0;
        if ((block.vague | ahead.vague) & 1u << f) continue;
        const auto way = static_cast<float>(ahead.coordinate[f] - coordinateOf(block, f));
        block.freeBend[f] = share * (context.inverseH * way - speedAlong(block.free[f], u));
    }
    return largest;
}

}  // namespace

/// Newton's method for the errors when the substep ends, from what rows bent by in the one before: the angle α between
/// the way and its chord, half of what it turns by in the substep. Once is enough where α changes little. Speeds are
/// projected onto the chord and from there onto the new way; where α changes by more than 1/32, that may leave
/// α² = 0.1 % of energy, and such rows stay soft.
void foreseeAxes(JointSim& joint, const JointPlace& place, const BodyPair& pair, const JointContext& context) {
    constexpr float kLittle = 1.0f / 128, kMuch = 1.0f / 32;  // rad
    AxesBlock& block = withAxes(joint).axes;
    bool bent = false;
    for (const float bend : block.rigidBend) bent = bent || bend != 0;
    const float change = bendOnce(joint, place, pair, context);
    block.isAbrupt = bent && change > kMuch * kMuch ? 1 : 0;
    if (!(change > kLittle * kLittle)) return;
    if (block.isAbrupt)
        for (float& bend : block.rigidBend) bend = 0;
    bendOnce(joint, place, pair, context);
}

namespace {

void compileAxis(AxesBlock& block, std::uint32_t index, const AxisDef& def, bool turns) {
    compile(block.axis[index], settingsOf(def, turns));
}

/// An open path ends in hard stops where its limit does not end before.
void compilePath(const PathDef& def, AxesJointSim& joint) {
    compile(joint.path, def.curve, def.align);
    AxisDef travel = def.travel;
    if (!def.curve.closed) {
        const Range whole{0, joint.path.length}, asked = travel.limit.value_or(whole);
        travel.limit =
            Range{asked.lower > 0 ? asked.lower : 0.0f, asked.upper < whole.upper ? asked.upper : whole.upper};
    }
    compileAxis(joint.axes, 0, travel, false);
}

void compileSixDof(const SixDofDef& def, AxesBlock& block) {
    const AxisDef* axes[] = {&def.twist, &def.swingY, &def.swingZ, &def.x, &def.y, &def.z};
    block.locked = 0;
    for (std::uint32_t i = 0; i < 6; ++i) {
        AxisDef axis = *axes[i];
        if (axis.limit && axis.limit->lower == axis.limit->upper) {
            // Rigid, so that nothing else can act along it.
            block.locked |= 1u << i;
            axis = {};
        }
        compileAxis(block, i, axis, i < 3);
        if (block.locked & 1u << i) block.axis[i].lower = axes[i]->limit->lower;
    }
}

}  // namespace

void compileAxes(const JointDef& def, JointSim& joint) {
    AxesJointSim& own = withAxes(joint);
    AxesBlock& block = own.axes;
    if (const auto* cylindrical = std::get_if<CylindricalDef>(&def)) {
        compileAxis(block, 0, cylindrical->turn, true);
        compileAxis(block, 1, cylindrical->travel, false);
    } else if (const auto* plane = std::get_if<PlaneDef>(&def)) {
        compileAxis(block, 0, plane->turn, true);
        compileAxis(block, 1, plane->y, false);
        compileAxis(block, 2, plane->z, false);
    } else if (const auto* screw = std::get_if<ScrewDef>(&def)) {
        compileAxis(block, 0, screw->turn, true);
        own.thread.pitch = screw->pitch / (2 * kPi);
        own.thread.radius = screw->turn.bearing ? screw->turn.bearing->pinRadius : 0.0f;
    } else if (const auto* universal = std::get_if<UniversalDef>(&def)) {
        compileAxis(block, 0, universal->first, true);
        compileAxis(block, 1, universal->second, true);
    } else if (const auto* path = std::get_if<PathDef>(&def)) {
        compilePath(*path, own);
    } else if (const auto* sixDof = std::get_if<SixDofDef>(&def)) {
        compileSixDof(*sixDof, block);
    }
}

void reportAxes(const JointSim& joint, const JointPlace& place, const PairVector& speed, JointState& state) {
    AxesJointSim now = withAxes(joint);
    AxesWriter write{now.axes};
    writeRows(write, now, place);
    Vec3 off;
    for (std::uint32_t i = 0; i < now.axes.rigidRows; ++i)
        off += (now.axes.error[i] * length(now.axes.rigid[i].linear)) * normalized(now.axes.rigid[i].linear, {});
    state.gap = length(off);
    state.coordinate = now.axes.value[0];
    state.second = now.axes.value[1];
    state.third = now.axes.value[2];
    if (joint.kind == JointKind::sixDof) state.travel = {now.axes.value[3], now.axes.value[4], now.axes.value[5]};
    state.speed = speedAlong(now.axes.free[0], speed);
    for (std::uint32_t f = 0; f < now.axes.freeRows; ++f) {
        const AxisRows& axis = now.axes.axis[f];
        if (!(axis.features & (AxisRows::kLimit | AxisRows::kLocked))) continue;
        for (const float margin : {axis.atLower.margin, axis.atUpper.margin})
            if (margin < state.limitMargin) state.limitMargin = margin;
    }
}

}  // namespace ragtop
