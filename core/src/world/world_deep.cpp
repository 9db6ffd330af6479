// Further relaxing sweeps over contacts that are deep. Bodies are pushed out of an overlap with speeds that have
// nothing to do with the motion of the scene. Where such contacts hang together the speeds add up, and one sweep takes
// back a part of them only: what remained would throw the bodies apart.

#include <cstring>

#include "constraints/contact_layout.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

constexpr int kSweeps = 3;  ///< beside the one over everything

/// What relaxing sweeps read and write; all else of a contact stays as it is in the step, or is for the sweep over
/// everything to tell: the place where it sticks, and the sums of impulses for events.
struct Strip {
    std::size_t field, count;
};
constexpr std::size_t impulseOf(std::size_t point) {
    return contact::kPoints + point * contact::kPointFields + contact::kImpulse;
}
constexpr Strip kRelaxed[] = {{contact::kFrictionImpulse, 3},
                              {contact::kTwistImpulse, 1},
                              {contact::kRollImpulse, 3},
                              {contact::kSliding, 1},
                              {impulseOf(0), 1},
                              {impulseOf(1), 1},
                              {impulseOf(2), 1},
                              {impulseOf(3), 1}};
static_assert(contact::kMaxPoints == 4);

void copyFields(const float* from, float* to, std::size_t stride, const Strip& fields) {
    for (std::size_t f = fields.field; f < fields.field + fields.count; ++f) to[f * stride] = from[f * stride];
}

/// What the contact in a lane has its bundle has.
void shareTraits(float* bundles, std::size_t lane, std::size_t lanes) {
    const std::size_t bundle = lane / (contact::kFields * lanes) * contact::kFields * lanes;
    std::uint32_t own, all;
    std::memcpy(&own, bundles + lane + contact::kTraits * lanes, sizeof own);
    float* const first = bundles + bundle + contact::kTraits * lanes;
    std::memcpy(&all, first, sizeof all);
    all |= own;
    std::memcpy(first, &all, sizeof all);
}

}  // namespace

/// What falls all at once is deep for a moment, with copies of half of all contacts: large memory of which little is
/// used for long is given back.
void WorldImpl::giveBackDeep() {
    constexpr int kLong = 16;
    const bool used = 4 * deepContacts.bundles.size() > deepContacts.bundles.capacity();
    deepContacts.spareSteps = used || !deepContacts.bundles.isLarge() ? 0 : deepContacts.spareSteps + 1;
    if (deepContacts.spareSteps < kLong) return;
    deepContacts.bundles.release();
    deepContacts.spareSteps = 0;
}

template <class Visit>
void WorldImpl::forEachDeep(Visit&& visit) {
    runner.parallelFor(static_cast<int>(deepContacts.all.size()), 64, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) visit(deepContacts.all[static_cast<std::size_t>(i)]);
    });
}

/// Copies the contacts of this step that prepare has found to be deep to bundles of their own; those of the overflow keep
/// one each.
void WorldImpl::collectDeep(bool any) {
    giveBackDeep();
    deepContacts.all.clear();
    deepContacts.starts.clear();
    deepContacts.bundles.clear();
    if (!any) return;
    const auto lanes = static_cast<std::size_t>(graph.lanes());
    constexpr auto kFields = static_cast<std::size_t>(contact::kFields);
    std::size_t bundles = 0;
    for (int c = 0; c <= ConstraintGraph::kOverflow; ++c) {
        deepContacts.starts.push(static_cast<std::uint32_t>(bundles));
        const std::size_t inBundle = c == ConstraintGraph::kOverflow ? 1 : lanes;
        const std::uint8_t* deep = deepContacts.isDeep.data() + deepContacts.laneStarts[static_cast<std::size_t>(c)];
        std::size_t used = 0;
        const auto count = static_cast<std::uint32_t>(graph.color(c).manifolds.size());
        for (std::uint32_t slot = 0; slot < count; ++slot) {
            if (deep[slot / inBundle * lanes + slot % inBundle] == 0) continue;
            const std::size_t bundle = bundles + used / inBundle;
            deepContacts.all.push({{static_cast<std::uint32_t>(c), slot}, bundle * kFields * lanes + used % inBundle});
            ++used;
        }
        bundles += (used + inBundle - 1) / inBundle;
    }
    deepContacts.starts.push(static_cast<std::uint32_t>(bundles));
    if (const std::size_t floats = bundles * kFields * lanes; floats > deepContacts.bundles.capacity())
        deepContacts.bundles.reserve(floats + floats / 4);
    deepContacts.bundles.resize(bundles * kFields * lanes, 0.0f);
    forEachDeep([&](const DeepContact& contact) {
        copyFields(graph.lane(contact.from), deepContacts.bundles.data() + contact.to, lanes, {0, kFields});
    });
    for (const DeepContact& deep : deepContacts.all) shareTraits(deepContacts.bundles.data(), deep.to, lanes);
}

/// In the order of the other sweeps.
void WorldImpl::relaxDeep() {
    if (deepContacts.all.empty()) return;
    const BodyArrays arrays = bodyArrays();
    SolverContext rows = context;
    rows.normals = rows.friction = true;
    const auto relax = [&](int begin, int end) {
        kernels->relaxContacts(deepContacts.bundles.data(), begin, end, arrays, rows);
    };
    const auto startOf = [&](int color) {
        return static_cast<int>(deepContacts.starts[static_cast<std::size_t>(color)]);
    };
    const auto lanes = static_cast<std::size_t>(graph.lanes());
    forEachDeep([&](const DeepContact& contact) {
        for (const Strip& fields : kRelaxed)
            copyFields(graph.lane(contact.from), deepContacts.bundles.data() + contact.to, lanes, fields);
    });
    const int grain = 32 / graph.lanes();
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        const int pastOverflow = startOf(ConstraintGraph::kOverflow + 1);
        for (int i = startOf(ConstraintGraph::kOverflow); i < pastOverflow; ++i) relax(i, i + 1);
        for (int c = 0; c < ConstraintGraph::kColors; ++c) {
            const int first = startOf(c);
            runner.parallelFor(startOf(c + 1) - first, grain,
                               [&](int begin, int end, int) { relax(first + begin, first + end); });
        }
    }
    forEachDeep([&](const DeepContact& contact) {
        for (const Strip& fields : kRelaxed)
            copyFields(deepContacts.bundles.data() + contact.to, graph.lane(contact.from), lanes, fields);
    });
}

}  // namespace ragtop
