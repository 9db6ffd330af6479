#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "alike_sides.h"
#include "fit.h"
#include "fit_foot.h"
#include "fit_hull.h"
#include "inertia.h"
#include "joint_limits.h"
#include "masses.h"
#include "ragtop/ragdoll.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr std::size_t kFewVertices = 12;  ///< less skin than this says nothing about a shape
constexpr double kBodyVolume = 0.0140;    ///< of a human over the cube of the height: 75 l at 1.75 m
constexpr float kAnkleShare = 0.75f;      ///< of its height, that a shank reaches beyond the ankle at most
constexpr float kAnkleBend = 0.5f;        ///< rad, of an ankle, at which its shank is still to be off the ground
constexpr float kAlikeSlack = 0.015f;     ///< of its skin, that a shape may leave out more to be that of the other side
constexpr float kLeast = 0.005f;          ///< of the height, that a shape is thick
/// Of the largest part that hangs on it, that a part has of volume for its mass at least: limbs taper outwards, and a
/// link of feathers between heavy ones holds in no solver.
constexpr double kTaper = 0.25;
constexpr float kRoundness = 1.6f;  ///< times the volume of a box, that a capsule in its stead may have
constexpr float kMostAir = 1.2f;    ///< times the volume of the skin, that a capsule or box in place of a hull may have
constexpr float kSpan = 0.25f;      ///< of a segment's length, that a shape fitted to its skin reaches along at least

class Maker {
public:
    Maker(const Skeleton& skeleton, const RagdollOptions& options)
        : skeleton_(skeleton), options_(options), anatomy_(recognise(skeleton, options.roles)) {
        def_.note = anatomy_.note;
    }

    RagdollDef run() {
        measure();
        assignBones();
        assignSkin();
        for (std::size_t i = 0; i < anatomy_.segments.size(); ++i) addPart(i);
        liftOffGround();
        likenSides();
        keepShanksUp();
        giveMass();
        for (std::size_t i = 1; i < anatomy_.segments.size(); ++i) addJoint(static_cast<int>(i));
        ignoreOverlaps();
        return std::move(def_);
    }

private:
    const Frame& bindOf(int bone) const { return skeleton_.bones[static_cast<std::size_t>(bone)].bind; }
    const Segment& segment(int index) const { return anatomy_.segments[static_cast<std::size_t>(index)]; }

    void measure() {
        float lower = std::numeric_limits<float>::infinity(), upper = -lower;
        const auto include = [&](const Vec3& point) {
            lower = std::min(lower, dot(point, anatomy_.up));
            upper = std::max(upper, dot(point, anatomy_.up));
        };
        for (const Bone& bone : skeleton_.bones) include(bone.bind.position);
        for (const auto& vertices : skeleton_.skin)
            for (const Vec3& vertex : vertices) include(vertex);
        height_ = upper - lower;
        if (anatomy_.isHuman() && skeleton_.skin.empty()) height_ = std::max(height_, heightOfJoints());
        if (!(height_ > 0)) height_ = length(boundsOf(skeleton_).upper - boundsOf(skeleton_).lower);
        if (!(height_ > 0)) throw std::invalid_argument("skeleton: all bones are at one point, must have a size");
    }

    /// From ankles to the base of the neck it is four fifths of the height [Winter 2009, fig. 4.1].
    float heightOfJoints() const {
        float neck = 0, ankles = 0;
        for (const Segment& s : anatomy_.segments) {
            const float above = dot(bindOf(s.bone).position, anatomy_.up);
            if (s.role == BodyRole::head) neck = above;
            if (s.role == BodyRole::foot) ankles += 0.5f * above;
        }
        return 1.25f * (neck - ankles);
    }

    /// A bone belongs to the nearest segment on its way to the root; what hangs on none follows the first.
    void assignBones() {
        std::vector<int> begins(skeleton_.bones.size(), -1);
        for (std::size_t i = 0; i < anatomy_.segments.size(); ++i)
            begins[static_cast<std::size_t>(anatomy_.segments[i].bone)] = static_cast<int>(i);
        for (std::size_t i = 0; i < skeleton_.bones.size(); ++i) {
            const Bone& bone = skeleton_.bones[i];
            int part = begins[i];
            if (part < 0) part = bone.parent < 0 ? 0 : def_.bones[static_cast<std::size_t>(bone.parent)].part;
            const Frame& carrier = bindOf(segment(part).bone);
            def_.bones.push_back({bone.name, bone.parent, part, inverse(carrier) * bone.bind});
        }
    }

