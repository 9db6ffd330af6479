#include "continuous/continuous.h"

#include <cmath>

namespace ragtop {

namespace {

constexpr int kMaxPieces = 64;  ///< of 1.5 rad: 15 turns in a step

/// The share of a path that is swept at once: long turns are swept piece by piece.
float firstPiece(const SweptPath& path) {
    constexpr float kPiece = 1.5f;  // rad
    return 1 / (1 + std::floor(length(path.turn) / kPiece));
}

SweptPath afterPiece(const SweptPath& path, float share) {
    return {path.at(share), (1 - share) * path.way, (1 - share) * path.turn};
}

bool meetsAnything(const SweepView& view, std::uint32_t index) {
    SweptPath path = pathOfStep(view, index);
    float done = 0;
    for (int piece = 0; piece < kMaxPieces && done < 1; ++piece) {
        const float share = firstPiece(path);
        const float until = share < 1 ? done + (1 - done) * share : 1.0f;
        if (firstMeeting(view, index, path.from, path.at(share), done, until).hit) return true;
        path = afterPiece(path, share);
        done = until;
    }
    return false;
}

/// What is swept past obstacles that stand still alone, and meets none, depends on nothing that other sweeps change;
/// one that pushes it on lets it be swept after all.
void clearPaths(const SweepView& view, AlignedArray<BodyFlag>& flags, StageRunner& runner) {
    const ConstTables& t = view.tables;
    runner.parallelFor(static_cast<int>(t.bodies.awake.size()), 64, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) {
            const std::uint32_t body = t.bodies.awake[static_cast<std::size_t>(i)];
            BodyFlag& flag = flags[static_cast<std::size_t>(i)];
            if (flag == kToSweep && t.bodies.moves(body) && !t.bodies[body].options.bullet &&
                !meetsAnything(view, body))
                flag = kFastClear;
        }
    });
}

/// Takes what is left behind on an obstacle that moves on along with it, or the obstacle would pass it.
void rideAlong(const SweepView& view, std::uint32_t obstacle, float done, Pose& pose) {
    const ConstTables& t = view.tables;
    if (t.bodies[obstacle].type == BodyType::fixed) return;
    const SweptPath way = pathOfStep(view, obstacle);
    const Frame beside = relative(way.at(done), pose);
    pose = way.at(1) * beside;
    pose.rotation = normalized(pose.rotation);
}

/// Plays the impacts of a body one after the other, each with the rest of its time. What is left after the last impact,
/// or piece, is lost, but for the way of what it lies on.
void sweepBody(const SweepView& view, const ImpactRules& rules, SweepTarget target, std::uint32_t index) {
    const ConstTables& t = view.tables;
    Bodies& bodies = target.bodies;
    constexpr int kMaxImpacts = 8, kMaxStuck = 3;  // bounds; what is left is lost, as above
    SweptPath path = pathOfStep(view, index);
    Quat velocityAt = t.bodies[index].rotation;
    float done = 0;
    int impacts = 0, stuck = 0;
    for (int piece = 0; piece < kMaxPieces && done < 1; ++piece) {
        const float share = firstPiece(path);
        const Pose to = path.at(share);
        const float until = share < 1 ? done + (1 - done) * share : 1.0f;
        const Meeting meeting = firstMeeting(view, index, path.from, to, done, until);
        if (!meeting.hit) {
            path = afterPiece(path, share);
            done = until;
            continue;
        }
        const float met = share * meeting.fraction;
        path = afterPiece(path, met);
        done += (until - done) * meeting.fraction;
        if (++impacts > kMaxImpacts) {
            rideAlong(view, t.shapes[meeting.obstacle].body, done, path.from);
            break;
        }
        // What meets a surface again and again at once rattles on it: its turn is lost, and it slides along.
        stuck = meeting.fraction == 0 ? stuck + 1 : 0;
        if (stuck > kMaxStuck) {
            const SweptPath others = pathOfStep(view, t.shapes[meeting.obstacle].body);
            const Quat place = others.at(done).rotation * t.shapes[meeting.obstacle].frame.rotation;
            const Vec3 normal = rotate(place, meeting.touch.normal);
            const float into = dot(path.way - (1 - done) * others.way, normal);
            path.way -= (into < 0 ? into : 0.0f) * normal;
            path.turn = {};
            continue;
        }
        if (!solveMeeting(view, rules, target, index, meeting, done, velocityAt, path)) break;
    }
    if (impacts == 0) return;
    bodies.turnVelocity(index, velocityAt, path.from.rotation);
    bodies[index].center = path.from.position;
    bodies[index].rotation = path.from.rotation;
    bodies.refreshInertia(index);
    target.swept.flags[bodies[index].awakeIndex] = kSwept;
}

}  // namespace

void sweepFastBodies(const SweepView& view, const ImpactRules& rules, SweepTarget target, StageRunner& runner) {
    const Bodies& bodies = view.tables.bodies;
    if (runner.workers() > 1) clearPaths(view, target.swept.flags, runner);
    for (std::size_t i = 0; i < bodies.awake.size(); ++i)
        if (target.swept.flags[i] == kToSweep && bodies.moves(bodies.awake[i]))
            sweepBody(view, rules, target, bodies.awake[i]);
}

}  // namespace ragtop
