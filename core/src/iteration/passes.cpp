// The passes of the iteration over constraints, in each substep.

#include <algorithm>
#include <array>
#include <atomic>

#include "constraints/contact_layout.h"
#include "constraints/single_bundle.h"
#include "iteration/iteration.h"

namespace ragtop {

namespace {

/// A list in blocks of `size`, numbered from `first`.
struct Blocks {
    int size, begin, end, first;

    int count() const { return end - begin > size ? (end - begin + size - 1) / size : end > begin ? 1 : 0; }
    int next() const { return first + count(); }
    template <class Visit>
    void visit(int block, Visit&& visit) const {
        const int from = begin + (block - first) * size;
        visit(from, from + size < end ? from + size : end);
    }
};

constexpr int kSettlingIterations =
    16;  ///< that make estimated loads an equilibrium; what is left of their error is local

/// What is in no region: overflow first and serially, then the colours in order, each in parallel: alone(joint) for its
/// single joints, wide(begin, end) and contact(bundles, begin, end) for its bundles.
template <class Joint, class Joints, class Contacts>
void forUndivided(const Iteration& v, Joint&& single, Joints&& wide, Contacts&& contact) {
    constexpr int kJointsPerBlock = 8;  // of a task, by trial
    constexpr int kMostBlocks = 64;     // of contacts: what is next in memory is best solved by the same thread
    const int jointBundlesPerBlock = 32 / v.jointKernels.lanes, leastContactBundles = 32 / v.graph.lanes();
    const auto singles = [&](int begin, int end) {
        for (int i = begin; i < end; ++i) single(v.joints.bundles.single(i));
    };
    constexpr std::uint32_t kSerial = 1u << ConstraintGraph::kOverflow;  // the list that no worker shares
    const std::uint32_t used = v.graph.iteratedLists(0);
    if ((used & kSerial) != 0) {
        const JointBundles::Color& serial = v.joints.bundles.color(ConstraintGraph::kOverflow);
        ConstraintGraph::Color& overflow = v.graph.color(ConstraintGraph::kOverflow);
        singles(serial.firstSingle, serial.endSingle);
        for (int i = 0; i < v.graph.bundleCount(ConstraintGraph::kOverflow); ++i)
            contact(overflow.bundles.data(), i, i + 1);
    }
    forEachBit(used & ~kSerial, [&](int c) {
        float* bundles = v.graph.color(c).bundles.data();
        const JointBundles::Color& bundled = v.joints.bundles.color(c);
        const Blocks singleBlocks{kJointsPerBlock, bundled.firstSingle, bundled.endSingle, 0};
        const Blocks wideBlocks{jointBundlesPerBlock, bundled.begin, bundled.end, singleBlocks.next()};
        const int contactBundles = v.graph.bundleCount(c),
                  size = std::max(leastContactBundles, contactBundles / kMostBlocks);
        const Blocks contactBlocks{size, 0, contactBundles, wideBlocks.next()};
        v.runner.parallelFor(contactBlocks.next(), 1, [&](int begin, int end, int) {
            for (int b = begin; b < end; ++b) {
                if (b < wideBlocks.first)
                    singleBlocks.visit(b, singles);
                else if (b < contactBlocks.first)
                    wideBlocks.visit(b, wide);
                else
                    contactBlocks.visit(b, [&](int first, int last) { contact(bundles, first, last); });
            }
        });
    });
}

/// The same for a region, on the calling thread.
template <class Joint, class Joints, class Contacts>
void forRegion(const Iteration& v, int region, Joint&& single, Joints&& wide, Contacts&& contact) {
    const int first = ConstraintGraph::firstList(region);
    forEachBit(v.graph.iteratedLists(region), [&](int c) {
        const JointBundles::Color& bundled = v.joints.bundles.color(first + c);
        for (int i = bundled.firstSingle; i < bundled.endSingle; ++i) single(v.joints.bundles.single(i));
        if (bundled.begin < bundled.end) wide(bundled.begin, bundled.end);
        const int count = v.graph.bundleCount(first + c);
        if (count > 0) contact(v.graph.color(first + c).bundles.data(), 0, count);
    });
}

/// Calls visit(alone, wide, contact) with what a pass does to single joints, bundles of joints and bundles of contacts.
template <class Visit>
void visitPass(const Iteration& v, SolvePass which, const SolverContext& own, Visit&& visit) {
    const BodyArrays arrays = v.bodies.arrays();
    const JointLanesView lanes = v.joints.bundles.view(v.joints.sims.data());
    JointContext joints = v.jointContext;
    joints.settling = own.settling;
    const JointPass pass{arrays, joints};
    const bool warm = which == SolvePass::warmStart, moving = which == SolvePass::solve;
    const auto passJoints = warm ? v.jointKernels.warmStart : moving ? v.jointKernels.solve : v.jointKernels.relax;
    const auto passContacts = warm     ? v.kernels.warmStartContacts
                              : moving ? v.kernels.solveContacts
                                       : v.kernels.relaxContacts;
    const bool withJoints = warm || own.normals;
    visit(
        [&](std::uint32_t j) {
            if (warm)
                warmStartJoint(v.joints.sims[j], arrays.states, arrays.inertia, v.jointContext);
            else if (withJoints)
                solveJoint(v.joints.sims[j], arrays.states, arrays.inertia, joints, moving);
        },
        [&](int begin, int end) {
            if (withJoints) passJoints(lanes, begin, end, pass);
        },
        [&](float* bundles, int begin, int end) { passContacts(bundles, begin, end, arrays, own); });
}

/// Contacts of direct islands that may bounce.
template <class Visit>
void forEachDirectBouncing(const Iteration& v, Visit&& visit) {
    const auto stride = static_cast<std::size_t>(v.graph.lanes());
    SingleBundle bundle(v.graph.lanes());
    for (const std::uint32_t m : v.graph.color(ConstraintGraph::kDirect).manifolds) {
        float* lane = v.graph.lane(v.manifolds[m].place);
        if (lane[contact::kRestitution * stride] > 0) bundle.visit(lane, visit);
    }
}

/// Adds a share of the velocities that forces and torques, beside gravity, have given in this substep.
void addPushes(Bodies& bodies, const Vec3& gravity, float h, float share) {
    for (const std::uint32_t index : bodies.awake) {
        if (!bodies.moves(index) || bodies.states[index].locks != 0) continue;
        const BodyDynamics& d = bodies.dynamics[index];
        const Vec3 push = d.acceleration - bodies[index].motion.gravityScale * gravity;
        if (push != Vec3{}) bodies.states[index].v += share * h * d.linearDecay * push;
        if (d.torque != Vec3{})
            bodies.states[index].w += share * h * d.angularDecay * (bodies.inertias[index] * d.torque);
    }
}

}  // namespace

void Iteration::passOverRegion(int region, SolvePass which, const SolverContext& own) const {
    visitPass(*this, which, own,
              [&](auto&& single, auto&& wide, auto&& contact) { forRegion(*this, region, single, wide, contact); });
}

void Iteration::passOverAll(SolvePass which, const SolverContext& own) const {
    if (graph.iteratedLists(0) == 0 && graph.regionCount() == 0) return;
    visitPass(*this, which, own,
              [&](auto&& single, auto&& wide, auto&& contact) { forUndivided(*this, single, wide, contact); });
    runner.parallelFor(graph.regionCount(), 1, [&](int begin, int end, int) {
        for (int r = begin + 1; r <= end; ++r) passOverRegion(r, which, own);
    });
}

void Iteration::warmStart() const {
    warmStartCouplings(couplings, joints);
    passOverAll(SolvePass::warmStart, context);
    beginCouplings(couplings, joints, bodies, jointContext);
}

void Iteration::solve(bool useBias, bool sequential) const {
    const SolvePass which = useBias ? SolvePass::solve : SolvePass::relax;
    const auto pass = [&](bool normals, bool friction) {
        context.normals = normals;
        context.friction = friction;
        passOverAll(which, context);
        if (normals) solveCouplings(couplings, joints, bodies, jointContext, useBias);
    };
    if (!sequential) return pass(true, true);
    pass(true, false);
    pass(false, true);
}

void Iteration::bounce() const {
    constexpr int kIterations = 32;  // a bound: an impact goes through so many bodies of a row
    const BodyArrays arrays = bodies.arrays();
    for (int i = 0; i < kIterations; ++i) {
        std::atomic<bool> bounced{false};
        const auto visit = [&](float* bundles, int begin, int end) {
            if (kernels.bounceContacts(bundles, begin, end, arrays, context))
                bounced.store(true, std::memory_order_relaxed);
        };
        const auto single = [](std::uint32_t) {};
        const auto wide = [](int, int) {};
        forEachDirectBouncing(*this, visit);
        forUndivided(*this, single, wide, visit);
        runner.parallelFor(graph.regionCount(), 1, [&](int begin, int end, int) {
            for (int r = begin + 1; r <= end; ++r) forRegion(*this, r, single, wide, visit);
        });
        if (!bounced.load(std::memory_order_relaxed)) return;
    }
}

void Iteration::settleNewContacts(AlignedArray<std::uint32_t>& fresh, const Vec3& gravity, bool sequential) const {
    if (fresh.empty()) return;
    addPushes(bodies, gravity, context.h, -1);
    context.settling = true;
    for (int i = 0; i < kSettlingIterations; ++i) solve(false, sequential);
    context.settling = false;
    addPushes(bodies, gravity, context.h, 1);
    const auto stride = static_cast<std::size_t>(graph.lanes());
    for (const std::uint32_t m : fresh) {
        float* lane = graph.lane(manifolds[m].place);
        for (int j = 0; j < manifolds[m].pointCount; ++j) {
            float* point = lane + static_cast<std::size_t>(contact::kPoints + j * contact::kPointFields) * stride;
            point[contact::kLoad * stride] = point[contact::kImpulse * stride];
        }
    }
    graph.forUsedLists([&](int c) {
        for (const std::uint32_t m : graph.color(c).manifolds)
            for (int j = 0; j < manifolds[m].pointCount; ++j)
                graph.lane(manifolds[m].place)[static_cast<std::size_t>(contact::kPoints + j * contact::kPointFields +
                                                                        contact::kPeak) *
                                               stride] = 0;
    });
    fresh.clear();
}

static bool isIterated(const Iteration& v, std::uint32_t manifold) {
    const GraphPlace place = v.manifolds[manifold].place;
    return place.color != kNone && ConstraintGraph::isIterated(static_cast<int>(place.color));
}

namespace {

constexpr std::size_t kMostContacts = 16;  ///< of a pushed body; a bound of memory: those beyond answer in the passes
constexpr int kBearingSweeps = 32;         ///< a bound: a box that is pressed at a corner takes some 10
constexpr float kBorne = 1e-3f;  ///< of what gravity gives in a substep: change of velocity in a sweep that is the last

/// A contact of a pushed body, and what its lane held before.
struct PushedContact {
    float* lane = nullptr;
    std::uint32_t other = 0;  ///< state of the other body, and what that was
    BodyState otherBefore;
    std::array<float, contact::kFields> before;
};

/// The impulses of sweeps are kept; what else a relaxing pass writes is for passes that follow a motion. What a point
/// bears beyond twice the weight of its own body is carried at once.
void takeLoads(const PushedContact& pushed, std::size_t stride, float gravityStep) {
    const auto now = [&](int field) -> float& { return pushed.lane[static_cast<std::size_t>(field) * stride]; };
    const auto was = [&](int field) { return pushed.before[static_cast<std::size_t>(field)]; };
    std::array<float, contact::kFields> found;
    for (int f = 0; f < contact::kFields; ++f) {
        found[static_cast<std::size_t>(f)] = now(f);
        now(f) = was(f);
    }
    const auto keep = [&](int field, int count) {
        for (int f = field; f < field + count; ++f) now(f) = found[static_cast<std::size_t>(f)];
    };
    for (int j = 0; j < contact::kMaxPoints; ++j) {
        const int point = contact::kPoints + j * contact::kPointFields;
        keep(point + contact::kImpulse, 1);
        const float impulse = now(point + contact::kImpulse);
        const float weight = 2 * gravityStep * was(point + contact::kMass);
        const float own = impulse > weight ? weight / impulse : 1;
        now(point + contact::kLoad) = own * was(point + contact::kLoad) + (1 - own) * impulse;
    }
    keep(contact::kFrictionImpulse, 3);
    keep(contact::kTwistImpulse, 1);
    keep(contact::kRollImpulse, 3);
}

/// A body and its contacts, while these look for the loads of its push.
class PushedBody {
public:
    PushedBody(const Iteration& v, std::uint32_t body, const SolverContext& own)
        : v_(v), context_(own), body_(v.bodies[body].state), bundle_(v.graph.lanes()) {
        context_.normals = context_.friction = true;
        const Contacts& contacts = v.tables.contacts;
        for (std::uint32_t key = v.bodies[body].firstContact; key != kNone; key = contacts.next(key)) {
            const ContactRecord& record = contacts[key >> 1];
            const std::uint32_t other = (key & 1) != 0 ? record.bodyA : record.bodyB;
            Manifolds::forEach(record, [&](std::uint32_t m) {
                if (isIterated(v, m) && count_ < kMostContacts)
                    take(v.graph.lane(v.manifolds[m].place), v.bodies[other].state);
            });
        }
    }