    void assignSkin() {
        skin_.resize(anatomy_.segments.size());
        share_.assign(skin_.size(), options_.containedShare);
        for (std::size_t i = 0; i < skeleton_.skin.size(); ++i) {
            std::vector<Vec3>& of = skin_[static_cast<std::size_t>(def_.bones[i].part)];
            of.insert(of.end(), skeleton_.skin[i].begin(), skeleton_.skin[i].end());
        }
    }

    bool isTrunk(BodyRole role) const {
        return role == BodyRole::pelvis || role == BodyRole::abdomen || role == BodyRole::chest;
    }

    /// Where a segment ends; rigs without fingers, toes or skulls get those of a human.
    Vec3 endOf(const Segment& s) const {
        const Vec3 start = bindOf(s.bone).position;
        if (length(s.end - start) > 0.02f * height_) return s.end;
        if (s.role == BodyRole::hand) {
            const Vec3 elbow = bindOf(segment(s.parent).bone).position;
            return start + 0.1f * height_ * normalized(start - elbow, -anatomy_.up);
        }
        if (s.role == BodyRole::foot) return start + 0.12f * height_ * anatomy_.forward;
        if (s.role == BodyRole::head) return start + 0.15f * height_ * anatomy_.up;
        return start + 0.05f * height_ * anatomy_.up;
    }

    /// The axes of a shape: y along the segment, upright in the trunk; the foot lies on its sole.
    Quat basisOf(const Segment& s) const {
        const Vec3 along = endOf(s) - bindOf(s.bone).position;
        Vec3 y = normalized(along, anatomy_.up);
        const bool upright = isTrunk(s.role) || s.role == BodyRole::head;
        if (anatomy_.isHuman() && upright) y = anatomy_.up;
        if (anatomy_.isHuman() && s.role == BodyRole::foot)
            y = normalized(along - dot(along, anatomy_.up) * anatomy_.up, anatomy_.forward);
        const bool level = s.role == BodyRole::foot || !anatomy_.isHuman();
        const Vec3 ahead = level ? anatomy_.up : anatomy_.forward;
        const Vec3 z = normalized(ahead - dot(ahead, y) * y, perpendicular(y));
        return rotationFromAxes(cross(y, z), y, z);
    }

    /// A capsule or box where that leaves little air round the skin, else a hull: it takes longer in contact.
    FittedShape around(const Segment& s, std::span<const Vec3> skin, float share) const {
        // What stands has a sole: a capsule would roll.
        const Quat basis = basisOf(s);
        if (anatomy_.isHuman() && s.role == BodyRole::foot) return fitFoot(skin, basis, share);
        const auto hull = fitHull(skin, basis, share);
        const auto airy = [&](const FittedShape& shape, float room) {
            return hull && massOf(shape.shape, 1).mass > room * kMostAir * hull->pointsVolume;
        };
        // A few points tell as a rule.
        constexpr float kRoom = 1.1f;
        if (skin.size() > kSampledPoints && airy(fitShape(sampled(skin), basis, share, kRoundness), kRoom))
            return hull->fitted;
        FittedShape simple = fitShape(skin, basis, share, kRoundness);
        return airy(simple, 1) ? hull->fitted : simple;
    }

    /// Does a shape reach along enough of its segment? A disc on a long bone has next to no inertia against what pulls
    /// at the ends of that.
    bool spans(const Segment& s, const FittedShape& fitted) const {
        const Vec3 bone = endOf(s) - bindOf(s.bone).position, along = normalized(bone, anatomy_.up);
        return -bottomOf(fitted, -along) - bottomOf(fitted, along) >= kSpan * length(bone);
    }

