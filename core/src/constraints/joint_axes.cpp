#include "constraints/joint_types.h"

// Joints that are an AxesBlock: which rows are rigid, which are free, and how far each is off.
namespace ragtop {
namespace {

Vec3 axisX(const Quat& q) { return rotate(q, {1, 0, 0}); }
Vec3 axisY(const Quat& q) { return rotate(q, {0, 1, 0}); }
Vec3 axisZ(const Quat& q) { return rotate(q, {0, 0, 1}); }

/// Writes rows in turn.
struct Writer {
    AxesBlock& block;
    double coordinates[AxesBlock::kMostFree] = {};

    void rigid(const PairVector& row, float error) {
        block.rigid[block.rigidRows] = row;
        block.error[block.rigidRows++] = error;
    }
    void free(const PairVector& row, double coordinate) {
        coordinates[block.freeRows] = coordinate;
        setMargins(block.axis[block.freeRows], coordinate);
        block.free[block.freeRows++] = row;
    }
    double turn(float angle) {
        AxisRows& axis = block.axis[block.freeRows];
        track(axis, angle);
        return unwrapped(axis, angle);
    }
};

/// Both x axes on one line: two rows across B's.
void alignAxes(Writer& write, const JointPlace& place) {
    const Vec3 xB = axisX(place.b), yA = axisY(place.a);
    const Vec3 y = normalized(yA - dot(yA, xB) * xB, perpendicular(xB)), z = cross(xB, y);
    const Vec3 error = axisError(axisX(place.a), xB);
    write.rigid({{}, y}, dot(error, y));
    write.rigid({{}, z}, dot(error, z));
}

void travel(Writer& write, const JointPlace& place, const Vec3& direction, bool free) {
    const float along = dot(direction, place.gap);
    const PairVector row = travelRow(direction, place.gap);
    if (free)
        write.free(row, static_cast<double>(along));
    else
        write.rigid(row, along);
}

void refreshCylindrical(Writer& write, const JointPlace& place) {
    alignAxes(write, place);
    travel(write, place, axisY(place.a), false);
    travel(write, place, axisZ(place.a), false);
    write.free({{}, axisX(place.b)}, write.turn(hingeAngle(place.a, place.b)));
    travel(write, place, axisX(place.a), true);
}

void refreshPlane(Writer& write, const JointPlace& place) {
    alignAxes(write, place);
    travel(write, place, axisX(place.a), false);
    write.free({{}, axisX(place.b)}, write.turn(hingeAngle(place.a, place.b)));
    travel(write, place, axisY(place.a), true);
    travel(write, place, axisZ(place.a), true);
}

/// The travel is the pitch times the angle with all its turns.
void refreshScrew(Writer& write, const JointPlace& place, float pitch) {
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
void refreshUniversal(Writer& write, const JointPlace& place) {
    write.rigid({{1, 0, 0}, {}}, place.gap.x);
    write.rigid({{0, 1, 0}, {}}, place.gap.y);
    write.rigid({{0, 0, 1}, {}}, place.gap.z);
    const Vec3 xA = axisX(place.a), yB = axisY(place.b), xB = axisX(place.b);
    const Vec3 normal = normalized(cross(xA, yB), axisZ(place.a));
    write.rigid({{}, normal}, -dot(xA, yB));
    write.free({{}, xA}, write.turn(arcTan2(dot(yB, axisZ(place.a)), dot(yB, axisY(place.a)))));
    write.free({{}, yB}, write.turn(arcTan2(dot(xB, cross(yB, xA)), dot(xB, xA))));
}

void writeRows(Writer& write, const JointSim& joint, const JointPlace& place) {
    write.block.rigidRows = write.block.freeRows = 0;
    if (joint.kind == JointKind::cylindrical) refreshCylindrical(write, place);
    if (joint.kind == JointKind::plane) refreshPlane(write, place);
    if (joint.kind == JointKind::screw) refreshScrew(write, place, joint.pitch);
    if (joint.kind == JointKind::universal) refreshUniversal(write, place);
}

}  // namespace

void refreshAxes(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh) {
    AxesBlock& block = joint.axes;
    Writer write{block};
    writeRows(write, joint, place);
    refreshMass(block, pair.mass(joint.arms));
    if (!refresh.begins) return;
    const PairVector carried = carriedImpulse(block);
    const Vec3 x = axisX(place.b);
    const Vec3 across = carried.linear - dot(carried.linear, x) * x;
    beginAxes(block, write.coordinates, pair, joint.arms, length(across), refresh.context);
}

void compileAxes(const JointDef& def, JointSim& joint) {
    AxesBlock& block = joint.axes;
    const auto settings = [](const AxisDef& axis, bool turns) {
        return AxisSettings{axis.limit,  axis.stop,     axis.motor,   axis.spring,
                            axis.target, axis.friction, axis.bearing, turns};
    };
    if (const auto* cylindrical = std::get_if<CylindricalDef>(&def)) {
        compile(block.axis[0], settings(cylindrical->turn, true));
        compile(block.axis[1], settings(cylindrical->travel, false));
    } else if (const auto* plane = std::get_if<PlaneDef>(&def)) {
        compile(block.axis[0], settings(plane->turn, true));
        compile(block.axis[1], settings(plane->y, false));
        compile(block.axis[2], settings(plane->z, false));
    } else if (const auto* screw = std::get_if<ScrewDef>(&def)) {
        compile(block.axis[0], settings(screw->turn, true));
        joint.pitch = screw->pitch / (2 * kPi);
    } else if (const auto* universal = std::get_if<UniversalDef>(&def)) {
        compile(block.axis[0], settings(universal->first, true));
        compile(block.axis[1], settings(universal->second, true));
    }
}

void reportAxes(const JointSim& joint, const JointPlace& place, const PairVector& speed, JointState& state) {
    JointSim now = joint;
    Writer write{now.axes};
    writeRows(write, joint, place);
    Vec3 off;
    for (std::uint32_t i = 0; i < now.axes.rigidRows; ++i)
        off += (now.axes.error[i] * length(now.axes.rigid[i].linear)) * normalized(now.axes.rigid[i].linear, {});
    state.gap = length(off);
    state.coordinate = static_cast<float>(write.coordinates[0]);
    state.second = static_cast<float>(write.coordinates[1]);
    state.third = static_cast<float>(write.coordinates[2]);
    state.speed = speedAlong(now.axes.free[0], speed);
    for (std::uint32_t f = 0; f < now.axes.freeRows; ++f) {
        const AxisRows& axis = now.axes.axis[f];
        if (!(axis.features & (AxisRows::kLimit | AxisRows::kLocked))) continue;
        for (const float margin : {axis.atLower.margin, axis.atUpper.margin})
            if (margin < state.limitMargin) state.limitMargin = margin;
    }
}

}  // namespace ragtop
