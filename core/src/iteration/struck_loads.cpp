// What is struck bears far more for a moment than it weighs, and passes that begin with such loads would throw it back:
// where a heavy body lands on a light one, a pass changes the load by what stops the light one alone, so that load and
// speed swing about each other like a spring and its mass.
//
// With loads s λ̂ bodies have ℓ(s) = ½ s² λ̂ᵀ A λ̂ + s λ̂ᵀ (u_free − û) more energy than without, A = J M⁻¹ Jᵀ, û what
// moving surfaces ask for. Loads that bodies rest on take energy, ℓ(1) < 0, as u_free is a fall; where ℓ(1) > 0 they
// are shrunk to what takes most of it, all of them by the same share, so that they still hold each other.

#include <algorithm>
#include <array>
#include <cstring>

#include "constraints/contact_layout.h"
#include "constraints/lane_view.h"
#include "iteration/iteration.h"

namespace ragtop {

namespace {

// By trial: with 8 bodies a stack of as many throws back what falls on it, with 24 box_pile takes a tenth longer.
constexpr std::size_t kMostStruckBodies = 12;    ///< that one impact goes through
constexpr std::size_t kMostStruckContacts = 24;  ///< the same
/// Times the load of the contact that is struck, or a share of it: loads beyond belong to something else. By trial.
constexpr float kAlikeLoad = 8;

constexpr int kOtherLoads[] = {contact::kFrictionImpulse, contact::kFrictionImpulse + 1, contact::kFrictionImpulse + 2,
                               contact::kTwistImpulse,    contact::kRollImpulse,         contact::kRollImpulse + 1,
                               contact::kRollImpulse + 2};

/// The bodies that the load of a struck contact goes through, and their contacts that bear some of it.
class StruckGroup {
public:
    StruckGroup(const Iteration& v, const SolverContext& own) : v_(v), context_(own), now_(own.substep + 1) {}

    /// Do the bodies of a contact leave each other after the warm start, and faster than they met without?
    bool isThrown(std::uint32_t manifold) const {
        const float* lane = v_.graph.lane(v_.manifolds[manifold].place);
        if (!(laneOf(manifold).at(contact::kThrown) > 0)) return false;
        const std::uint32_t a = recordAt(lane, contact::kRecordA), b = recordAt(lane, contact::kRecordB);
        return lengthSquared(v_.bodies.states[b].v - v_.bodies.states[a].v) >
               lengthSquared(freeVelocity(b) - freeVelocity(a));
    }

    /// False where joints or a direct solve have part in it, which have guards of their own.
    bool gather(std::uint32_t manifold) {
        bodyCount_ = contactCount_ = 0;
        const float* lane = v_.graph.lane(v_.manifolds[manifold].place);
        load_ = loadOf(manifold);
        for (const int side : {contact::kRecordA, contact::kRecordB}) reach(recordAt(lane, side));
        for (std::size_t i = 0; i < bodyCount_; ++i) {
            const std::uint32_t body = bodies_[i].body;
            if (v_.bodies[body].firstJoint != kNone || v_.bodies.isDirect(body) || v_.bodies.states[body].locks != 0)
                return false;
            const Contacts& contacts = v_.tables.contacts;
            for (std::uint32_t key = v_.bodies[body].firstContact; key != kNone; key = contacts.next(key))
                if (const ContactRecord& contact = contacts[key >> 1]; contact.hasPoints)
                    Manifolds::forEach(contact, [&](std::uint32_t m) { take(m, contact, body); });
        }
        return contactCount_ > 0;
    }

    /// Was it in a group of this substep already?
    bool isTreated(std::uint32_t manifold) const {
        const float* lane = v_.graph.lane(v_.manifolds[manifold].place);
        return treatedIn(recordAt(lane, contact::kRecordA)) == now_ ||
               treatedIn(recordAt(lane, contact::kRecordB)) == now_;
    }

    /// No load is shrunk that takes energy as it is.
    void shrink() {
        double along = 0, square = 0;
        for (std::size_t i = 0; i < contactCount_; ++i) along += workOfSurfaces(contacts_[i]);
        for (std::size_t i = 0; i < contactCount_; ++i) addLoad(contacts_[i]);
        for (std::size_t i = 0; i < bodyCount_; ++i) addEnergies(bodies_[i], along, square);
        const bool throws = square > 0 && along + 0.5 * square > 0;
        const float share = throws ? static_cast<float>(std::clamp(-along / square, 0.0, 1.0)) : 1.0f;
        if (throws) scaleLoads(share);
        for (std::size_t i = 0; throws && i < bodyCount_; ++i) {
            BodyState& state = v_.bodies.states[bodies_[i].body];
            state.v = state.v - (1 - share) * bodies_[i].change;
            state.w = state.w - (1 - share) * bodies_[i].turn;
        }
    }

    /// Not looked at until it is struck anew.
    void leave(std::uint32_t manifold) const { laneOf(manifold).at(contact::kStruck) = 0; }

private:
    struct GroupBody {
        std::uint32_t body = 0;
        Vec3 change, turn;  ///< m/s, rad/s, that loads of the group give
    };