    void addPart(std::size_t index) {
        const Segment& s = anatomy_.segments[index];
        RagdollPart part;
        part.role = s.role;
        part.side = s.side;
        part.bone = s.bone;
        part.bind = bindOf(s.bone);
        part.name = skeleton_.bones[static_cast<std::size_t>(s.bone)].name;
        part.material = options_.material;
        const std::vector<Vec3>& skin = skin_[index];
        FittedShape fitted = skin.size() < kFewVertices ? fromTables(s) : around(s, skin, options_.containedShare);
        if (!spans(s, fitted)) fitted = fromTables(s);
        const float least = kLeast * height_;
        if (auto* capsule = std::get_if<Capsule>(&fitted.shape)) capsule->radius = std::max(capsule->radius, least);
        if (auto* box = std::get_if<Box>(&fitted.shape))
            box->halfExtents = max(box->halfExtents, {least, least, least});
        def_.parts.push_back(std::move(part));
        inModel_.emplace_back();
        place(index, std::move(fitted));
    }

    void place(std::size_t index, FittedShape fitted) {
        RagdollPart& part = def_.parts[index];
        part.frame = inverse(part.bind) * fitted.frame;
        part.frame.rotation = normalized(part.frame.rotation);
        part.shape = fitted.shape;
        inModel_[index] = std::move(fitted);
    }

    /// A part's shape above a floor: a flat one where a round one would leave out too much of the skin that ends there,
    /// as of wide trousers.
    FittedShape lifted(std::size_t index, const Vec3& up, float floor) const {
        if (bottomOf(inModel_[index], up) >= floor) return inModel_[index];
        const float least = kLeast * height_;
        FittedShape kept = keptAbove(inModel_[index], up, floor, least);
        const std::vector<Vec3>& skin = skin_[index];
        const auto wanted = static_cast<int>(options_.containedShare * static_cast<float>(skin.size()));
        if (skin.size() < kFewVertices || countInside(kept, skin) >= wanted) return kept;
        const FittedShape flat = keptAbove(
            fitBox(skin, basisOf(segment(static_cast<int>(index))), options_.containedShare), up, floor, least);
        return countInside(flat, skin) > countInside(kept, skin) ? flat : kept;
    }

    /// Down to where a shank may reach along itself.
    struct ShankFloor {
        Vec3 along;
        float floor = 0;  ///< m
    };
    ShankFloor floorOver(std::size_t foot) const {
        const Segment& s = segment(static_cast<int>(foot));
        const Vec3 ankle = bindOf(s.bone).position;
        const Vec3 along = normalized(bindOf(segment(s.parent).bone).position - ankle, anatomy_.up);
        return {along, dot(ankle, along) - kAnkleShare * heightOfAnkle(foot)};
    }
    float heightOfAnkle(std::size_t foot) const {
        return dot(bindOf(segment(static_cast<int>(foot)).bone).position, anatomy_.up) -
               bottomOf(inModel_[foot], anatomy_.up);
    }
    /// The same where the ankle bends by α: what is r beside the axis of a shank and c below the ankle is c cos α +
    /// r sin α below it then.
    ShankFloor floorWhereBent(std::size_t foot) const {
        const ShankFloor over = floorOver(foot);
        const SinCos bent = sinCos(kAnkleBend);
        const Vec3 ankle = bindOf(segment(static_cast<int>(foot)).bone).position,
                   ahead = normalized(anatomy_.forward - dot(anatomy_.forward, over.along) * over.along,
                                      perpendicular(over.along));
        float beside = 0;
        for (const Vec3& way : {ahead, -ahead})
            beside = std::max(beside, -bottomOf(inModel_[shankOf(foot)], -way) - dot(ankle, way));
        const float most = (heightOfAnkle(foot) - bent.sin * beside) / bent.cos;
        return {over.along, std::max(over.floor, dot(ankle, over.along) - most)};
    }
    void keepShanksUp() {
        for (const std::size_t foot : standing_) {
            const ShankFloor over = floorWhereBent(foot);
            place(shankOf(foot), keptAbove(inModel_[shankOf(foot)], over.along, over.floor, kLeast * height_));
        }
    }

