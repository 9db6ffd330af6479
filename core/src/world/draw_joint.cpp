#include "world/draw_joint.h"

#include "constraints/joint_path.h"
#include "constraints/joint_swing.h"

namespace ragtop {
namespace {

// 0xRRGGBB
constexpr Color kJointColor = 0x3fb28f, kLimitColor = 0x57c7f2, kReachedColor = 0xff5a4f, kNowColor = 0xf5d547;
constexpr float kReached = 0.02f;  ///< rad, or sizes, within which a limit counts as reached
constexpr int kAround = 24;        ///< lines of a full circle

struct JointPainter {
    DebugDraw& draw;
    const JointState& state;
    Pose a, b;
    float size;

    Color limitColor(float slack) const { return state.limitMargin < slack ? kReachedColor : kLimitColor; }
    DVec3 at(const Vec3& inA) const { return transformPoint(a, size * inA); }

    /// About A's x axis, from y towards z, at a height along x.
    void arc(float from, float to, float radius, float height, Color color) const {
        const int lines = 1 + static_cast<int>(static_cast<float>(kAround) * (to - from) / (2 * kPi));
        DVec3 last;
        for (int i = 0; i <= lines; ++i) {
            const SinCos angle = sinCos(from + (to - from) * static_cast<float>(i) / static_cast<float>(lines));
            const DVec3 point = at({height, radius * angle.cos, radius * angle.sin});
            if (i > 0) draw.line(last, point, color);
            last = point;
        }
    }
    /// A slice of that plane with what it holds now.
    void range(const Range& limit, float now, Color color) const {
        arc(limit.lower, limit.upper, 1, 0, color);
        for (const float end : {limit.lower, limit.upper}) spoke(end, color);
        spoke(now, kNowColor);
    }
    void spoke(float angle, Color color) const {
        const SinCos s = sinCos(angle);
        draw.line(a.position, at({0, s.cos, s.sin}), color);
    }