    /// Velocities are as before.
    void findLoads() {
        BodyState& state = v_.bodies.states[body_];
        const BodyState begun = state;
        visitAll(v_.kernels.warmStartContacts);
        for (int sweep = 0; sweep < kBearingSweeps; ++sweep) {
            const BodyState last = state;
            visitAll(v_.kernels.relaxContacts);
            if (length(state.v - last.v) + reach_ * length(state.w - last.w) <= kBorne * context_.gravityStep) break;
        }
        state = begun;
        // In reverse: of bodies that it touches twice the first has what they were.
        for (std::size_t i = count_; i-- > 0;) {
            takeLoads(contacts_[i], stride(), context_.gravityStep);
            BodyState& other = v_.bodies.states[contacts_[i].other];
            if (other.invMass > 0) other = contacts_[i].otherBefore;
        }
    }

private:
    std::size_t stride() const { return static_cast<std::size_t>(v_.graph.lanes()); }

    void take(float* lane, std::uint32_t other) {
        PushedContact& pushed = contacts_[count_++];
        pushed.lane = lane;
        pushed.other = other;
        for (std::size_t f = 0; f < contact::kFields; ++f) pushed.before[f] = lane[f * stride()];
        reach_ = std::max(reach_, lane[contact::kSize * stride()]);
        // It goes on as it did but for what it gets here, since nobody knows yet what holds it.
        BodyState& state = v_.bodies.states[other];
        pushed.otherBefore = state;
        if (state.invMass > 0) state.v = v_.bodies.histories[other].velocityBefore;
    }