    /// The skin of a shank that hangs over its foot, as of wide trousers, becomes the foot's: so much of it that both
    /// hold as much as asked of all that the shank has.
    void coverHem(std::size_t foot) {
        const ShankFloor over = floorWhereBent(foot);
        std::vector<Vec3>& skin = skin_[foot];
        const std::vector<Vec3>& ofShank = skin_[shankOf(foot)];
        if (skin.size() < kFewVertices) return;
        const std::size_t own = skin.size();
        std::vector<Vec3> above;
        for (const Vec3& vertex : ofShank) (dot(vertex, over.along) < over.floor ? skin : above).push_back(vertex);
        if (skin.size() == own) return;
        const FittedShape cut = keptAbove(inModel_[shankOf(foot)], over.along, over.floor, kLeast * height_);
        const float may = 1 - options_.containedShare;
        const auto missed = static_cast<float>(above.size()) - static_cast<float>(countInside(cut, above));
        const LeftOut allowed{may * static_cast<float>(own),
                              std::max(0.0f, may * static_cast<float>(ofShank.size()) - missed)};
        share_[foot] = 1 - (allowed.own + allowed.rest) / static_cast<float>(skin.size());
        place(foot, fitBoth(skin, own, allowed, [&](std::span<const Vec3> points, float share) {
                  return around(segment(static_cast<int>(foot)), points, share);
              }));
    }

    /// What has feet stands on them: no other shape reaches below their soles.
    void liftOffGround() {
        for (std::size_t i = 0; i < inModel_.size(); ++i)
            if (def_.parts[i].role == BodyRole::foot && segment(static_cast<int>(i)).parent >= 0)
                standing_.push_back(i);
        if (standing_.empty()) return;
        ground_ = std::numeric_limits<float>::infinity();
        for (const std::size_t foot : standing_) {
            coverHem(foot);
            ground_ = std::min(ground_, bottomOf(inModel_[foot], anatomy_.up));
        }
        for (std::size_t i = 0; i < inModel_.size(); ++i)
            if (def_.parts[i].role != BodyRole::foot) place(i, lifted(i, anatomy_.up, ground_));
        for (const std::size_t foot : standing_) {
            const ShankFloor over = floorOver(foot);
            place(shankOf(foot), lifted(shankOf(foot), over.along, over.floor));
        }
    }
    std::size_t shankOf(std::size_t foot) const {
        return static_cast<std::size_t>(segment(static_cast<int>(foot)).parent);
    }

    /// Parts with skin that are on both sides.
    std::vector<std::pair<std::size_t, std::size_t>> pairsOfSides() const {
        std::vector<std::pair<std::size_t, std::size_t>> pairs;
        std::vector<bool> paired(inModel_.size(), false);
        const auto isOf = [&](std::size_t part, BodySide side) {
            return def_.parts[part].side == side && !paired[part] && skin_[part].size() >= kFewVertices;
        };
        for (std::size_t i = 0; i < inModel_.size(); ++i)
            for (std::size_t k = 0; k < inModel_.size(); ++k) {
                if (def_.parts[k].role != def_.parts[i].role || !isOf(i, BodySide::left) || !isOf(k, BodySide::right))
                    continue;
                pairs.emplace_back(i, k);
                paired[i] = paired[k] = true;
            }
        return pairs;
    }

    /// The plane that most pairs lie evenly about, as axes with x across it.
    Frame planeOfSymmetry(const std::vector<std::pair<std::size_t, std::size_t>>& pairs) const {
        std::vector<float> middles;
        for (const auto& [left, right] : pairs) {
            float lower = std::numeric_limits<float>::infinity(), upper = -lower;
            for (const std::size_t part : {left, right})
                for (const Vec3& vertex : skin_[part]) {
                    lower = std::min(lower, dot(vertex, anatomy_.left));
                    upper = std::max(upper, dot(vertex, anatomy_.left));
                }
            middles.push_back(0.5f * (lower + upper));
        }
        const auto middle = middles.begin() + static_cast<std::ptrdiff_t>(middles.size() / 2);
        std::nth_element(middles.begin(), middle, middles.end());
        return {*middle * anatomy_.left, rotationFromAxes(anatomy_.left, anatomy_.up, anatomy_.forward)};
    }

    /// One shape about the skins of both sides, laid over each other; it leaves out no more than one of them may.
    bool coverBoth(std::size_t index, SidePart& left, SidePart& right, float share) const {
        std::vector<Vec3> both = mirrored(right.skin, right.axes, left.axes);
        both.insert(both.end(), left.skin.begin(), left.skin.end());
        const auto least = static_cast<float>(std::min(left.skin.size(), right.skin.size()));
        const float covered = 1 - (1 - share) * least / static_cast<float>(both.size());
        return makeAlike(left, right, around(segment(static_cast<int>(index)), both, covered), share);
    }

