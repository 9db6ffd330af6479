#include "world/draw_joint.h"

namespace ragtop {
namespace {

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
    void operator()(const FixedDef&) const {}
};

}  // namespace

void drawJoint(DebugDraw& draw, const JointDef& def, const JointState& state, const Pose& a, const Pose& b,
               float size) {
    draw.frame(a, 0.4f * size);
    std::visit(JointPainter{draw, state, a, b, size}, def);
}

}  // namespace ragtop
