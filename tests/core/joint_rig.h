#pragma once

#include <cmath>
#include <vector>

#include "constraints/joint_bundles.h"
#include "constraints/joint_sim.h"
#include "ragtop/math.h"
#include "solve/body_state.h"
#include "solve/joint_kernels.h"

/// A few bodies and joints and the substep loop, without a world: so joints are tested alone.
namespace ragtop::test {

struct RigBody {
    DVec3 position;
    Quat rotation;
    Vec3 v, w;
    float mass = 0;  // kg, 0: static
    Vec3 inertia;    // kg m², principal, about the body's axes
    std::uint32_t locks = 0;
};

class Rig {
public:
    Rig() { bodies.emplace_back(); }

    std::vector<RigBody> bodies;  // 0 is the world
    std::vector<AxesJointSim> joints;  // of any kind
    Vec3 gravity{0, -9.81f, 0};
    double dt = 1.0 / 60;
    int substeps = 4;
    float jointFrequency = 0.25f, jointDamping = 2;  // as WorldSettings

    std::uint32_t add(const RigBody& body) {
        bodies.push_back(body);
        return static_cast<std::uint32_t>(bodies.size() - 1);
    }
    JointSim& join(std::uint32_t a, std::uint32_t b, const JointDef& def) {
        AxesJointSim joint;
        joint.stateA = a;
        joint.stateB = b;
        compileJoint(def, {}, {}, joint);
        joints.push_back(joint);
        return joints.back();
    }
    std::vector<JointSim*> places() {
        std::vector<JointSim*> sims;
        for (JointSim& joint : joints) sims.push_back(&joint);
        return sims;
    }
    float h() const { return static_cast<float>(dt / substeps); }
    JointContext context() const {
        const float substep = h();
        return {substep, 1 / substep, makeSoftness(jointFrequency / substep, jointDamping, substep)};
    }
    JointState state(std::size_t joint = 0) const {
        return jointState(joints[joint], atStep(joints[joint]), states_.data(), 1 / h());
    }

    void step() {
        begin();
        const JointContext shared = context();
        for (JointSim& joint : joints) prepareJoint(joint, atStep(joint), states_.data(), inertia_.data(), shared);
        for (int i = 0; i < substeps; ++i) {
            fall(shared.h);
            for (JointSim& joint : joints) warmStartJoint(joint, states_.data(), inertia_.data(), shared);
            for (JointSim& joint : joints) solveJoint(joint, states_.data(), inertia_.data(), shared, true);
            for (std::size_t b = 1; b < bodies.size(); ++b) move(b, shared.h);
            for (JointSim& joint : joints) solveJoint(joint, states_.data(), inertia_.data(), shared, false);
        }
        end();
    }
    /// The same in lanes, as far as bundles go. No two joints share a moving body.
    void step(const JointKernels& kernels, JointBundles& lanes) {
        begin();
        const std::vector<JointSim*> sims = places();
        const JointLanesView view = lanes.view(sims.data());
        const int bundles = lanes.color(ConstraintGraph::kOverflow).end;
        const auto singles = [&](auto&& visit) {
            for (int i = 0; i < lanes.color(ConstraintGraph::kOverflow).endSingle; ++i) visit(joints[lanes.single(i)]);
        };
        const JointPass pass{{states_.data(), inertia_.data(), nullptr, nullptr}, context()};
        for (JointSim& joint : joints)
            prepareJoint(joint, atStep(joint), states_.data(), inertia_.data(), pass.context);
        kernels.load(view, 0, bundles);
        for (int i = 0; i < substeps; ++i) {
            fall(pass.context.h);
            kernels.warmStart(view, 0, bundles, pass);
            singles([&](JointSim& j) { warmStartJoint(j, states_.data(), inertia_.data(), pass.context); });
            kernels.solve(view, 0, bundles, pass);
            singles([&](JointSim& j) { solveJoint(j, states_.data(), inertia_.data(), pass.context, true); });
            for (std::size_t b = 1; b < bodies.size(); ++b) move(b, pass.context.h);
            kernels.relax(view, 0, bundles, pass);
            singles([&](JointSim& j) { solveJoint(j, states_.data(), inertia_.data(), pass.context, false); });
        }
        kernels.store(view, 0, bundles);
        end();
    }
    void run(double seconds) {
        for (int i = 0; i < static_cast<int>(seconds / dt + 0.5); ++i) step();
    }
    void begin() {
        states_.assign(bodies.size(), BodyState{});
        inertia_.assign(bodies.size(), BodyInertia{});
        taut_.resize(bodies.size());
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            const RigBody& body = bodies[b];
            states_[b].v = body.v;
            states_[b].w = body.w;
            states_[b].invMass = body.mass > 0 ? 1 / body.mass : 0.0f;
            states_[b].locks = body.locks;
            inertia_[b] = inverseInertia(body, body.rotation);
            inertia_[b].taut = taut_[b];
        }
    }
    BodyState* states() { return states_.data(); }
    BodyInertia* inertia() { return inertia_.data(); }
    JointBodiesAtStep atStep(const JointSim& joint) const {
        const RigBody &a = bodies[joint.stateA], &b = bodies[joint.stateB];
        return {relative(b.position, a.position), a.rotation, b.rotation};
    }