    /// What is nearly the same on both sides is the same: across the middle of the body, or limb by limb where the rest
    /// pose is not symmetric.
    void likenSides() {
        const std::vector<std::pair<std::size_t, std::size_t>> pairs = pairsOfSides();
        if (pairs.empty()) return;
        const Frame plane = planeOfSymmetry(pairs);
        const auto limb = [&](std::size_t part) {
            const Segment& s = segment(static_cast<int>(part));
            return Frame{bindOf(s.bone).position, basisOf(s)};
        };
        for (const auto& [i, k] : pairs) {
            const float share = std::min(share_[i], share_[k]) - kAlikeSlack;
            SidePart left{plane, inModel_[i], skin_[i]}, right{plane, inModel_[k], skin_[k]};
            bool alike = makeAlike(left, right, share);
            if (!alike) {
                left.axes = limb(i);
                right.axes = limb(k);
                alike = makeAlike(left, right, share) || coverBoth(i, left, right, share);
            }
            if (!alike) continue;
            place(i, keptAbove(left.fitted, anatomy_.up, ground_, kLeast * height_));
            place(k, keptAbove(right.fitted, anatomy_.up, ground_, kLeast * height_));
        }
    }

    /// 0.152 of the height long, 0.055 wide, the ankle 0.039 above the sole [Winter 2009, fig. 4.1] and a quarter of
    /// the length before the heel.
    FittedShape footOf(const Segment& s) const {
        const Quat basis = basisOf(s);
        const Vec3 half = (0.5f * height_) * Vec3{0.055f, 0.152f, 0.039f};
        const Vec3 center = bindOf(s.bone).position + rotate(basis, {0, 0.5f * half.y, -half.z});
        return {Box{half}, {center, basis}};
    }

    /// Without skin a part has the volume that its share of the mass has in a human: limbs as capsules, the trunk as
    /// boxes half as wide again as deep.
    FittedShape fromTables(const Segment& s) const {
        const Vec3 start = bindOf(s.bone).position, end = endOf(s);
        const float reach = length(end - start);
        if (!anatomy_.isHuman() || !(massShare(s.role, 0) > 0)) {
            const Vec3 axis = normalized(end - start, {0, 1, 0});
            const float radius = 0.15f * reach;
            return {Capsule{radius, 0.5f * reach - radius}, {0.5f * (start + end), rotationBetween({0, 1, 0}, axis)}};
        }
        const double cube = static_cast<double>(height_) * height_ * height_;
        const auto volume = static_cast<float>(massShare(s.role, options_.femaleShare) * kBodyVolume * cube);
        if (s.role == BodyRole::foot) return footOf(s);
        if (!isTrunk(s.role)) return capsuleBetween(start, end, volume);
        const float tall = std::max(dot(end - start, anatomy_.up), 0.08f * height_);
        const float deep = std::sqrt(volume / (1.5f * tall));
        const Vec3 center = start + 0.5f * tall * anatomy_.up;
        return {Box{{0.75f * deep, 0.5f * tall, 0.5f * deep}}, {center, basisOf(s)}};
    }