    std::uint32_t recordAt(const float* lane, int field) const {
        std::uint32_t record;
        std::memcpy(&record, &lane[static_cast<std::size_t>(field) * static_cast<std::size_t>(v_.graph.lanes())],
                    sizeof record);
        return record;
    }

    LaneView laneOf(std::uint32_t manifold) const {
        return {v_.graph.lane(v_.manifolds[manifold].place), v_.graph.lanes()};
    }

    /// m/s, without loads.
    Vec3 freeVelocity(std::uint32_t body) const {
        return v_.bodies.histories[body].velocityBefore + context_.h * v_.bodies.dynamics[body].acceleration;
    }

    /// N s
    float loadOf(std::uint32_t manifold) const {
        LaneView lane = laneOf(manifold);
        float sum = 0;
        for (int j = 0; j < v_.manifolds[manifold].pointCount; ++j) sum += lane.at(j, contact::kImpulse);
        return sum;
    }

    int& treatedIn(std::uint32_t body) const { return v_.regions.struckIn[body]; }

    bool holds(std::uint32_t body) const {
        for (std::size_t i = 0; i < bodyCount_; ++i)
            if (bodies_[i].body == body) return true;
        return false;
    }

    bool reach(std::uint32_t body) {
        if (!v_.bodies.moves(body) || holds(body)) return true;
        if (bodyCount_ == kMostStruckBodies) return false;
        bodies_[bodyCount_++] = {body, {}, {}};
        treatedIn(body) = now_;
        return true;
    }

    /// A contact of a body of the group that bears about as much as the one that is struck, and its other body.
    void take(std::uint32_t manifold, const ContactRecord& contact, std::uint32_t body) {
        const GraphPlace place = v_.manifolds[manifold].place;
        if (place.color == kNone || !ConstraintGraph::isIterated(static_cast<int>(place.color))) return;
        const std::uint32_t other = contact.bodyA == body ? contact.bodyB : contact.bodyA;
        for (std::size_t i = 0; i < contactCount_; ++i)
            if (contacts_[i] == manifold) return;
        const float load = loadOf(manifold);
        if (contactCount_ == kMostStruckContacts || !(load > 0) || kAlikeLoad * load < load_ ||
            load > kAlikeLoad * load_ || !reach(other))
            return;
        contacts_[contactCount_++] = manifold;
    }

    void scaleLoads(float share) {
        for (std::size_t i = 0; i < contactCount_; ++i) {
            LaneView lane = laneOf(contacts_[i]);
            for (int j = 0; j < v_.manifolds[contacts_[i]].pointCount; ++j) lane.at(j, contact::kImpulse) *= share;
            for (const int field : kOtherLoads) lane.at(field) *= share;
        }
    }

    /// J, of a load against what no impulse moves and surfaces that run: λ̂ᵀ (u_free − û) without the bodies' part.
    double workOfSurfaces(std::uint32_t manifold) const {
        LaneView lane = laneOf(manifold);
        const float* fields = v_.graph.lane(v_.manifolds[manifold].place);
        const Vec3 friction = lane.vector(contact::kFrictionImpulse), normal = lane.vector(contact::kNormal);
        double work = static_cast<double>(dot(friction, lane.vector(contact::kSurface)));
        const auto add = [&](int record, int state, float sign) {
            if (v_.bodies.moves(recordAt(fields, record))) return;
            const BodyState& driven = v_.bodies.states[recordAt(fields, state)];
            const Vec3 offset = sign > 0 ? lane.vector(contact::kOffset) : Vec3{};
            const auto speedAt = [&](const Vec3& arm) { return driven.v + cross(driven.w, arm - offset); };
            Vec3 turning = lane.at(contact::kTwistImpulse) * normal + lane.vector(contact::kRollImpulse);
            double given =
                static_cast<double>(dot(friction, speedAt(lane.vector(contact::kCenter))) + dot(turning, driven.w));
            for (int j = 0; j < v_.manifolds[manifold].pointCount; ++j)
                given += static_cast<double>(
                    lane.at(j, contact::kImpulse) *
                    dot(normal, speedAt(lane.vector(contact::kPoints + j * contact::kPointFields))));
            work += static_cast<double>(sign) * given;
        };
        add(contact::kRecordA, contact::kBodyA, -1);
        add(contact::kRecordB, contact::kBodyB, 1);
        return work;
    }

    /// What the warm start has given for a contact.
    void addLoad(std::uint32_t manifold) {
        LaneView lane = laneOf(manifold);
        const float* fields = v_.graph.lane(v_.manifolds[manifold].place);
        const Vec3 normal = lane.vector(contact::kNormal), friction = lane.vector(contact::kFrictionImpulse);
        Vec3 moment;
        float total = 0;
        for (int j = 0; j < v_.manifolds[manifold].pointCount; ++j) {
            const float impulse = lane.at(j, contact::kImpulse);
            moment += impulse * lane.vector(contact::kPoints + j * contact::kPointFields);
            total += impulse;
        }
        const Vec3 linear = total * normal + friction;
        const Vec3 angular = cross(moment, normal) + cross(lane.vector(contact::kCenter), friction) +
                             lane.at(contact::kTwistImpulse) * normal + lane.vector(contact::kRollImpulse);
        give(recordAt(fields, contact::kRecordA), -1, linear, angular);
        give(recordAt(fields, contact::kRecordB), 1, linear, angular - cross(lane.vector(contact::kOffset), linear));
    }

