// The Hessian M + h γ Σ λ K_g + Jᵀ W J of an island's equations.

#include "direct/equations.h"

namespace ragtop::direct {

namespace {

/// A general 3×3 matrix by rows.
struct DMat3 {
    double at[9] = {};
};

/// S in the contact's basis, over R, in world axes.
void inWorld(const SystemContact& c, const double slope[6], double scale, double g[6]) {
    const DVec3 sn = slope[0] * c.normal + slope[1] * c.tangent1 + slope[2] * c.tangent2;
    const DVec3 s1 = slope[1] * c.normal + slope[3] * c.tangent1 + slope[4] * c.tangent2;
    const DVec3 s2 = slope[2] * c.normal + slope[4] * c.tangent1 + slope[5] * c.tangent2;
    const DVec3 &n = c.normal, &t = c.tangent1, &q = c.tangent2;
    g[0] = scale * (sn.x * n.x + s1.x * t.x + s2.x * q.x);
    g[1] = scale * (sn.x * n.y + s1.x * t.y + s2.x * q.y);
    g[2] = scale * (sn.x * n.z + s1.x * t.z + s2.x * q.z);
    g[3] = scale * (sn.y * n.y + s1.y * t.y + s2.y * q.y);
    g[4] = scale * (sn.y * n.z + s1.y * t.z + s2.y * q.z);
    g[5] = scale * (sn.z * n.z + s1.z * t.z + s2.z * q.z);
}

/// G [r]ₓ
DMat3 timesCross(const double g[6], const DVec3& r) {
    const double rows[3][3] = {{g[0], g[1], g[2]}, {g[1], g[3], g[4]}, {g[2], g[4], g[5]}};
    DMat3 p;
    for (int i = 0; i < 3; ++i) {
        p.at[3 * i] = rows[i][1] * r.z - rows[i][2] * r.y;
        p.at[3 * i + 1] = rows[i][2] * r.x - rows[i][0] * r.z;
        p.at[3 * i + 2] = rows[i][0] * r.y - rows[i][1] * r.x;
    }
    return p;
}

/// sum ← sum + [r]ₓ P
void addCrossTimes(DMat3& sum, const DVec3& r, const DMat3& p) {
    for (int j = 0; j < 3; ++j) {
        sum.at[j] += r.y * p.at[6 + j] - r.z * p.at[3 + j];
        sum.at[3 + j] += r.z * p.at[j] - r.x * p.at[6 + j];
        sum.at[6 + j] += r.x * p.at[3 + j] - r.y * p.at[j];
    }
}
void addTo(DMat3& sum, const DMat3& p) {
    for (int i = 0; i < 9; ++i) sum.at[i] += p.at[i];
}

/// What a manifold's points sum up to.
struct ContactSums {
    double g[6] = {0, 0, 0, 0, 0, 0};  ///< Σ G
    DMat3 pA, pB;                      ///< Σ G [rA]ₓ, Σ G [rB]ₓ
    DMat3 aa, bb, ba;                  ///< Σ [rA]ₓ G [rA]ₓ, and so on
};

/// [[G, −P], [−Pᵀ, −S]] added to the lower triangle of a block.
void addDiagonal(Block6& block, const double g[6], const DMat3& p, const DMat3& s) {
    double* at = block.at;
    at[0] += g[0], at[1] += g[1], at[2] += g[2], at[7] += g[3], at[8] += g[4], at[14] += g[5];
    unrolled<0, 3>([&](auto c) {
        unrolled<0, 3>([&](auto r) { at[6 * c + r + 3] -= p.at[3 * c + r]; });
        unrolled<c, 3>([&](auto r) { at[6 * (c + 3) + r + 3] -= s.at[3 * r + c]; });
    });
}

/// [[−G, P], [Qᵀ, S]] added to a block, or its transpose.
template <bool kTransposed>
void addCoupling(Block6& block, const double g[6], const DMat3& p, const DMat3& q, const DMat3& s) {
    const double full[9] = {g[0], g[1], g[2], g[1], g[3], g[4], g[2], g[4], g[5]};
    const auto add = [&](auto row, auto column, double x) {
        block.at[kTransposed ? 6 * row + column : 6 * column + row] += x;
    };
    unrolled<0, 3>([&](auto c) {
        unrolled<0, 3>([&](auto r) {
            add(std::integral_constant<int, r>{}, c, -full[3 * r + c]);
            add(r, std::integral_constant<int, c + 3>{}, p.at[3 * r + c]);
            add(std::integral_constant<int, r + 3>{}, c, q.at[3 * c + r]);
            add(std::integral_constant<int, r + 3>{}, std::integral_constant<int, c + 3>{}, s.at[3 * r + c]);
        });
    });
}
void addCoupling(Block6& block, const double g[6], const DMat3& p, const DMat3& q, const DMat3& s, bool transposed) {
    transposed ? addCoupling<true>(block, g, p, q, s) : addCoupling<false>(block, g, p, q, s);
}

/// Σ w l lᵀ, Σ w l tᵀ and Σ w t tᵀ of a pair's rows.
struct RowSums {
    DSym3 along, about;
    DMat3 both;
    bool hasBoth = false;

