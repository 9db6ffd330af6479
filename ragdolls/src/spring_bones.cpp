#include "ragtop/spring_bones.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "spring_plan.h"

namespace ragtop {
namespace {

constexpr int kLanes = SpringGroup::kLanes;
/// rad that the quickest bone may turn in its own course within a substep; what is seen of a longer one is 1 % off.
constexpr float kMostTurn = 0.3f;
constexpr int kMostSubsteps = 16;

}  // namespace

struct SpringBones::State {
    enum class Known { nothing, place, motion };

    SpringBonesDef def;
    SpringPlan plan;
    std::size_t boneCount = 0;
    std::vector<Frame> inCarrier;             ///< of plan.bones with a carrier, in this frame's animation
    std::vector<DVec3> joints;                ///< m, of plan.bones in the last frame's animation
    std::vector<PlacedCollider> now, before;  ///< at this frame and the last one, from `origin`
    std::vector<PlacedCollider> between;      ///< within a substep
    DVec3 origin{};
    Known known = Known::nothing;
    bool teleported = false;
    float frame = 0, substep = 0;  ///< s, the last ones

    State(const Skeleton& skeleton, const SpringBonesDef& definition)
        : def(definition), plan(planOf(definition, skeleton)), boneCount(skeleton.bones.size()) {
        inCarrier.resize(plan.bones.size());
        joints.resize(plan.bones.size());
        now.resize(def.colliders.size());
        before = between = now;
    }
    SpringGroup& group(int place) { return plan.groups[static_cast<std::size_t>(place / kLanes)]; }