    double energy() const {
        double sum = 0;
        for (const RigBody& body : bodies) {
            const Vec3 w = inverseRotate(body.rotation, body.w);
            sum += 0.5 * body.mass * lengthSquared(body.v) + 0.5 * dot(w, scale(body.inertia, w));
            sum -=
                body.mass * (body.position.x * gravity.x + body.position.y * gravity.y + body.position.z * gravity.z);
        }
        return sum;
    }
    /// About the world's origin, kg m²/s.
    DVec3 angularMomentum() const {
        DVec3 sum;
        for (const RigBody& body : bodies) {
            const DVec3 spin = Axes(body.rotation).times(body.inertia, DVec3(body.w), itself);
            const DVec3 p = body.mass * DVec3(body.v), x = body.position;
            sum = sum + DVec3{x.y * p.z - x.z * p.y, x.z * p.x - x.x * p.z, x.x * p.y - x.y * p.x} + spin;
        }
        return sum;
    }

private:
    /// Columns of a rotation, orthonormal to double precision, so that the rig itself keeps momentum.
    struct Axes {
        DVec3 column[3];
        explicit Axes(const Quat& q) {
            const double l = std::sqrt(double(q.x) * q.x + double(q.y) * q.y + double(q.z) * q.z + double(q.w) * q.w);
            const double x = q.x / l, y = q.y / l, z = q.z / l, w = q.w / l;
            column[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
            column[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
            column[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
        }
        /// Σ cᵢ (cᵢ · a) f(iᵢ)
        template <class F>
        DVec3 times(const Vec3& principal, const DVec3& a, F&& f) const {
            DVec3 sum;
            for (int i = 0; i < 3; ++i) {
                const DVec3& c = column[i];
                sum = sum + f(principal[i]) * (c.x * a.x + c.y * a.y + c.z * a.z) * c;
            }
            return sum;
        }
    };
    static double itself(double i) { return i; }
    static double inverse(double i) { return i > 0 ? 1 / i : 0.0; }

    static BodyInertia inverseInertia(const RigBody& body, const Quat& q) {
        if (!(body.mass > 0)) return {};
        const Axes axes(q);
        const Vec3 x = toVec3(axes.times(body.inertia, {1, 0, 0}, inverse));
        const Vec3 y = toVec3(axes.times(body.inertia, {0, 1, 0}, inverse));
        const Vec3 z = toVec3(axes.times(body.inertia, {0, 0, 1}, inverse));
        return {x.x, x.y, x.z, y.y, y.z, z.z, {}};
    }
    void fall(float substep) {
        momentum_.resize(bodies.size());
        led_.resize(bodies.size());
        for (std::size_t b = 1; b < bodies.size(); ++b) {
            if (!(bodies[b].mass > 0)) continue;
            BodyState& state = states_[b];
            state.v += substep * gravity;
            // Joints see the angular velocity of half a substep ahead.
            const Axes axes(state.dq * bodies[b].rotation);
            momentum_[b] = axes.times(bodies[b].inertia, DVec3(state.w), itself);
            state.w += 0.5f * substep * (inertia_[b] * cross(toVec3(momentum_[b]), state.w));
            led_[b] = state.w;
        }
    }
    /// Keeps the angular momentum over the rotation.
    void move(std::size_t b, float substep) {
        const RigBody& body = bodies[b];
        BodyState& state = states_[b];
        if (!(body.mass > 0)) return;
        const Axes before(state.dq * body.rotation);
        const DVec3 momentum = momentum_[b] + before.times(body.inertia, DVec3(state.w - led_[b]), itself);
        state.dp += substep * state.v;
        const float rate = length(state.w);
        if (rate > 0) state.dq = normalized(rotationAbout(state.w, rate * substep) * state.dq);
        const Quat after = state.dq * body.rotation;
        inertia_[b] = inverseInertia(body, after);
        // As the world's bodies: what holds for one substep alone counts half.
        const float taut = state.pull - TautBody::kExplicit;
        taut_[b] = taut < taut_[b] ? taut : 0.5f * (taut_[b] + taut);
        inertia_[b].taut = taut_[b];
        state.pull = 0;
        state.w = toVec3(Axes(after).times(body.inertia, momentum, inverse));
    }
    void end() {
        for (std::size_t b = 1; b < bodies.size(); ++b) {
            RigBody& body = bodies[b];
            body.position = body.position + states_[b].dp;
            body.rotation = normalized(states_[b].dq * body.rotation);
            body.v = states_[b].v;
            body.w = states_[b].w;
        }
    }

    std::vector<BodyState> states_;
    std::vector<BodyInertia> inertia_;
    std::vector<DVec3> momentum_;
    std::vector<float> taut_;
    std::vector<Vec3> led_;
};

/// A rod or box of uniform density, kg and kg m².
inline RigBody box(float mass, const Vec3& halfExtents, const DVec3& position) {
    const Vec3 s = scale(halfExtents, halfExtents);
    const float third = mass / 3;
    return {position, {}, {}, {}, mass, {third * (s.y + s.z), third * (s.x + s.z), third * (s.x + s.y)}, 0};
}

inline JointBodies frames(const Vec3& a, const Vec3& b, const Quat& rotationA = {}, const Quat& rotationB = {}) {
    JointBodies bodies;
    bodies.frameA = {a, rotationA};
    bodies.frameB = {b, rotationB};
    return bodies;
}

}  // namespace ragtop::test
