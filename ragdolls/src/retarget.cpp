#include "ragtop/retarget.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "range_check.h"
#include "retargeting.h"

namespace ragtop {
namespace {

constexpr float kGroundShare = 0.1f;  ///< of all moments have the lower foot below the ground
constexpr float kSameGround = 0.05f;  ///< of the height of the hips: ground this near to that of the rest is that
constexpr float kWindow = 0.1f;       ///< s, that the hips take to follow what feet need
constexpr float kSamePose = 0.998f;   ///< cosine of half the angle between bones of equal poses
constexpr float kSameHeight = 0.02f;  ///< of the height of the hips
constexpr float kLeastCycle = 0.2f;   ///< s
constexpr float kAtRest = 1e-6f;      ///< what a bone differs from rest by that does not move

float likeness(const Quat& a, const Quat& b) { return std::abs(a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w); }

}  // namespace

Retargeting::Retargeting(const Clip& clip, const RagdollDef& from, const RagdollDef& to, const RetargetOptions& options)
    : clip_(clip), options_(options), from_(from), to_(to), mapping_(from_, to_, options.keepLimits) {
    steps_ = std::max(static_cast<int>(std::lround(clip.seconds * options.rate)), clip.seconds > 0 ? 1 : 0);
    scale_ = to_.height / from_.height;
    bones_.resize(to.bones.size());
    legs_ = {legOf(to_.body, BodySide::left), legOf(to_.body, BodySide::right)};
}

Retargeted Retargeting::run() {
    readClip();
    findGround();
    moveHips();
    Retargeted result{.scale = scale_, .still = mapping_.still()};
    if (holdsFeet()) result.stances = holdFeet();
    result.clip = write();
    return result;
}

float Retargeting::step() const { return steps_ > 0 ? clip_.seconds / static_cast<float>(steps_) : 1 / options_.rate; }

int Retargeting::window() const { return static_cast<int>(std::lround(kWindow / step())); }

LocalPose Retargeting::sampled(float time, const Pose& placement) const {
    LocalPose pose = restPose(from_.skeleton, placement);
    sample(clip_, time, pose, placement);
    return pose;
}

/// Whether it ends as it begins; `again`: from there to where it then goes on.
bool Retargeting::repeats(Frame& again) const {
    if (clip_.seconds < kLeastCycle) return false;
    const LocalPose first = sampled(0, {}), last = sampled(clip_.seconds, {});
    for (std::size_t i = 1; i < first.bones.size(); ++i)
        if (likeness(first.bones[i].rotation, last.bones[i].rotation) < kSamePose) return false;
    const Vec3 up = rotate(from_.heading, {0, 1, 0});
    const Quat turn = last.root.rotation * conjugate(first.root.rotation);
    const Vec3 way = relative(last.root.position, first.root.position);
    again = relative(Pose{}, last.root * inverse(relative(Pose{}, first.root)));
    return dot(rotate(turn, up), up) > kSamePose && std::abs(dot(way, up)) < kSameHeight * from_.height;
}

/// A clip that repeats is read three times over, so that what is held at its ends is held across them.
void Retargeting::readClip() {
    Frame again;
    before_ = steps_ > 0 && repeats(again) ? steps_ : 0;
    const Pose next = Pose{} * again, previous = Pose{} * inverse(again);
    const int count = 2 * before_ + steps_ + 1;
    for (int i = 0; i < count; ++i) {
        const int at = i - before_, round = at < 0 ? -1 : at > steps_ ? 1 : 0;
        const Pose placement = round > 0 ? next : round < 0 ? previous : Pose{};
        const float time =
            steps_ > 0 ? clip_.seconds * static_cast<float>(at - round * steps_) / static_cast<float>(steps_) : 0;
        Moment moment;
        moment.source = writePose(from_.skeleton, sampled(time, placement));
        moment.parts.resize(to_.def.parts.size());
        mapping_.turn(moment.source, moment.parts, !holdsFeet());
        moments_.push_back(std::move(moment));
    }
}

/// Along the heading of the clip's body.
Vec3 Retargeting::sourcePoint(const Moment& moment, int part, const Vec3& point) const {
    const Pose& bone = moment.source[static_cast<std::size_t>(from_.part(part).bone)];
    return inverseRotate(from_.heading, toVec3(transformPoint(bone, point)));
}

Vec3 Retargeting::pointNow(int part, const Vec3& point) const {
    const Frame& bone = bones_[static_cast<std::size_t>(to_.part(part).bone)];
    return inverseRotate(to_.heading, transformPoint(bone, point));
}

void Retargeting::place(const Moment& moment) {
    mapping_.place(moment.source, moment.parts, rotate(to_.heading, moment.hips), bones_);
}

FootWay Retargeting::sourceWay(std::size_t side) const {
    FootWay way;
    for (const Moment& moment : moments_) {
        way.heel.push_back(sourcePoint(moment, from_.feet[side].part, from_.feet[side].heel));
        way.ball.push_back(sourcePoint(moment, from_.feet[side].part, from_.feet[side].ball));
        way.tip.push_back(sourcePoint(moment, from_.feet[side].part, from_.feet[side].tip));
    }
    return way;
}

/// Each point as low as the lower edge of the sole beside it.
FootWay Retargeting::ownWay(std::size_t side) {
    const FootPoints& foot = to_.feet[side];
    const Vec3 across = rotate(to_.axes[static_cast<std::size_t>(to_.part(foot.part).bone)], {foot.halfWidth, 0, 0});
    FootWay way;
    for (const Moment& moment : moments_) {
        place(moment);
        const Vec3 edge = pointNow(foot.part, across) - pointNow(foot.part, {});
        const Vec3 lower{0, std::abs(edge.y), 0};
        way.heel.push_back(pointNow(foot.part, foot.heel) - lower);
        way.ball.push_back(pointNow(foot.part, foot.ball) - lower);
        way.tip.push_back(pointNow(foot.part, foot.tip) - lower);
    }
    return way;
}

/// That of the rest pose, or where the lower foot is a tenth of the time.
void Retargeting::findGround() {
    sourceGround_ = from_.ground;
    if (!haveFeet()) return;
    for (std::size_t side = 0; side < 2; ++side) sourceWays_[side] = sourceWay(side);
    sourceHeights_ = lowest(sourceWays_);
    std::vector<float> sorted = sourceHeights_;
    std::sort(sorted.begin(), sorted.end());
    const float low = sorted[static_cast<std::size_t>(kGroundShare * static_cast<float>(sorted.size() - 1))];
    if (std::abs(low - from_.ground) > kSameGround * from_.height) sourceGround_ = low;
    for (float& height : sourceHeights_) height -= sourceGround_;
}

/// Hips go the scaled way of the clip's, as high as leaves the lower foot as far over the ground.
void Retargeting::moveHips() {
    const Vec3 theirs = inverseRotate(from_.heading, from_.hips), own = inverseRotate(to_.heading, to_.hips);
    const Vec3 origin{theirs.x, sourceGround_, theirs.z};
    for (Moment& moment : moments_) {
        Vec3 middle;
        for (const int thigh : from_.thighs) middle += 0.5f * sourcePoint(moment, thigh, from_.jointInBone(thigh));
        moment.hips = Vec3{own.x, to_.ground, own.z} + scale_ * (middle - origin);
    }
    if (!haveFeet()) return;
    std::vector<float> raise = lowest({ownWay(0), ownWay(1)});
    for (std::size_t i = 0; i < raise.size(); ++i) raise[i] = scale_ * sourceHeights_[i] - (raise[i] - to_.ground);
    raise = smoothed(raise, window());
    for (std::size_t i = 0; i < raise.size(); ++i) moments_[i].hips.y += raise[i];
}

Clip Retargeting::write() {
    Clip clip{clip_.name, clip_.seconds, {}};
    const auto& bones = to_.skeleton.bones;
    std::vector<bool> moves(bones.size(), false);
    for (std::size_t bone = 0; bone < bones.size(); ++bone) clip.tracks.push_back({static_cast<int>(bone), {}, {}});
    for (int i = 0; i <= steps_; ++i) {
        place(moments_[static_cast<std::size_t>(before_ + i)]);
        for (std::size_t bone = 0; bone < bones.size(); ++bone) {
            Frame key = bones_[bone], rest = bones[bone].bind;
            if (bones[bone].parent >= 0) {
                const auto parent = static_cast<std::size_t>(bones[bone].parent);
                key.rotation = normalized(conjugate(bones_[parent].rotation) * key.rotation);
                rest = inverse(bones[parent].bind) * rest;
                key.position = rest.position;
            }
            moves[bone] = moves[bone] || bone == 0 || 1 - likeness(key.rotation, rest.rotation) > kAtRest;
            clip.tracks[bone].times.push_back(i == steps_ ? clip.seconds : step() * static_cast<float>(i));
            clip.tracks[bone].keys.push_back(key);
        }
    }
    std::erase_if(clip.tracks, [&](const ClipTrack& track) { return !moves[static_cast<std::size_t>(track.bone)]; });
    return clip;
}

std::string whyInvalid(const RetargetOptions& options) { return whyOutside(options); }

Retargeted retarget(const Clip& clip, const RagdollDef& from, const RagdollDef& to, const RetargetOptions& options) {
    if (const std::string problem = whyInvalid(options); !problem.empty())
        throw std::invalid_argument("retarget: " + problem);
    if (const std::string problem = whyInvalid(clip, skeletonOf(from)); !problem.empty())
        throw std::invalid_argument("retarget: clip: " + problem);
    return Retargeting(clip, from, to, options).run();
}

}  // namespace ragtop