    void add(const SystemRow& row, double w) {
        switch (row.shape) {
            case RowShape::turning:
                about = about + outer(w, row.turn);
                return;
            case RowShape::alongX:
                along.xx += w;
                return;
            case RowShape::alongY:
                along.yy += w;
                return;
            case RowShape::alongZ:
                along.zz += w;
                return;
            case RowShape::whole:
                break;
        }
        along = along + outer(w, row.linear);
        if (row.turn.x == 0 && row.turn.y == 0 && row.turn.z == 0) return;
        about = about + outer(w, row.turn);
        hasBoth = true;
        const DVec3 &l = row.linear, t = w * row.turn;
        const double rows[3] = {l.x, l.y, l.z};
        for (int i = 0; i < 3; ++i)
            both.at[3 * i] += rows[i] * t.x, both.at[3 * i + 1] += rows[i] * t.y, both.at[3 * i + 2] += rows[i] * t.z;
    }
};

/// −Σ w (r × l + t)(s × l + t)ᵀ, with p = Σ w (l lᵀ [s]ₓ − l tᵀ).
DMat3 turns(const RowSums& sums, const DVec3& r, const DVec3& s, const DMat3& p) {
    const DSym3& t = sums.about;
    DMat3 m{{-t.xx, -t.xy, -t.xz, -t.xy, -t.yy, -t.yz, -t.xz, -t.yz, -t.zz}};
    addCrossTimes(m, r, p);
    if (!sums.hasBoth) return m;
    DMat3 crossed;  // [s]ₓ Σ w l tᵀ
    addCrossTimes(crossed, s, sums.both);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m.at[3 * i + j] -= crossed.at[3 * j + i];
    return m;
}

/// Takes out movements that are locked.
void clearLocked(Block6& block, std::uint32_t rows, std::uint32_t columns) {
    for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r)
            if (((rows >> r) & 1) != 0 || ((columns >> c) & 1) != 0) block.at[6 * c + r] = 0;
}

}  // namespace

void Equations::addMasses() {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const SystemBody& body = bodies[i];
        double* at = hessian.diagonal(static_cast<std::uint32_t>(i)).at;
        for (int k = 0; k < 3; ++k) at[7 * k] += body.mass[k];
        const DSym3 m = body.inertia + body.stiffness;
        at[21] += m.xx, at[22] += m.xy, at[23] += m.xz;
        at[27] += m.xy, at[28] += m.yy, at[29] += m.yz;
        at[33] += m.xz, at[34] += m.yz, at[35] += m.zz;
    }
}