    /// To a body of the group.
    void give(std::uint32_t body, float sign, const Vec3& linear, const Vec3& angular) {
        for (std::size_t i = 0; i < bodyCount_; ++i)
            if (bodies_[i].body == body) {
                bodies_[i].change += sign * v_.bodies.states[body].invMass * linear;
                bodies_[i].turn += sign * (v_.bodies.inertias[body] * angular);
            }
    }

    void addEnergies(const GroupBody& member, double& along, double& square) const {
        const BodyRecord& record = v_.bodies[member.body];
        const BodyState& state = v_.bodies.states[member.body];
        const Quat rotation = state.dq * record.rotation;
        const Vec3 free = state.v - member.change, freeTurn = inverseRotate(rotation, state.w - member.turn);
        const Vec3 turn = inverseRotate(rotation, member.turn), spin = scale(record.inertia, turn);
        along += static_cast<double>(record.mass * dot(free, member.change) + dot(freeTurn, spin));
        square += static_cast<double>(record.mass * dot(member.change, member.change) + dot(turn, spin));
    }

    const Iteration& v_;
    const SolverContext& context_;
    int now_;         ///< number of the substep, from 1
    float load_ = 0;  ///< N s, of the contact that is struck
    std::array<GroupBody, kMostStruckBodies> bodies_;
    std::size_t bodyCount_ = 0;
    std::array<std::uint32_t, kMostStruckContacts> contacts_;
    std::size_t contactCount_ = 0;
};

}  // namespace

/// Of contacts with bodies that no impulse moves.
static bool isStatic(int list) {
    const int color = ConstraintGraph::colorOf(list);
    return color >= ConstraintGraph::kFirstStaticColor && color < ConstraintGraph::kColors;
}

/// The region that a list is of, 0 of none.
static int regionOfList(int list) {
    return list < ConstraintGraph::kLists ? 0 : (list - ConstraintGraph::kLists) / ConstraintGraph::kRegionLists + 1;
}

/// In an order that does not depend on how contacts are dealt out to regions.
void Iteration::collectStruck(bool any) const {
    AlignedArray<std::uint32_t>& found = regions.struckFound;
    found.clear();
    const auto n = static_cast<std::size_t>(graph.lanes());
    const auto look = [&](int c) {
        const ConstraintGraph::Color& color = graph.color(c);
        const std::size_t lanes = ConstraintGraph::isSerial(c) ? 1 : n;
        for (std::size_t first = 0; first < color.manifolds.size(); first += lanes) {
            const float* bundle = color.bundles.data() + first / lanes * contact::kFields * n;
            for (std::size_t i = 0; i < lanes && first + i < color.manifolds.size(); ++i)
                if (bundle[contact::kStruck * n + i] > 0) found.push(color.manifolds[first + i]);
        }
    };
    // Between a body and what no impulse moves passes find the load at once.
    if (any)
        graph.forUsedLists([&](int c) {
            if (ConstraintGraph::isIterated(c) && !isStatic(c)) look(c);
        });
    std::sort(found.begin(), found.end());
    regions.struckIn.clear();
    if (!found.empty()) regions.struckIn.resize(bodies.size(), 0);
    regions.struck.fill(
        graph.regionCount(), found.size(), [&](std::size_t i) { return found[i]; },
        [&](std::size_t i) {
            return static_cast<std::size_t>(regionOfList(static_cast<int>(manifolds[found[i]].place.color)));
        });
}

void Iteration::markThrown(int region, const SolverContext& own) const {
    forEachBit(graph.iteratedLists(region), [&](int bit) {
        const int c = ConstraintGraph::firstList(region) + bit;
        if (isStatic(c)) return;
        float* bundles = graph.color(c).bundles.data();
        const auto mark = [&](int begin, int end) { kernels.markThrown(bundles, begin, end, bodies.arrays(), own); };
        if (region > 0) return mark(0, graph.bundleCount(c));
        runner.parallelFor(graph.bundleCount(c), 32, [&](int begin, int end, int) { mark(begin, end); });
    });
}

void Iteration::shrinkStruckLoads(int region, const SolverContext& own) const {
    const std::span<const std::uint32_t> struck = regions.struck.of(region);
    if (struck.empty()) return;
    markThrown(region, own);
    StruckGroup group(*this, own);
    for (const std::uint32_t manifold : struck) {
        if (group.isTreated(manifold) || !group.isThrown(manifold)) continue;
        if (group.gather(manifold))
            group.shrink();
        else
            group.leave(manifold);
    }
}

void Iteration::shrinkStruckLoads() const {
    shrinkStruckLoads(0, context);
    runner.parallelFor(graph.regionCount(), 1, [&](int begin, int end, int) {
        for (int r = begin + 1; r <= end; ++r) shrinkStruckLoads(r, context);
    });
}

}  // namespace ragtop