    /// A closed edge on the sphere of B's x axis, with lines from the joint, and that axis.
    template <class Direction>
    void edge(int lines, int perSpoke, Direction&& direction, Color color) const {
        for (int i = 0; i < lines; ++i) {
            draw.line(at(direction(i)), at(direction(i + 1)), color);
            if (i % perSpoke == 0) draw.line(a.position, at(direction(i)), color);
        }
        draw.line(a.position, transformPoint(Pose{a.position, b.rotation}, {size, 0, 0}), kNowColor);
    }
    void swingEdge(const BallDef& ball, Color color) const {
        edge(
            2 * kAround, kAround / 4,
            [&](int i) {
                const SinCos around = sinCos(kPi / kAround * static_cast<float>(i));
                return directionOfSwing(ball.swingEllipse->y * around.cos, ball.swingEllipse->z * around.sin);
            },
            color);
    }
    void pyramid(const SwingPyramid& limit, Color color) const {
        const auto corner = [&](float y, float z) {
            const SinCos aboutY = sinCos(y), aboutZ = sinCos(z);
            // The two great circles through y and z meet here.
            const Vec3 first{-aboutY.sin, 0, -aboutY.cos}, second{-aboutZ.sin, aboutZ.cos, 0};
            return normalized(cross(first, second));
        };
        const Vec3 corners[4] = {corner(limit.y.lower, limit.z.lower), corner(limit.y.upper, limit.z.lower),
                                 corner(limit.y.upper, limit.z.upper), corner(limit.y.lower, limit.z.upper)};
        edge(
            4, 1, [&](int i) { return corners[i % 4]; }, color);
    }
    void polygon(const ReachPolygon& reach, Color color) const {
        constexpr int kPerEdge = 6;  // lines of an arc between two corners
        edge(
            kPerEdge * reach.count, kPerEdge,
            [&](int i) {
                const auto corner = [&](int k) {
                    return normalized(reach.corners[static_cast<std::size_t>(k % reach.count)].direction);
                };
                const float share = static_cast<float>(i % kPerEdge) / kPerEdge;
                return normalized((1 - share) * corner(i / kPerEdge) + share * corner(i / kPerEdge + 1));
            },
            color);
    }
    void operator()(const BallDef& ball) const {
        const Color color = limitColor(kReached);
        if (ball.swingLimit) {
            const SinCos cone = sinCos(*ball.swingLimit);
            arc(0, 2 * kPi, cone.sin, cone.cos, color);
            for (int i = 0; i < 8; ++i) {
                const SinCos around = sinCos(kPi / 4 * static_cast<float>(i));
                draw.line(a.position, at({cone.cos, cone.sin * around.cos, cone.sin * around.sin}), color);
            }
            draw.line(a.position, transformPoint(Pose{a.position, b.rotation}, {size, 0, 0}), kNowColor);
        }
        if (ball.swingEllipse) swingEdge(ball, color);
        if (ball.swingPyramid) pyramid(*ball.swingPyramid, color);
        if (ball.reach) polygon(*ball.reach, color);
        if (ball.twistLimit) range(*ball.twistLimit, state.coordinate, color);
    }
    void operator()(const HingeDef& hinge) const {
        draw.line(at({-1, 0, 0}), at({1, 0, 0}), kJointColor);
        if (hinge.limit)
            range(*hinge.limit, state.coordinate, limitColor(kReached));
        else
            spoke(state.coordinate, kNowColor);
    }
    void operator()(const SliderDef& slider) const {
        draw.line(a.position, b.position, kNowColor);
        if (!slider.limit) return;
        const Vec3 lower{slider.limit->lower / size, 0, 0}, upper{slider.limit->upper / size, 0, 0};
        const Color color = limitColor(kReached * size);
        draw.line(at(lower), at(upper), color);
        for (const Vec3& end : {lower, upper}) {
            for (const Vec3& tick : {Vec3{0, 0.3f, 0}, Vec3{0, 0, 0.3f}})
                draw.line(at(end - tick), at(end + tick), color);
        }
    }
    void operator()(const DistanceDef& distance) const {
        draw.line(a.position, b.position, distance.limit ? limitColor(kReached * size) : kNowColor);
    }
    /// The axis, and what turning and sliding are allowed along it.
    void axisOf(const AxisDef& turn, const AxisDef& travel) const {
        HingeDef hinge;
        hinge.limit = turn.limit;
        (*this)(hinge);
        SliderDef slider;
        slider.limit = travel.limit;
        (*this)(slider);
    }
    void operator()(const CylindricalDef& joint) const { axisOf(joint.turn, joint.travel); }
    void operator()(const ScrewDef& joint) const { axisOf(joint.turn, {}); }
    void operator()(const UniversalDef& joint) const {
        const Pose cross{a.position, b.rotation};
        draw.line(at({-1, 0, 0}), at({1, 0, 0}), kJointColor);
        draw.line(transformPoint(cross, {0, -size, 0}), transformPoint(cross, {0, size, 0}), kJointColor);
        if (joint.first.limit) range(*joint.first.limit, state.coordinate, limitColor(kReached));
    }
    void operator()(const PlaneDef& joint) const {
        const Range y = joint.y.limit.value_or(Range{-size, size}), z = joint.z.limit.value_or(Range{-size, size});
        const float s = 1 / size;
        const DVec3 corners[4] = {at({0, s * y.lower, s * z.lower}), at({0, s * y.upper, s * z.lower}),
                                  at({0, s * y.upper, s * z.upper}), at({0, s * y.lower, s * z.upper})};
        for (int i = 0; i < 4; ++i) draw.line(corners[i], corners[(i + 1) % 4], limitColor(kReached * size));
        draw.line(a.position, b.position, kNowColor);
    }
    void operator()(const PathDef& joint) const {
        PathRows path;
        compile(path, joint.curve, joint.align);
        DVec3 last;
        for (std::uint32_t s = 0; s < path.segments; ++s)
            for (int i = 0; i <= kAround; ++i) {
                const Vec3 place = curvePoint(path, s, static_cast<float>(i) / kAround).place;
                const DVec3 point = transformPoint(a, place);
                if (i > 0) draw.line(last, point, limitColor(kReached * size));
                last = point;
            }
        draw.line(b.position, transformPoint(b, {size, 0, 0}), kNowColor);
    }
    /// A box of the travels, the cone of the swings and the slice of the twist.
    void operator()(const SixDofDef& joint) const {
        const auto reach = [&](const AxisDef& axis) { return axis.limit.value_or(Range{-size, size}); };
        const Range x = reach(joint.x), y = reach(joint.y), z = reach(joint.z);
        const float s = 1 / size;
        for (int corner = 0; corner < 8; ++corner)
            for (int axis = 0; axis < 3; ++axis) {
                if (corner & 1 << axis) continue;
                const auto place = [&](int k) {
                    return at({s * (k & 1 ? x.upper : x.lower), s * (k & 2 ? y.upper : y.lower),
                               s * (k & 4 ? z.upper : z.lower)});
                };
                draw.line(place(corner), place(corner | 1 << axis), limitColor(kReached * size));
            }
        draw.line(a.position, b.position, kNowColor);
        if (joint.twist.limit) range(*joint.twist.limit, state.coordinate, limitColor(kReached));
        if (!joint.swingY.limit || !joint.swingZ.limit) return;
        const Range &p = *joint.swingY.limit, &q = *joint.swingZ.limit;
        const float corners[4][2] = {{p.lower, q.lower}, {p.upper, q.lower}, {p.upper, q.upper}, {p.lower, q.upper}};
        edge(
            kAround, kAround / 4,
            [&](int i) {
                const int k = i % kAround / (kAround / 4), next = (k + 1) % 4;
                const float share = static_cast<float>(i % (kAround / 4)) / static_cast<float>(kAround / 4);
                return directionOfSwing((1 - share) * corners[k][0] + share * corners[next][0],
                                        (1 - share) * corners[k][1] + share * corners[next][1]);
            },
            limitColor(kReached));
    }
    void operator()(const FixedDef&) const {}
};

}  // namespace

void drawJoint(DebugDraw& draw, const JointDef& def, const JointState& state, const Pose& a, const Pose& b,
               float size) {
    draw.frame(a, 0.4f * size);
    std::visit(JointPainter{draw, state, a, b, size}, def);
}

}  // namespace ragtop