    template <class Kernel>
    void visitAll(Kernel kernel) {
        for (std::size_t i = 0; i < count_; ++i)
            bundle_.visit(contacts_[i].lane, [&](float* fields, int begin, int end) {
                kernel(fields, begin, end, v_.bodies.arrays(), context_);
            });
    }

    const Iteration& v_;
    SolverContext context_;
    std::uint32_t body_;
    SingleBundle bundle_;
    std::array<PushedContact, kMostContacts> contacts_;
    std::size_t count_ = 0;
    float reach_ = 0;  ///< m
};

}  // namespace

static bool hasIteratedContact(const Iteration& v, std::uint32_t body) {
    const Contacts& contacts = v.tables.contacts;
    bool has = false;
    for (std::uint32_t key = v.bodies[body].firstContact; key != kNone && !has; key = contacts.next(key))
        Manifolds::forEach(contacts[key >> 1], [&](std::uint32_t m) { has |= isIterated(v, m); });
    return has;
}

void Iteration::bearPush(std::uint32_t body, const SolverContext& own) const {
    // Jointed bodies are held by other impulses too, and what is solved directly finds its loads so.
    if (bodies[body].firstJoint != kNone || bodies.isDirect(body) || !hasIteratedContact(*this, body)) return;
    PushedBody(*this, body, own).findLoads();
}

}  // namespace ragtop