    bool takes(std::span<const Pose> pose) const;
    void take(std::span<const Pose> pose);
    void placeColliders(std::span<const Pose> pose);
    bool jumped(float dt) const;
    void setPaths(float dt);
    void run(float dt, const Vec3& gravity);
    void hold(const Vec3& gravity);
    void give(std::span<Pose> pose) const;
};

bool SpringBones::State::takes(std::span<const Pose> pose) const {
    if (pose.size() != boneCount) return false;
    const auto finite = [&](int bone) {
        const Pose& here = pose[static_cast<std::size_t>(bone)];
        return isFinite(here.position) && isFinite(here.rotation);
    };
    return finite(0) &&
           std::all_of(plan.bones.begin(), plan.bones.end(),
                       [&](const SpringBone& each) { return finite(each.bone); }) &&
           std::all_of(def.colliders.begin(), def.colliders.end(),
                       [&](const SpringCollider& each) { return each.bone < 0 || finite(each.bone); });
}

/// The animation at the end of this frame; what was the end is the beginning now.
void SpringBones::State::take(std::span<const Pose> pose) {
    const Vec3 moved = relative(pose[0].position, origin);
    origin = pose[0].position;
    for (PlacedCollider& each : now) {
        each.a -= moved;
        if (!each.plane) each.b -= moved;
    }
    std::swap(now, before);
    placeColliders(pose);
    for (SpringGroup& each : plan.groups) each.from = each.to;
    for (std::size_t i = 0; i < plan.bones.size(); ++i) {
        const SpringBone& bone = plan.bones[i];
        const Pose& here = pose[static_cast<std::size_t>(bone.bone)];
        const bool carried = bone.carrier >= 0;
        if (carried) inCarrier[i] = relative(pose[static_cast<std::size_t>(bone.carrier)], here);
        if (bone.place < 0) continue;
        SpringGroup& its = group(bone.place);
        const int lane = bone.place % kLanes;
        its.to.set(lane, here.rotation);
        its.offset.set(lane, carried ? inCarrier[i].position : relative(here.position, origin));
        its.shift.set(lane, relative(here.position, joints[i]));
        joints[i] = here.position;
    }
    for (SpringGroup& each : plan.groups) each.to = nearer(each.to, each.from);
}

void SpringBones::State::placeColliders(std::span<const Pose> pose) {
    for (std::size_t i = 0; i < def.colliders.size(); ++i) {
        const SpringCollider& collider = def.colliders[i];
        const Pose carrier = collider.bone < 0 ? Pose{} : pose[static_cast<std::size_t>(collider.bone)];
        const Pose placed = carrier * collider.frame;
        const Vec3 center = relative(placed.position, origin);
        if (const auto* sphere = std::get_if<Sphere>(&collider.shape)) {
            now[i] = {false, center, center, sphere->radius};
        } else if (const auto* capsule = std::get_if<Capsule>(&collider.shape)) {
            const Vec3 half = rotate(placed.rotation, {0, capsule->halfHeight, 0});
            now[i] = {false, center - half, center + half, capsule->radius};
        } else {
            now[i] = {true, center, rotate(placed.rotation, {0, 1, 0}), 0};
        }
    }
}

bool SpringBones::State::jumped(float dt) const {
    const float most = def.jump * plan.size;
    for (const SpringGroup& each : plan.groups) {
        if (!each.roots) break;
        const FourVec3 off = each.shift - dt * each.shiftRate;
        if (any(dot(off, off) > most * most)) return true;
    }
    return false;
}

/// Paths of the animation through the last three frames: x(s) = a + s (b − a) + s (s − 1) bow, bow = dt² (v − v₋)/(dt +
/// dt₋).
void SpringBones::State::setPaths(float dt) {
    const bool fresh = known != Known::motion;
    const float share = fresh ? 0.0f : dt * dt / (dt + frame);
    for (SpringGroup& each : plan.groups) {
        const FourVec3 rate = (1 / dt) * each.shift;
        const FourQuat turnRate = (1 / dt) * (each.to - each.from);
        each.shiftBow = share * (rate - each.shiftRate);
        each.bow = share * (turnRate - each.turnRate);
        each.shiftRate = rate;
        each.turnRate = turnRate;
    }
}

void SpringBones::State::run(float dt, const Vec3& gravity) {
    setPaths(dt);
    const float wanted = std::ceil(dt * plan.quickest / kMostTurn);
    const int count = wanted < kMostSubsteps ? std::max(static_cast<int>(wanted), 1) : kMostSubsteps;
    SpringPass pass;
    pass.h = dt / static_cast<float>(count);
    pass.gravity = gravity;
    pass.colliders = between;
    for (int i = 0; i < count; ++i) {
        pass.begin = static_cast<float>(i) / static_cast<float>(count);
        pass.end = static_cast<float>(i + 1) / static_cast<float>(count);
        pass.fresh = known != Known::motion;
        pass.before = pass.fresh ? pass.h : substep;
        for (std::size_t k = 0; k < now.size(); ++k) {
            between[k] = now[k];
            between[k].a = before[k].a + pass.end * (now[k].a - before[k].a);
            between[k].b = before[k].b + pass.end * (now[k].b - before[k].b);
        }
        for (SpringGroup& each : plan.groups) advance(each, plan.groups, pass);
        known = Known::motion;
        substep = pass.h;
    }
    frame = dt;
}

/// At rest where nothing was known, else bent as before.
void SpringBones::State::hold(const Vec3& gravity) {
    SpringPass pass;
    pass.gravity = gravity;
    pass.colliders = now;
    const bool first = known == Known::nothing;
    for (SpringGroup& each : plan.groups) first ? settle(each, plan.groups, pass) : carry(each, plan.groups, pass);
}

void SpringBones::State::give(std::span<Pose> pose) const {
    for (std::size_t i = 0; i < plan.bones.size(); ++i) {
        const SpringBone& bone = plan.bones[i];
        Pose& here = pose[static_cast<std::size_t>(bone.bone)];
        if (bone.place < 0) {
            here = pose[static_cast<std::size_t>(bone.carrier)] * inCarrier[i];
            here.rotation = normalized(here.rotation);
            continue;
        }
        const SpringGroup& its = plan.groups[static_cast<std::size_t>(bone.place / kLanes)];
        if (bone.carrier >= 0) here.position = origin + its.joint.at(bone.place % kLanes);
        here.rotation = its.rotation.at(bone.place % kLanes);
    }
}

SpringBones::SpringBones(const Skeleton& skeleton, const SpringBonesDef& def) {
    if (const std::string problem = whyInvalid(def, skeleton); !problem.empty())
        throw std::invalid_argument("spring bones: " + problem);
    state_ = std::make_unique<State>(skeleton, def);
}

SpringBones::~SpringBones() = default;
SpringBones::SpringBones(SpringBones&&) noexcept = default;
SpringBones& SpringBones::operator=(SpringBones&&) noexcept = default;

const SpringBonesDef& SpringBones::def() const { return state_->def; }

void SpringBones::step(std::span<Pose> pose, double dt, const Vec3& gravity) {
    State& state = *state_;
    const auto seconds = static_cast<float>(dt);
    const bool usable = state.takes(pose) && seconds >= 0 && std::isfinite(seconds) && isFinite(gravity);
    assert(usable);
    if (!usable || state.plan.groups.empty()) return;
    state.take(pose);
    const bool moves = state.known != State::Known::nothing && !state.teleported && seconds > 0 &&
                       !(state.known == State::Known::motion && state.jumped(seconds));
    if (moves) {
        state.run(seconds, gravity);
    } else {
        state.hold(gravity);
        // A pause keeps what is known of the motion; where the carrier is put in it is no part of it.
        const bool paused = seconds == 0 && !state.teleported && state.known == State::Known::motion;
        if (!paused) state.known = State::Known::place;
    }
    state.teleported = false;
    state.give(pose);
}

void SpringBones::teleport() { state_->teleported = true; }
void SpringBones::reset() { state_->known = State::Known::nothing; }

}  // namespace ragtop
