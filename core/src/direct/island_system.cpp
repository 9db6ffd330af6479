#include "direct/island_system.h"

#include <algorithm>
#include <cstring>

#include "base/economy.h"
#include "constraints/contact_layout.h"
#include "direct/friction_share.h"
#include "direct/joint_rows.h"

namespace ragtop::direct {

IslandSystem::IslandSystem(std::pmr::memory_resource* memory)
    : equations_(memory),
      states_(memory),
      joints_(memory),
      moved_(memory),
      movedPairs_(memory),
      pairs_(memory),
      jointEnds_(memory),
      pointEnds_(memory),
      written_(memory) {
    // Small islands come and go, each time of other sizes.
    constexpr std::size_t kFewBodies = 8, kFewContacts = 16;
    makeRoom(kFewBodies, kFewContacts, 0);
}

float& IslandSystem::pointField(const SystemContact& contact, std::uint32_t point, int index) const {
    return field(contact, contact::kPoints + static_cast<int>(point) * contact::kPointFields + index);
}

namespace {

/// Moments where an axis is locked are not asked for: its movement gets mass 1 and meets no Jacobian.
void setMass(SystemBody& body, const BodyState& state, const BodyInertia& inertia) {
    const double inverseMass = static_cast<double>(state.invMass);
    for (int i = 0; i < 3; ++i) {
        const bool locked = ((state.locks >> i) & 1u) != 0;
        body.inverseMass[i] = locked ? 0 : inverseMass;
        body.mass[i] = locked ? 1 : 1 / inverseMass;
    }
    body.inverseInertia = toDouble(inertia);
    DSym3 full = body.inverseInertia;
    if (!(full.xx > 0)) full.xx = 1;
    if (!(full.yy > 0)) full.yy = 1;
    if (!(full.zz > 0)) full.zz = 1;
    body.inertia = inverse(full);
    body.locks = state.locks & 7u;
    const DSym3& free = body.inverseInertia;
    body.locks |= (free.xx > 0 ? 0u : 8u) | (free.yy > 0 ? 0u : 16u) | (free.zz > 0 ? 0u : 32u);
}

void tangents(const DVec3& n, DVec3& t1, DVec3& t2) {
    const double sign = n.z < 0 ? -1.0 : 1.0;
    const double a = -1 / (sign + n.z), b = n.x * n.y * a;
    t1 = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    t2 = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace

void IslandSystem::makeRoom(std::size_t bodyCount, std::size_t contactCount, std::size_t jointCount) {
    const auto more = [](std::size_t count) { return count + count / 4; };
    if (contactCount > equations_.contacts.capacity()) {
        equations_.contacts.reserve(more(contactCount));
        equations_.points.reserve(contact::kMaxPoints * equations_.contacts.capacity());
    }
    pairs_.reserve(equations_.contacts.capacity() + jointCount);
    if (bodyCount <= equations_.bodies.capacity()) return;
    equations_.bodies.reserve(more(bodyCount));
    const std::size_t room = equations_.bodies.capacity();
    states_.reserve(room);
    written_.reserve(2 * room);
    for (AlignedArray<double>* array : {&equations_.velocity, &equations_.free, &equations_.scratch.gradient,
                                        &equations_.scratch.direction, &equations_.scratch.trial})
        array->reserve(6 * room);
    equations_.hessian.reserve(room, pairs_.capacity());
}

void IslandSystem::begin(const IslandParts& parts, const BodyArrays& arrays, const SolverContext& context) {
    makeRoom(parts.bodyCount, parts.contactCount, parts.jointCount + std::max(parts.pointCount, parts.pointRoom));
    equations_.gravityStep = static_cast<double>(context.gravityStep);
    h_ = static_cast<double>(context.h);
    stride_ = static_cast<std::size_t>(parts.laneStride);
    lanes_ = parts.contactCount;
    equations_.stopped = rests_ = false;
    equations_.loadsKept = true;
    restedSubsteps_ = 0;
    loadBodies(parts, arrays);
    loadContacts(parts, arrays);
    joints_.clear();
    jointEnds_.clear();
    pointEnds_.clear();
    pointEnds_.reserve(2 * parts.pointRoom);
    const auto localOf = [&](std::uint32_t state) {
        return arrays.states[state].invMass > 0 ? static_cast<std::int32_t>(parts.localOf[state]) : kFixed;
    };
    for (std::size_t j = 0; j < parts.jointCount; ++j) {
        JointSim& joint = *parts.joints[j];
        joints_.push(&joint);
        jointEnds_.push(localOf(joint.stateA));
        jointEnds_.push(localOf(joint.stateB));
    }
    for (std::size_t p = 0; p < parts.pointCount; ++p) {
        pointEnds_.push(localOf(parts.points[p].stateA));
        pointEnds_.push(localOf(parts.points[p].stateB));
    }
    bool held = false;
    for (const std::int32_t end : jointEnds_) held |= end == kFixed;
    loops_ = joints_.size() + (held ? 0 : 1) > equations_.bodies.size();
    constexpr std::size_t kMostRows = 24;  // a plane with everything; rows come and go with tension
    constexpr std::size_t kMostRigid = 6;
    const std::size_t points = std::max(parts.pointCount, parts.pointRoom);
    equations_.pairs.reserve(joints_.size() + points);
    equations_.rows.reserve(kMostRows * joints_.size() + points);
    movedPairs_.reserve(joints_.size());
    moved_.reserve(kMostRigid * joints_.size());
    loadPattern();
    const std::size_t n = equations_.unknowns();
    equations_.velocity.resizeForOverwrite(n);
    equations_.free.resizeForOverwrite(n);
    written_.resizeForOverwrite(2 * equations_.bodies.size());
    equations_.scratch.gradient.resizeForOverwrite(n);
    equations_.scratch.direction.resizeForOverwrite(n);
    equations_.scratch.trial.resizeForOverwrite(n);
}

void IslandSystem::loadBodies(const IslandParts& parts, const BodyArrays& arrays) {
    equations_.bodies.resizeForOverwrite(parts.bodyCount);
    states_.resizeForOverwrite(parts.bodyCount);
    for (std::size_t i = 0; i < parts.bodyCount; ++i) {
        const std::uint32_t state = parts.bodies[i];
        parts.localOf[state] = static_cast<std::uint32_t>(i);
        equations_.bodies[i] = {};
        equations_.bodies[i].state = states_[i] = state;
        setMass(equations_.bodies[i], arrays.states[state], arrays.inertia[state]);
    }
}

/// The wide rows have one friction impulse and one twist per manifold; here each point has its own.
static void shareFriction(SystemPoint* points, const SystemContact& contact, const DVec3& center, const DVec3& friction,
                          double twist) {
    SharePoint shares[contact::kMaxPoints];
    for (std::uint32_t j = 0; j < contact.count; ++j) {
        const DVec3 arm = points[j].armA - center;
        shares[j].x = dot(arm, contact.tangent1);
        shares[j].y = dot(arm, contact.tangent2);
        shares[j].normal = points[j].load[0];
    }
    const double along[2] = {dot(friction, contact.tangent1), dot(friction, contact.tangent2)};
    shareFriction(shares, contact.count, contact.friction, along, twist);
    for (std::uint32_t j = 0; j < contact.count; ++j)
        for (int k = 0; k < 2; ++k) points[j].load[1 + k] = shares[j].friction[k];
}

/// What is loaded up to its cone, or not at all, slides already.
static void guessSlips(SystemPoint* points, const SystemContact& contact, const BodyState& a, const BodyState& b) {
    constexpr double kNearlySliding = 0.99;  // of the cone: a guess to begin with
    for (std::uint32_t j = 0; j < contact.count; ++j) {
        SystemPoint& p = points[j];
        const double held = std::sqrt(p.load[1] * p.load[1] + p.load[2] * p.load[2]);
        if (held < kNearlySliding * contact.friction * p.load[0]) continue;
        DVec3 u;
        if (contact.b != kFixed) u = u + toDouble(b.v) + cross(toDouble(b.w), p.armB);
        if (contact.a != kFixed) u = u - toDouble(a.v) - cross(toDouble(a.w), p.armA);
        const double u1 = dot(u, contact.tangent1) + p.drift[1], u2 = dot(u, contact.tangent2) + p.drift[2];
        p.slip = std::sqrt(u1 * u1 + u2 * u2);
    }
}

/// What is fixed is state 0.
static bool isOnKinematic(const SystemContact& c) {
    return (c.a == kFixed && c.stateA != 0) || (c.b == kFixed && c.stateB != 0);
}

/// Long: it reads all fields of a lane.
void IslandSystem::loadContacts(const IslandParts& parts, const BodyArrays& arrays) {
    const double resistance = parts.jointCount > 0 ? tuning::kJointedResistance : tuning::kContactResistance;
    equations_.contacts.clear();
    equations_.points.clear();
    onKinematic_ = false;
    for (std::size_t i = 0; i < parts.contactCount; ++i) {
        SystemContact c;
        c.lane = parts.lanes[i];
        const auto bits = [&](int index) {
            std::uint32_t value;
            std::memcpy(&value, &field(c, index), sizeof value);
            return value;
        };
        const auto vector = [&](int index) { return DVec3{field(c, index), field(c, index + 1), field(c, index + 2)}; };
        c.count = bits(contact::kPointCount);
        if (c.count == 0) continue;
        c.stateA = bits(contact::kBodyA);
        c.stateB = bits(contact::kBodyB);
        const BodyState &stateA = arrays.states[c.stateA], &stateB = arrays.states[c.stateB];
        c.a = stateA.invMass > 0 ? static_cast<std::int32_t>(parts.localOf[c.stateA]) : kFixed;
        c.b = stateB.invMass > 0 ? static_cast<std::int32_t>(parts.localOf[c.stateB]) : kFixed;
        c.first = static_cast<std::uint32_t>(equations_.points.size());
        c.normal = vector(contact::kNormal);
        c.normal = (1 / length(c.normal)) * c.normal;
        tangents(c.normal, c.tangent1, c.tangent2);
        c.friction = field(c, contact::kFriction);
        if (field(c, contact::kSliding) > 0) c.friction *= field(c, contact::kSlidingShare);
        c.restitution = field(c, contact::kRestitution);
        c.size = field(c, contact::kSize);
        c.roundA = field(c, contact::kRoundA);
        c.roundB = field(c, contact::kRoundB);
        c.offset = vector(contact::kOffset);
        c.follow = field(c, contact::kFollow);
        double reach = 0;
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint p;
            const int at = contact::kPoints + static_cast<int>(j) * contact::kPointFields;
            p.armA = vector(at + contact::kAnchor);
            p.armB = p.armA - c.offset;
            p.startGap = p.gap = field(c, at + contact::kSeparation);
            const double mass = field(c, at + contact::kMass);
            p.resistance = resistance / (mass > 0 ? mass : 1);
            p.load[0] = field(c, at + contact::kImpulse);
            p.load[1] = p.load[2] = 0;
            for (int k = 0; k < 3; ++k) p.impulse[k] = p.speed[k] = p.change[k] = 0;
            const double arms = length(p.armA) + length(p.armB);
            reach = arms > reach ? arms : reach;
            equations_.points.push(p);
        }
        c.rounded = tuning::kRoundedGap * c.size + tuning::kRoundedArm * reach;
        c.near = tuning::kContactGap * c.size + c.rounded;
        SystemPoint* points = equations_.points.data() + c.first;
        setDrifts(c, arrays);
        onKinematic_ |= isOnKinematic(c);
        shareFriction(points, c, vector(contact::kCenter), vector(contact::kFrictionImpulse),
                      field(c, contact::kTwistImpulse));
        guessSlips(points, c, stateA, stateB);
        equations_.contacts.push(c);
    }
}

void IslandSystem::loadPattern() {
    pairs_.clear();
    const auto couple = [&](std::int32_t a, std::int32_t b) {
        if (a != kFixed && b != kFixed && a != b)
            pairs_.push({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
    };
    for (const SystemContact& c : equations_.contacts) couple(c.a, c.b);
    for (std::size_t j = 0; j < joints_.size(); ++j) couple(jointEnds_[2 * j], jointEnds_[2 * j + 1]);
    for (std::size_t p = 0; p < pointEnds_.size(); p += 2) couple(pointEnds_[p], pointEnds_[p + 1]);
    equations_.hessian.update(static_cast<std::uint32_t>(equations_.bodies.size()), pairs_.data(), pairs_.size());
    for (SystemContact& c : equations_.contacts)
        if (c.a != kFixed && c.b != kFixed)
            c.block =
                equations_.hessian.ordering().blockOf(static_cast<std::uint32_t>(c.a), static_cast<std::uint32_t>(c.b));
}

void IslandSystem::refreshMasses(const BodyArrays& arrays) {
    for (SystemBody& body : equations_.bodies) {
        setMass(body, arrays.states[body.state], arrays.inertia[body.state]);
        body.stiffness = {};
        body.inverseTaut = body.inverseInertia;
    }
}

void IslandSystem::beginSubstep(const BodyArrays& arrays, const JointContext& joints) {
    rests_ = equations_.stopped && economy.zeroIterations;
    for (std::size_t i = 0; i < states_.size(); ++i) {
        const BodyState& state = arrays.states[states_[i]];
        double* free = equations_.free.data() + 6 * i;
        const DVec3 v = toDouble(state.v), w = toDouble(state.w);
        rests_ &= v == load(free) && w == load(free + 3);
        store(v, free);
        store(w, free + 3);
    }
    if (!rests_ || onKinematic_)  // which may speed up within a step
        for (SystemContact& c : equations_.contacts) {
            if (c.stateA == 0 || c.stateB == 0) continue;  // what is fixed carries nothing along
            moveArms(c, arrays);
            rests_ &= !setDrifts(c, arrays) || !isOnKinematic(c);
        }
    equations_.stopped = rests_;
    if (rests_) return;
    refreshMasses(arrays);
    buildRows(arrays, joints, true, RowAims::substep);
}

void IslandSystem::makeHeavy(SystemBody& body, double factor) {
    for (double& m : body.mass) m *= factor;
    for (double& m : body.inverseMass) m /= factor;
    body.inertia = scaled(body.inertia, factor);
    body.inverseInertia = body.inverseTaut = scaled(body.inverseInertia, 1 / factor);
}

double IslandSystem::largestTurn(double h) const {
    double square = 0;
    for (std::size_t i = 0; i < equations_.bodies.size(); ++i) {
        const DVec3 w = load(equations_.velocity.data() + 6 * i + 3);
        const double s = dot(w, w);
        square = s > square ? s : square;
    }
    return h * std::sqrt(square);
}

void IslandSystem::aimAtRest(const BodyArrays& arrays, const JointContext& joints,
                             std::span<const ClosingPoint> points) {
    refreshMasses(arrays);
    buildRows(arrays, joints, false, RowAims::resting);
    addClosingPoints(points, RowAims::resting, joints.inverseH);
    for (std::size_t i = 0; i < equations_.bodies.size(); ++i) {
        const BodyState& state = arrays.states[equations_.bodies[i].state];
        store(toDouble(state.v), equations_.free.data() + 6 * i);
        store(toDouble(state.w), equations_.free.data() + 6 * i + 3);
    }
    for (std::size_t i = 0; i < equations_.unknowns(); ++i) equations_.velocity[i] = equations_.free[i];
}

/// The stiffness of a body's joints over its inertia, about the axis for which it matters most.
static double tautness(const SystemBody& body) {
    const DSym3 &k = body.stiffness, &i = body.inverseInertia;
    const double x = k.xx * i.xx, y = k.yy * i.yy, z = k.zz * i.zz;
    return x > y ? (x > z ? x : z) : (y > z ? y : z);
}

/// Taut links turn far within a substep; what they turned by is known better once it has been solved.
bool IslandSystem::aimAgain(const BodyArrays& arrays, const JointContext& joints) {
    bool taut = false;
    for (const SystemBody& body : equations_.bodies) taut |= tautness(body) > tuning::kVeryTaut;
    if (!taut) return false;
    for (const SystemRow& row : equations_.rows)
        if (row.kind == RowKind::across) return false;  // its rest is the free motion
    storeImpulses(equations_.rows, joints_.data());
    for (SystemBody& body : equations_.bodies) body.stiffness = {};
    buildRows(arrays, joints, false, RowAims::substep);
    return true;
}

void IslandSystem::buildRows(const BodyArrays& arrays, const JointContext& joints, bool begins, RowAims aims) {
    equations_.pairs.clear();
    equations_.rows.clear();
    if (joints_.empty()) return;
    const bool touches = !equations_.contacts.empty();
    const JointRowBuilder builder{arrays, joints, equations_.pairs, equations_.rows, equations_.bodies.data(),
                                  begins, aims,   touches};
    for (std::size_t j = 0; j < joints_.size(); ++j)
        builder.add(*joints_[j], static_cast<std::uint32_t>(j), jointEnds_[2 * j], jointEnds_[2 * j + 1]);
    for (SystemBody& body : equations_.bodies)
        if (body.stiffness.xx > 0 || body.stiffness.yy > 0 || body.stiffness.zz > 0)
            body.inverseTaut = inverse(body.inertia + body.stiffness);
    for (SystemPair& pair : equations_.pairs) findBlock(pair);
    equations_.takeSidesOfLoads();
}

void IslandSystem::moveRows(const BodyArrays& arrays, const JointContext& joints) {
    for (SystemBody& body : equations_.bodies) {
        setMass(body, arrays.states[body.state], arrays.inertia[body.state]);
        const DSym3& taut = body.stiffness;
        const bool isTaut = taut.xx > 0 || taut.yy > 0 || taut.zz > 0;
        body.inverseTaut = isTaut ? inverse(body.inertia + taut) : body.inverseInertia;
    }
    moved_.clear();
    movedPairs_.clear();
    const JointRowBuilder builder{arrays, joints,          movedPairs_, moved_, equations_.bodies.data(),
                                  false,  RowAims::resting};
    for (std::size_t j = 0; j < joints_.size(); ++j)
        builder.add(*joints_[j], static_cast<std::uint32_t>(j), jointEnds_[2 * j], jointEnds_[2 * j + 1]);
    std::size_t next = 0;
    for (SystemRow& row : equations_.rows) {
        if (next == moved_.size()) break;
        const SystemRow& moved = moved_[next];
        if (row.joint != moved.joint || row.kind != moved.kind) continue;
        ++next;
        row.linear = moved.linear;
        row.turn = moved.turn;
        row.target = moved.target;
        equations_.pairs[row.joint].armA = movedPairs_[row.joint].armA;
        equations_.pairs[row.joint].armB = movedPairs_[row.joint].armB;
    }
}

void IslandSystem::findBlock(SystemPair& pair) const {
    if (pair.a != kFixed && pair.b != kFixed)
        pair.block = equations_.hessian.ordering().blockOf(static_cast<std::uint32_t>(pair.a),
                                                           static_cast<std::uint32_t>(pair.b));
}

void IslandSystem::addClosingPoints(std::span<const ClosingPoint> points, RowAims aims, double inverseH) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const ClosingPoint& point = points[i];
        if (point.isFar || (aims == RowAims::resting && point.room > 0)) continue;
        SystemPair pair;
        pair.a = pointEnds_[2 * i], pair.b = pointEnds_[2 * i + 1];
        pair.first = static_cast<std::uint32_t>(equations_.rows.size()), pair.count = 1;
        pair.armA = point.armA, pair.armB = point.armB;
        findBlock(pair);
        equations_.pairs.push(pair);
        SystemRow row = closingRow(point, pair, equations_.bodies.data());
        row.target = aims == RowAims::closing ? -point.room * inverseH : 0;
        equations_.rows.push(row);
    }
}

void IslandSystem::updateLoads(bool factored) {
    restedSubsteps_ += rests_;
    if (rests_) return;
    if (factored && loops_) equations_.dropSelfStress();
    equations_.takePointLoads();
    for (const SystemContact& c : equations_.contacts)
        for (std::uint32_t j = 0; j < c.count; ++j)
            pointField(c, j, contact::kPeak) += static_cast<float>(equations_.points[c.first + j].load[0]);
    storeImpulses(equations_.rows, joints_.data());
    for (JointSim* joint : joints_) recordLoad(*joint);
}

void IslandSystem::end() {
    // What the substeps have borne through which it rested.
    for (const SystemContact& c : equations_.contacts)
        for (std::uint32_t j = 0; j < c.count; ++j)
            pointField(c, j, contact::kPeak) +=
                static_cast<float>(restedSubsteps_ * equations_.points[c.first + j].load[0]);
    for (const SystemContact& c : equations_.contacts) {
        const DVec3 center{field(c, contact::kCenter), field(c, contact::kCenter + 1), field(c, contact::kCenter + 2)};
        DVec3 friction;
        double twist = 0;
        bool slides = false, sticks = false;
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = equations_.points[c.first + j];
            const DVec3 f = p.load[1] * c.tangent1 + p.load[2] * c.tangent2;
            friction = friction + f;
            twist += dot(c.normal, cross(p.armA - c.follow * c.moved - center, f));
            slides |= p.region == ConeRegion::slide;
            sticks |= p.region == ConeRegion::stick;
            pointField(c, j, contact::kImpulse) = static_cast<float>(p.load[0]);
            pointField(c, j, contact::kLoad) = static_cast<float>(p.load[0]);
        }
        // Loads that were shared out and kept would lose a little with every step if they were summed up again.
        if (!equations_.loadsKept) {
            for (int k = 0; k < 3; ++k)
                field(c, contact::kFrictionImpulse + k) = static_cast<float>(k == 0   ? friction.x
                                                                             : k == 1 ? friction.y
                                                                                      : friction.z);
            field(c, contact::kTwistImpulse) = static_cast<float>(twist);
        }
        // Rows that are exact keep no place; the iteration that follows sticks to that of now.
        field(c, contact::kSliding) = slides && !sticks ? 1.0f : 0.0f;
        for (int k = 0; k < 3; ++k) field(c, contact::kStick + k) = 0;
    }
}

void IslandSystem::writeVelocities(const BodyArrays& arrays) {
    if (rests_) {  // all were stopped, and written so
        for (const std::uint32_t state : states_) arrays.states[state].v = arrays.states[state].w = {};
        return;
    }
    for (std::size_t i = 0; i < equations_.bodies.size(); ++i) {
        equations_.stopBelow(i, tuning::kNothing * equations_.gravityStep);
        const double* v = equations_.velocity.data() + 6 * i;
        BodyState& state = arrays.states[equations_.bodies[i].state];
        state.v = toVec3(load(v));
        state.w = toVec3(load(v + 3));
        written_[2 * i] = state.v;
        written_[2 * i + 1] = state.w;
    }
}

}  // namespace ragtop::direct