    /// The rounding of the sum goes to the heaviest part.
    void giveMass() {
        std::vector<MassPart> parts;
        for (const RagdollPart& part : def_.parts)
            parts.push_back({part.role, part.side, static_cast<double>(massOf(part.shape, 1.0f).mass)});
        for (std::size_t i = parts.size(); i-- > 1;) {
            MassPart& carrier = parts[static_cast<std::size_t>(segment(static_cast<int>(i)).parent)];
            if (anatomy_.isHuman() && massShare(carrier.role, 0) > 0) continue;  // the table knows better
            carrier.volume = std::max(carrier.volume, kTaper * parts[i].volume);
        }
        MassWish wish{anatomy_.isHuman(), options_.femaleShare, options_.bodyMassIndex, stature(), {}};
        if (options_.bodyMass) wish.bodyMass = *options_.bodyMass;
        const Masses shared = shareMass(parts, wish);
        std::size_t heaviest = 0;
        double sum = 0, given = 0;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            def_.parts[i].mass = static_cast<float>(shared.mass[i]);
            sum += shared.mass[i];
            given += def_.parts[i].mass;
            if (shared.mass[i] > shared.mass[heaviest]) heaviest = i;
        }
        if (wish.bodyMass) sum = *wish.bodyMass;
        def_.parts[heaviest].mass += static_cast<float>(sum - given);
        if (!shared.note.empty()) def_.note += (def_.note.empty() ? "" : "; ") + shared.note;
    }

    /// m, of a human who stands up: hips are at 0.53 and shoulders at 0.82 of it [Winter 2009, fig. 4.1]. Who stands at
    /// rest is as tall as that.
    float stature() const {
        float legs = 0, most = 0;
        for (const Segment& s : anatomy_.segments) {
            const float way = length(s.end - bindOf(s.bone).position);
            if (s.role == BodyRole::thigh) legs = way;
            if (s.role == BodyRole::shank) most = std::max(most, legs + way);
        }
        return std::max(height_, 0.9f * most / 0.49f);
    }

    void addJoint(int child) {
        RagdollJoint joint{segment(child).parent, child,
                           anatomicalJoint(skeleton_, anatomy_, child, options_.limitScale)};
        float beyond = 0;
        for (int i = child; i < static_cast<int>(def_.parts.size()); ++i) {
            int at = i;
            while (at > child) at = segment(at).parent;
            if (at == child) beyond += def_.parts[static_cast<std::size_t>(i)].mass;
        }
        const float reach = reachOf(def_.parts[static_cast<std::size_t>(child)]);
        const float torque = options_.jointFriction * beyond * kGravity * reach;
        if (auto* ball = std::get_if<BallDef>(&joint.joint)) ball->friction = torque;
        if (auto* hinge = std::get_if<HingeDef>(&joint.joint)) hinge->friction = torque;
        def_.joints.push_back(std::move(joint));
    }

    /// From the joint of a part to its far side.
    static float reachOf(const RagdollPart& part) {
        const float center = length(part.frame.position);
        if (const auto* capsule = std::get_if<Capsule>(&part.shape))
            return center + capsule->halfHeight + capsule->radius;
        if (const auto* box = std::get_if<Box>(&part.shape))
            return center + std::max({box->halfExtents.x, box->halfExtents.y, box->halfExtents.z});
        float far = 0;
        for (const Vec3& corner : std::get<ConvexHull>(part.shape).vertices())
            far = std::max(far, length(transformPoint(part.frame, corner)));
        return far;
    }

    /// Joined parts never collide, nor do those that overlap at rest: the shapes of a body are rounder than it is.
    void ignoreOverlaps() {
        def_.selfCollision = options_.selfCollision;
        if (!def_.selfCollision) return;
        World world;
        for (std::size_t i = 0; i < inModel_.size(); ++i) {
            BodyDef body{.type = BodyType::fixed,
                         .pose = {DVec3(inModel_[i].frame.position), inModel_[i].frame.rotation}};
            body.shapes.push_back({.geometry = inModel_[i].shape, .userData = i});
            const BodyId id = world.create(body);
            const auto meet = [&](ShapeId shape) {
                const auto other = static_cast<int>(world.userData(shape)), one = static_cast<int>(i);
                if (other != one && segment(one).parent != other) def_.ignored.push_back({other, one});
                return true;
            };
            world.overlap(inModel_[i].shape, world.pose(id), meet);
        }
        std::sort(def_.ignored.begin(), def_.ignored.end(), [](const RagdollPair& a, const RagdollPair& b) {
            return a.first != b.first ? a.first < b.first : a.second < b.second;
        });
    }

    const Skeleton& skeleton_;
    const RagdollOptions& options_;
    Anatomy anatomy_;
    RagdollDef def_;
    std::vector<std::vector<Vec3>> skin_;  ///< of each part
    std::vector<float> share_;             ///< of that, which a part is to hold
    std::vector<FittedShape> inModel_;
    std::vector<std::size_t> standing_;  ///< feet
    float height_ = 0;
    float ground_ = -std::numeric_limits<float>::infinity();  ///< m along up, of the soles where it has feet
};

}  // namespace

RagdollDef makeRagdoll(const Skeleton& skeleton, const RagdollOptions& options) {
    if (const std::string problem = whyInvalid(options); !problem.empty())
        throw std::invalid_argument("ragdoll options: " + problem);
    RagdollDef def = Maker(skeleton, options).run();
    // Skeletons far too small or too large for shapes, or too light for their number of parts.
    if (const std::string problem = whyInvalid(def); !problem.empty())
        throw std::invalid_argument("skeleton: gives no usable ragdoll: " + problem);
    return def;
}

}  // namespace ragtop