void Equations::addContact(const SystemContact& c) {
    ContactSums sums;
    bool any = false;
    for (std::uint32_t j = 0; j < c.count; ++j) {
        SystemPoint& p = points[c.first + j];
        p.factored = p.region;
        if (p.region == ConeRegion::apart) continue;
        any = true;
        double slope[6], g[6];
        projectionSlope(p.asked, c.friction, p.region, slope);
        inWorld(c, slope, 1 / p.resistance, g);
        for (int k = 0; k < 6; ++k) sums.g[k] += g[k];
        const DMat3 pA = timesCross(g, p.armA), pB = timesCross(g, p.armB);
        addTo(sums.pA, pA);
        addTo(sums.pB, pB);
        addCrossTimes(sums.aa, p.armA, pA);
        addCrossTimes(sums.bb, p.armB, pB);
        addCrossTimes(sums.ba, p.armB, pA);
    }
    if (!any) return;
    const auto a = static_cast<std::uint32_t>(c.a), b = static_cast<std::uint32_t>(c.b);
    if (c.a != kFixed) addDiagonal(hessian.diagonal(a), sums.g, sums.pA, sums.aa);
    if (c.b != kFixed) addDiagonal(hessian.diagonal(b), sums.g, sums.pB, sums.bb);
    if (c.a != kFixed && c.b != kFixed)
        addCoupling(hessian.coupling(c.block), sums.g, sums.pA, sums.pB, sums.ba, !hessian.rowsAreOf(b, a));
}

/// As of a contact, with t beside l:  Σ w [l; rB × l + t] [l; rA × l + t]ᵀ.
void Equations::addPair(const SystemPair& pair) {
    RowSums sums;
    for (std::uint32_t i = pair.first; i < pair.first + pair.count; ++i) {
        SystemRow& row = rows[i];
        row.factored = row.side == Side::within;
        if (row.factored) sums.add(row, 1 / row.resistance);
    }
    const double g[6] = {sums.along.xx, sums.along.xy, sums.along.xz, sums.along.yy, sums.along.yz, sums.along.zz};
    DMat3 pA = timesCross(g, pair.armA), pB = timesCross(g, pair.armB);
    if (sums.hasBoth)
        for (int i = 0; i < 9; ++i) pA.at[i] -= sums.both.at[i], pB.at[i] -= sums.both.at[i];
    const auto locksOf = [&](std::int32_t body) {
        return body == kFixed ? 0u : bodies[static_cast<std::size_t>(body)].locks;
    };
    const std::uint32_t locksA = locksOf(pair.a), locksB = locksOf(pair.b);
    // Of what is locked a block of its own takes the movements out.
    const auto add = [&](Block6& to, std::uint32_t ofRows, std::uint32_t ofColumns, auto&& addTo) {
        if ((ofRows | ofColumns) == 0) return addTo(to);
        Block6 own{};
        addTo(own);
        clearLocked(own, ofRows, ofColumns);
        for (int i = 0; i < 36; ++i) to.at[i] += own.at[i];
    };
    const auto a = static_cast<std::uint32_t>(pair.a), b = static_cast<std::uint32_t>(pair.b);
    if (pair.a != kFixed)
        add(hessian.diagonal(a), locksA, locksA,
            [&](Block6& to) { addDiagonal(to, g, pA, turns(sums, pair.armA, pair.armA, pA)); });
    if (pair.b != kFixed)
        add(hessian.diagonal(b), locksB, locksB,
            [&](Block6& to) { addDiagonal(to, g, pB, turns(sums, pair.armB, pair.armB, pB)); });
    if (pair.a == kFixed || pair.b == kFixed) return;
    const bool ofB = hessian.rowsAreOf(b, a);
    add(hessian.coupling(pair.block), ofB ? locksB : locksA, ofB ? locksA : locksB,
        [&](Block6& to) { addCoupling(to, g, pA, pB, turns(sums, pair.armB, pair.armA, pA), !ofB); });
}

bool Equations::factorize() {
    hessian.setZero();
    addMasses();
    for (const SystemContact& c : contacts) addContact(c);
    for (const SystemPair& pair : pairs) addPair(pair);
    return hessian.factorize();
}

}  // namespace ragtop::direct
