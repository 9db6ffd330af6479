#include "solve/contact_places.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "constraints/contact_layout.h"
#include "solve/kernel_table.h"

namespace ragtop {
namespace {

struct alignas(64) Place {
    DVec3 center;
    double travel = 0;
    Quat rotation;
    float others[4] = {};
};

/// Contacts of turned bodies far from the origin, one in three of them with the static body.
struct Placing {
    static constexpr int kCount = 21;
    std::vector<Place> places{1 + 2 * kCount};
    std::vector<ManifoldAnchors> manifolds{kCount};
    std::vector<std::uint32_t> order;

    Placing() {
        for (std::size_t i = 0; i < places.size(); ++i) {
            const auto s = static_cast<float>(i);
            places[i].center = {1e6 + 0.37 * static_cast<double>(i), 2.0 / (1.0 + static_cast<double>(i)), -3e5};
            places[i].rotation = normalized(Quat{0.1f * s, 1 - 0.2f * s, 0.3f, 1});
        }
        for (int i = 0; i < kCount; ++i) {
            ManifoldAnchors& manifold = manifolds[static_cast<std::size_t>(i)];
            const auto s = static_cast<float>(i);
            manifold.normal = normalized(Vec3{s - 3, 2, 0.5f * s});
            manifold.pointCount = i % 5;
            for (int j = 0; j < manifold.pointCount; ++j) {
                const auto t = static_cast<float>(j);
                manifold.anchorA[j] = {0.1f * t, 0.3f - 0.01f * s, t - 1};
                manifold.anchorB[j] = {0.2f, -0.3f + 0.02f * s, t - 1.1f};
                manifold.separation[j] = 0.001f * (t - 2);
            }
            order.push_back(static_cast<std::uint32_t>(kCount - 1 - i));
        }
    }
    bool isStatic(int i) const { return i % 3 == 0; }

    /// Fields of all contacts, contact by contact; zero for points that a contact does not have. With so many lanes, or
    /// as many as there are here; in full bundles, or in one for each.
    std::vector<float> run(int mostLanes, bool alone = false) const {
        const KernelTable& kernels = selectKernels(mostLanes);
        const int lanes = kernels.lanes, perBundle = alone ? 1 : lanes;
        const int bundles = (kCount + perBundle - 1) / perBundle;
        std::vector<float> memory(static_cast<std::size_t>(bundles * contact::kFields * lanes) + 16);
        void* aligned = memory.data();
        std::size_t space = memory.size() * sizeof(float);
        auto* first = static_cast<float*>(std::align(64, space - 64, aligned, space));
        const auto at = [&](int i, int field) {
            return first + (i / perBundle * contact::kFields + field) * lanes + i % perBundle;
        };
        for (int i = 0; i < kCount; ++i) {
            const auto a = static_cast<std::uint32_t>(1 + 2 * i), b = a + 1, state = isStatic(i) ? 0 : a;
            std::memcpy(at(i, contact::kBodyA), &state, sizeof state);
            std::memcpy(at(i, contact::kRecordA), &a, sizeof a);
            std::memcpy(at(i, contact::kRecordB), &b, sizeof b);
        }
        const LaneManifolds list{order.data(), kCount, perBundle};
        constexpr unsigned kPageBits = 3;
        std::vector<const void*> pages;
        for (std::size_t page = 0; page << kPageBits < manifolds.size(); ++page)
            pages.push_back(&manifolds[page << kPageBits]);
        kernels.placeContacts(first, 0, bundles, list,
                              {&places[0].center, &places[0].rotation, sizeof(Place), pages.data(), kPageBits,
                               sizeof(ManifoldAnchors)});
        std::vector<float> fields;
        for (int i = 0; i < kCount; ++i)
            for (int f = 0; f < contact::kFields; ++f) {
                const int end = contact::kPoints + contact::kMaxPoints * contact::kPointFields;
                const int points = manifolds[order[static_cast<std::size_t>(i)]].pointCount;
                const bool absent = f >= contact::kPoints + points * contact::kPointFields && f < end;
                fields.push_back(absent ? 0.0f : *at(i, f));
            }
        return fields;
    }
};

// n = RA n_A and C = C₀ + n · (pB − pA), whose point is half way between the anchors: from the centre of A, or that of B
// where A does not move.
TEST(ContactPlaces, PointsGoWhereTheirBodiesTookThem) {
    const Placing placing;
    const std::vector<float> fields = placing.run(8);
    for (int i = 0; i < Placing::kCount; ++i) {
        const auto at = [&](int field) { return fields[static_cast<std::size_t>(i * contact::kFields + field)]; };
        const auto vector = [&](int field) { return Vec3{at(field), at(field + 1), at(field + 2)}; };
        const Place &a = placing.places[static_cast<std::size_t>(1 + 2 * i)],
                    &b = placing.places[static_cast<std::size_t>(2 + 2 * i)];
        const ManifoldAnchors& manifold = placing.manifolds[placing.order[static_cast<std::size_t>(i)]];
        const Vec3 apart = relative(b.center, a.center);
        const Vec3 normal = rotate(a.rotation, manifold.normal);
        EXPECT_EQ(vector(contact::kNormal), normal);
        EXPECT_EQ(vector(contact::kOffset), placing.isStatic(i) ? Vec3{} : apart);
        for (int j = 0; j < manifold.pointCount; ++j) {
            const int point = contact::kPoints + j * contact::kPointFields;
            const Vec3 onA = rotate(a.rotation, manifold.anchorA[j]);
            const Vec3 onB = rotate(b.rotation, manifold.anchorB[j]) + apart;
            const Vec3 middle = 0.5f * (onA + onB) - (placing.isStatic(i) ? apart : Vec3{});
            EXPECT_LE(length(vector(point + contact::kAnchor) - middle), 1e-6f);
            EXPECT_NEAR(at(point + contact::kSeparation), manifold.separation[j] + dot(normal, onB - onA), 1e-6f);
        }
    }
}

TEST(ContactPlaces, LanesAndBundlesOfOneContactGiveTheSameBits) {
    const Placing placing;
    const std::vector<float> fields = placing.run(4);
    EXPECT_EQ(fields, placing.run(8));
    EXPECT_EQ(fields, placing.run(16));
    EXPECT_EQ(fields, placing.run(8, true));
}

}  // namespace
}  // namespace ragtop
