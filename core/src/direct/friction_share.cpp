#include "direct/friction_share.h"

#include <cmath>

namespace ragtop::direct {

namespace {

constexpr int kSteps = 24;            ///< of Newton's method
constexpr double kEnough = 1e-8;      ///< of what all points could carry, that may be missing
constexpr double kUndecided = 1e-10;  ///< of the matrix, added to it: once all slide, the speed does not matter

/// Asked for and unknown: along both tangents, and about the normal.
struct Plane {
    double at[3] = {};
};

class Sharing {
public:
    Sharing(SharePoint* points, unsigned count, double mu, const Plane& wanted)
        : points_(points), count_(count), mu_(mu), wanted_(wanted) {}

    /// The friction at a slip, and the function whose gradient is missing().
    double apply(const Plane& slip) {
        double value = 0;
        for (int k = 0; k < 3; ++k) missing_.at[k] = -wanted_.at[k], value -= wanted_.at[k] * slip.at[k];
        for (unsigned j = 0; j < count_; ++j) {
            SharePoint& p = points_[j];
            const double u = slip.at[0] - slip.at[2] * p.y, v = slip.at[1] + slip.at[2] * p.x;
            const double s = std::sqrt(u * u + v * v), share = s > mu_ ? mu_ / s : 1.0;
            p.friction[0] = p.normal * share * u;
            p.friction[1] = p.normal * share * v;
            value += p.normal * (s > mu_ ? mu_ * (s - 0.5 * mu_) : 0.5 * s * s);
            missing_.at[0] += p.friction[0];
            missing_.at[1] += p.friction[1];
            missing_.at[2] += p.x * p.friction[1] - p.y * p.friction[0];
        }
        return value;
    }
    const Plane& missing() const { return missing_; }

    /// Newton's step at a slip.
    Plane step(const Plane& slip) const {
        double h[6] = {};  // 00 01 02 11 12 22
        double full[3] = {};
        for (unsigned j = 0; j < count_; ++j) {
            const SharePoint& p = points_[j];
            const double u = slip.at[0] - slip.at[2] * p.y, v = slip.at[1] + slip.at[2] * p.x;
            const double s = std::sqrt(u * u + v * v);
            const double across = s > mu_ ? mu_ / s : 1.0, along = s > mu_ ? -across / (s * s) : 0.0;
            const double d00 = p.normal * (across + along * u * u), d01 = p.normal * along * u * v;
            const double d11 = p.normal * (across + along * v * v);
            const double r0 = -p.y * d00 + p.x * d01, r1 = -p.y * d01 + p.x * d11;
            h[0] += d00, h[1] += d01, h[2] += r0, h[3] += d11, h[4] += r1;
            h[5] += -p.y * r0 + p.x * r1;
            full[0] += p.normal, full[2] += p.normal * (p.x * p.x + p.y * p.y);
        }
        full[1] = full[0];
        h[0] += kUndecided * full[0], h[3] += kUndecided * full[1], h[5] += kUndecided * full[2];
        return solve(h, missing_);
    }

private:
    /// −H⁻¹ g by Cholesky's method.
    static Plane solve(const double h[6], const Plane& g) {
        if (!(h[5] > 0)) return {{-g.at[0] / h[0], -g.at[1] / h[3], 0}};
        const double l10 = h[1] / h[0], l20 = h[2] / h[0];
        const double d1 = h[3] - l10 * h[1], l21 = (h[4] - l10 * h[2]) / d1;
        const double d2 = h[5] - l20 * h[2] - l21 * l21 * d1;
        const double y0 = -g.at[0], y1 = -g.at[1] - l10 * y0, y2 = -g.at[2] - l20 * y0 - l21 * y1;
        Plane x;
        x.at[2] = d2 > 0 ? y2 / d2 : 0.0;
        x.at[1] = y1 / d1 - l21 * x.at[2];
        x.at[0] = y0 / h[0] - l10 * x.at[1] - l20 * x.at[2];
        return x;
    }

    SharePoint* points_;
    unsigned count_;
    double mu_;
    Plane wanted_, missing_;
};

}  // namespace

void shareFriction(SharePoint* points, unsigned count, double mu, const double friction[2], double twist) {
    double load = 0, moment = 0;
    for (unsigned j = 0; j < count; ++j) {
        points[j].friction[0] = points[j].friction[1] = 0;
        load += points[j].normal;
        moment += points[j].normal * (std::fabs(points[j].x) + std::fabs(points[j].y));
    }
    if (!(mu * load > 0)) return;
    Sharing sharing(points, count, mu, {{friction[0], friction[1], twist}});
    Plane slip;
    double value = sharing.apply(slip);
    for (int i = 0; i < kSteps; ++i) {
        const Plane& m = sharing.missing();
        if (std::fabs(m.at[0]) + std::fabs(m.at[1]) <= kEnough * mu * load &&
            std::fabs(m.at[2]) <= kEnough * mu * moment)
            return;
        const Plane step = sharing.step(slip);
        constexpr int kHalvings = 12;  // 2⁻¹² of a step is none
        double share = 1;
        for (int k = 0; k < kHalvings; ++k, share *= 0.5) {
            const Plane next{
                {slip.at[0] + share * step.at[0], slip.at[1] + share * step.at[1], slip.at[2] + share * step.at[2]}};
            const double found = sharing.apply(next);
            if (found > value && k + 1 < kHalvings) continue;
            slip = next;
            value = found;
            break;
        }
    }
}

}  // namespace ragtop::direct
