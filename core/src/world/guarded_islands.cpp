#include "world/guarded_islands.h"

#include <algorithm>

#include "base/prefetch.h"
#include "constraints/contact_layout.h"
#include "world/energy_account.h"

namespace ragtop {

namespace {

/// m, by which surfaces lie deeper in each other than a load presses them.
float depthOf(const GuardView& view, const ContactRecord& contact) {
    if (!contact.isDeep) return 0;
    float depth = 0;
    for (const ManifoldRecord& manifold : view.manifolds.of(contact))
        for (int j = 0; j < manifold.pointCount; ++j) depth = std::max(depth, -manifold.separation[j]);
    return depth > contact::kDeep * contact.size ? depth : 0.0f;
}

/// m, by which bodies that are so deep in each other are moved apart in a step, at most: by rows, and from far within
/// by places (solve/wide_push.inl).
float wayApart(const GuardView& view, const ContactRecord& contact, float depth) {
    const float beyond = std::max(depth - contact::kInside * contact.size, 0.0f);
    return std::min(beyond, contact::kInsideMost * contact.size) +
           std::min(depth, view.context.pushSpeed(contact.size) * view.dt);
}

/// J, of a body that was lifted, as far as being moved apart by such a way does.
double liftOf(const GuardView& view, std::uint32_t index, float way) {
    const Vec3& pull = view.bodies.dynamics[index].acceleration;
    const float lifted = std::clamp(-dot(pull, view.bodies.states[index].dp), 0.0f, way * length(pull));
    return static_cast<double>(view.bodies[index].mass * lifted);
}

/// J, that an island may be given by what pushes its overlaps apart: in a step no more than brings it to the speed that
/// these push with, and without being paid for no more than that and to lift its bodies out of them.
double pushable(const GuardView& view, std::span<const std::uint32_t> island, double liftable) {
    double pushed = 0, owed = 0;
    for (const std::uint32_t b : island) {
        const double speed = static_cast<double>(view.context.pushSpeed(view.bodies[b].size));
        pushed += 0.5 * static_cast<double>(view.bodies[b].mass) * speed * speed;
        if (keepsLedger(view, b)) owed += static_cast<double>(view.guard.owed[b]);
    }
    return std::clamp(pushed + liftable - owed, 0.0, pushed);
}

/// Islands are walked through in no order of memory.
void prefetchBody(const GuardView& view, std::uint32_t body) {
    prefetch(&view.bodies[body].mass);
    prefetch(&view.bodies[body].firstContact);
}
void prefetchContact(const GuardView& view, std::uint32_t body) {
    if (const std::uint32_t key = view.bodies[body].firstContact; key != kNone) prefetch(&view.contacts[key >> 1]);
}

/// Sums up what the parts of an island have.
void addAccount(EnergyAccount& whole, const EnergyAccount& part) {
    whole.before += part.before;
    whole.work += part.work;
    whole.held += part.held;
    whole.excess += part.excess;
}

/// What is known of a group whose lowest body is reached; all of it hangs together.
template <class Reach>
void addGroup(const GuardView& view, std::size_t g, GuardedIsland& look, EnergyAccount& whole, Reach&& reach) {
    const EnergyGuard& guard = view.guard;
    addAccount(whole, isAccountKept(view, g) ? guard.accounts[g] : keepAccount(view, g));
    look.watched = std::min(look.watched, guard.watched[g]);
    look.stores |= guard.traits[g].stores;
    look.hangs |= guard.traits[g].hangs;
    look.isJoined |= !guard.jointsOf(g).empty();
    for (const std::uint32_t member : guard.membersOf(g)) reach(member);
}

/// What pushes a body of an island out of what it overlaps, and gives it energy by contacts.
template <class Reach>
void addTouches(const GuardView& view, std::uint32_t body, GuardedIsland& look, Reach&& reach) {
    float apart = 0, deepest = 0;
    forEachTouch(view, body, [&](const ContactRecord& contact, std::uint32_t other) {
        if (const float depth = depthOf(view, contact); depth > 0) {
            apart = std::max(apart, wayApart(view, contact, depth));
            deepest = std::max(deepest, depth);
        }
        look.driven += workOfContact(view, contact, body, other);
        reach(other);
    });
    if (!(apart > 0)) return;
    look.lifted += liftOf(view, body, apart);
    look.liftable += static_cast<double>(view.bodies[body].mass * deepest) *
                     static_cast<double>(length(view.bodies.dynamics[body].acceleration));
    look.apart = std::max(look.apart, apart);
}

}  // namespace

bool isAccountKept(const GuardView& view, std::size_t g) {
    const Multirate& multirate = view.directSet.multirate;
    return view.guard.watched[g] != Watching::none &&
           (multirate.independentCount == 0 ||
            (multirate.marks[view.guard.membersOf(g).front()] & Multirate::kIndependent) == 0);
}

const EnergyAccount& keepAccount(const GuardView& view, std::size_t g) {
    const std::span<const std::uint32_t> group = view.guard.membersOf(g);
    EnergyAccount& account = view.guard.accounts[g] = accountOf(view, group);
    account.share = view.guard.room[view.guard.parent[group.front()]];
    return account;
}

GuardedIsland& islandOf(const GuardView& view, std::uint32_t first) {
    EnergyGuard& guard = view.guard;
    if (guard.islandOf[first] != kNone) return guard.islands[guard.islandOf[first]];
    const auto number = static_cast<std::uint32_t>(guard.islands.size());
    GuardedIsland look;
    look.begin = static_cast<std::uint32_t>(guard.visited.size());
    look.firstDriver = static_cast<std::uint32_t>(guard.drivers.size());
    const auto reach = [&](std::uint32_t body) {
        if (!view.bodies.moves(body)) {
            look.hangs = true;
        } else if (view.bodies.isAwake(body) && guard.islandOf[body] == kNone) {
            guard.islandOf[body] = number;
            guard.visited.push(body);
            prefetchBody(view, body);
        }
    };
    reach(first);
    EnergyAccount whole;
    for (std::size_t i = look.begin; i < guard.visited.size(); ++i) {
        constexpr std::size_t kAhead = 3;  // bodies, whose records have come
        if (i + kAhead < guard.visited.size()) prefetchContact(view, guard.visited[i + kAhead]);
        const std::uint32_t body = guard.visited[i];
        if (isJoined(view, body)) {
            reach(guard.parent[body]);
            if (guard.parent[body] == body) addGroup(view, guard.groupOf[body], look, whole, reach);
            look.driven += addDrivers(view, body, guard.drivers);
        } else {
            addAccount(whole, accountOf(view, {&body, 1}));
        }
        addTouches(view, body, look, reach);
    }
    look.excess = whole.excess;
    look.lawful = lawfulOf(whole);
    look.lastDriver = static_cast<std::uint32_t>(guard.drivers.size());
    look.end = static_cast<std::uint32_t>(guard.visited.size());
    if (look.apart > 0) look.pushed = pushable(view, bodiesOf(guard, look), look.liftable);
    guard.islands.push(look);
    return guard.islands[number];
}

Lifts liftsOf(const GuardView& view, const GuardedIsland& look, std::span<const std::uint32_t> group) {
    Lifts lifts;
    if (!(look.apart > 0)) return lifts;
    float farthest = 0;
    for (const std::uint32_t body : group) {
        float apart = 0;
        forEachTouch(view, body, [&](const ContactRecord& contact, std::uint32_t) {
            if (const float depth = depthOf(view, contact); depth > 0)
                apart = std::max(apart, wayApart(view, contact, depth));
        });
        lifts.own += liftOf(view, body, apart);
        farthest = std::max(farthest, apart);
    }
    for (const std::uint32_t body : group) lifts.whole += liftOf(view, body, farthest);
    return lifts;
}

}  // namespace ragtop
