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

/// sign · [[G, −P], [−Qᵀ, −S]] added to a block; transposed on demand.
void addBlock(Block6& block, double sign, const double g[6], const DMat3& p, const DMat3& q, const DMat3& s,
              bool transposed) {
    const double full[9] = {g[0], g[1], g[2], g[1], g[3], g[4], g[2], g[4], g[5]};
    double* at = block.at;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            const double upperRight = -sign * p.at[3 * r + c], lowerLeft = -sign * q.at[3 * c + r];
            const double lowerRight = -sign * s.at[3 * r + c];
            at[6 * c + r] += sign * full[3 * r + c];
            if (!transposed) {
                at[6 * (c + 3) + r] += upperRight;
                at[6 * c + r + 3] += lowerLeft;
                at[6 * (c + 3) + r + 3] += lowerRight;
            } else {
                at[6 * r + c + 3] += upperRight;
                at[6 * (r + 3) + c] += lowerLeft;
                at[6 * (r + 3) + c + 3] += lowerRight;
            }
        }
}

/// w Jᵀ J
template <int... At>
void addSquares(Places<At...> places, BlockFactor& hessian, const SystemRow& row, double weight) {
    const auto a = static_cast<std::uint32_t>(row.a), b = static_cast<std::uint32_t>(row.b);
    if (row.a != kFixed) addSquare(places, hessian.diagonal(a), weight, row.ja);
    if (row.b != kFixed) addSquare(places, hessian.diagonal(b), weight, row.jb);
    if (row.a == kFixed || row.b == kFixed) return;
    if (hessian.rowsAreOf(b, a))
        addOuter(places, hessian.coupling(row.block), weight, row.jb, row.ja);
    else
        addOuter(places, hessian.coupling(row.block), weight, row.ja, row.jb);
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
    if (c.a != kFixed) addBlock(hessian.diagonal(a), 1, sums.g, sums.pA, sums.pA, sums.aa, false);
    if (c.b != kFixed) addBlock(hessian.diagonal(b), 1, sums.g, sums.pB, sums.pB, sums.bb, false);
    if (c.a != kFixed && c.b != kFixed)
        addBlock(hessian.coupling(c.block), -1, sums.g, sums.pA, sums.pB, sums.ba, !hessian.rowsAreOf(b, a));
}

void Equations::addRow(SystemRow& row) {
    row.factored = row.side == Side::within;
    if (!row.factored) return;
    const double weight = 1 / row.resistance;
    withPlaces(row.shape, [&](auto places) { addSquares(places, hessian, row, weight); });
}

bool Equations::factorize() {
    hessian.setZero();
    addMasses();
    for (const SystemContact& c : contacts) addContact(c);
    for (SystemRow& row : rows) addRow(row);
    return hessian.factorize();
}

}  // namespace ragtop::direct
