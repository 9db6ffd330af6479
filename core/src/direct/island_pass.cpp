// Targets, evaluation and line search of an island's system.

#include <cmath>

#include "constraints/contact_layout.h"
#include "direct/island_system.h"

namespace ragtop::direct {

namespace {

/// rotate(q, v) − v without cancellation.
DVec3 turned(const Quat& q, const DVec3& v) {
    const DVec3 u{q.x, q.y, q.z};
    const DVec3 t = 2.0 * cross(u, v);
    return static_cast<double>(q.w) * t + cross(u, t);
}

DVec3 pointVelocity(const double* v, std::int32_t body, const DVec3& arm) {
    if (body == kFixed) return {};
    const double* at = v + 6 * body;
    return load(at) + cross(load(at + 3), arm);
}

double rowSpeed(const SystemRow& row, const double* v) {
    double u = 0;
    if (row.a != kFixed)
        for (int k = 0; k < 6; ++k) u += row.ja[k] * v[6 * row.a + k];
    if (row.b != kFixed)
        for (int k = 0; k < 6; ++k) u += row.jb[k] * v[6 * row.b + k];
    return u;
}

/// λ of a point at the speed u.
ConePoint respond(const SystemPoint& p, double friction, const double u[3]) {
    double y[3];
    unbounded(p, friction, u, y);
    return project(y, friction);
}

/// Of a row, if nothing bounded it.
double unbounded(const SystemRow& row, double u) { return row.load - (u - row.target) / row.resistance; }

Side sideOf(const SystemRow& row, double y) {
    return y < row.lower ? Side::lower : y > row.upper ? Side::upper : Side::within;
}

double atSide(const SystemRow& row, Side side, double y) {
    return side == Side::lower ? row.lower : side == Side::upper ? row.upper : y;
}

double impulseNorm(const AlignedArray<SystemBody>& bodies, const double* x) {
    double sum = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const double* at = x + 6 * i;
        for (int k = 0; k < 3; ++k) sum += bodies[i].inverseMass[k] * at[k] * at[k];
        const DVec3 l = load(at + 3);
        sum += dot(l, bodies[i].inverseInertia * l);
    }
    return std::sqrt(sum);
}

}  // namespace

void IslandSystem::updateGaps(const BodyArrays& arrays) {
    for (const SystemContact& c : contacts_) {
        const BodyState &a = arrays.states[c.stateA], &b = arrays.states[c.stateB];
        const DVec3 moved = toDouble(b.dp) - toDouble(a.dp);
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points_[c.first + j];
            // What turns is a round shape's core; its surface stays round.
            const DVec3 turn = turned(b.dq, p.armB + c.roundB * c.normal) - turned(a.dq, p.armA - c.roundA * c.normal);
            p.gap = p.startGap + dot(c.normal, moved + turn);
        }
    }
}

/// Apart, a gap may be used up within the substep; touching, errors decay as in the soft row. Points within kContactGap
/// count as touching, so that rounding of gaps does not decide who bears a load.
void IslandSystem::aimAtPositions(const BodyArrays& arrays, const SolverContext& context) {
    updateGaps(arrays);
    const double inverseH = context.inverseH;
    for (const SystemContact& c : contacts_) {
        const bool fixed = c.a == kFixed || c.b == kFixed;
        const double rate = fixed ? context.softStatic.biasRate : context.soft.biasRate;
        const double near = c.near, rounded = c.rounded;
        const double push = static_cast<double>(context.pushOut) * c.size;
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points_[c.first + j];
            const double error = p.gap > rounded ? p.gap - rounded : p.gap < -rounded ? p.gap + rounded : 0.0;
            if (p.gap > near)
                p.target = -(p.gap - near) * inverseH - rate * (near - rounded);
            else
                p.target = -rate * error < push ? -rate * error : push;
        }
    }
}

/// The speeds by which other bounds and drags of a row may change it.
template <class Note>
static void recordRest(const SystemRow& row, Note&& note) {
    const double stiffer = row.resistance / row.resting.resistance - 1;
    note(stiffer < 1 ? stiffer * row.speed : row.speed);
    // A load at a bound that moves.
    const double admittance = row.resistance / tuning::kRowResistance;
    if (row.resting.upper != row.upper && row.impulse >= row.upper) note(admittance * row.upper);
    if (row.resting.lower != row.lower && row.impulse <= row.lower) note(admittance * row.lower);
}

bool IslandSystem::aimAtVelocities(const BodyArrays& arrays, const SolverContext& context) {
    if (stopped_) return false;  // nothing was pushed
    updateGaps(arrays);
    double largest = 0;
    const auto note = [&](double change) {
        const double size = std::fabs(change);
        if (size > largest) largest = size;
    };
    for (const SystemContact& c : contacts_) {
        const double near = c.near;
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points_[c.first + j];
            // What is to bounce comes to the surface with its own speed; the next substep reflects it there.
            if (c.restitution > 0 && p.speed[0] < -static_cast<double>(context.restitutionSpeed)) continue;
            const double target = p.gap > near ? -(p.gap - near) * static_cast<double>(context.inverseH) : 0.0;
            if (p.impulse[0] > 0 || p.speed[0] < target) note(target - p.target);
            p.target = target;
        }
    }
    const auto recordRow = [&](double change) { note(tuning::kAtRest / tuning::kSkip * change); };
    for (SystemRow& row : rows_) {
        recordRow(0.1 * (row.resting.target - row.target));
        recordRest(row, recordRow);
        row.target = row.resting.target;
        row.lower = row.resting.lower;
        row.upper = row.resting.upper;
        if (row.resting.resistance != row.resistance) row.factored = row.side != Side::within;
        row.resistance = row.resting.resistance;
    }
    if (largest <= tuning::kAtRest * gravityStep_) return false;
    // A load that errors of positions ask for in vain, because bodies that touch at many points cannot heed them all,
    // is shifted to other points with every substep until none is asked for.
    takePointLoads();
    // What moving the positions did to the velocities (spins turn with their bodies) belongs to the free motion.
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const BodyState& state = arrays.states[bodies_[i].state];
        for (int k = 0; k < 3; ++k) {
            free_[6 * i + static_cast<std::size_t>(k)] +=
                static_cast<double>(state.v[k]) - static_cast<double>(written_[2 * i][k]);
            free_[6 * i + 3 + static_cast<std::size_t>(k)] +=
                static_cast<double>(state.w[k]) - static_cast<double>(written_[2 * i + 1][k]);
        }
        store(toDouble(state.v), velocity_.data() + 6 * i);
        store(toDouble(state.w), velocity_.data() + 6 * i + 3);
    }
    return true;
}

void IslandSystem::applyImpulses(double* momentum, bool loads) const {
    for (const SystemContact& c : contacts_) {
        DVec3 sum, momentA, momentB;
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = points_[c.first + j];
            const double* l = loads ? p.load : p.impulse;
            const DVec3 f = l[0] * c.normal + l[1] * c.tangent1 + l[2] * c.tangent2;
            sum = sum + f;
            momentA = momentA + cross(p.armA, f);
            momentB = momentB + cross(p.armB, f);
        }
        if (c.a != kFixed) {
            add(-1.0 * sum, momentum + 6 * c.a);
            add(-1.0 * momentA, momentum + 6 * c.a + 3);
        }
        if (c.b != kFixed) {
            add(sum, momentum + 6 * c.b);
            add(momentB, momentum + 6 * c.b + 3);
        }
    }
    for (const SystemRow& row : rows_) {
        const double l = loads ? row.load : row.impulse;
        if (l == 0) continue;
        for (int k = 0; k < 6; ++k) {
            if (row.a != kFixed) momentum[6 * row.a + k] += row.ja[k] * l;
            if (row.b != kFixed) momentum[6 * row.b + k] += row.jb[k] * l;
        }
    }
}

void IslandSystem::velocityOfLoads(double* v) const {
    for (std::size_t i = 0; i < unknowns(); ++i) v[i] = 0;
    applyImpulses(v, true);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        double* at = v + 6 * i;
        for (int k = 0; k < 3; ++k) at[k] *= bodies_[i].inverseMass[k];
        store(bodies_[i].inverseTaut * load(at + 3), at + 3);
        for (std::size_t k = 0; k < 6; ++k) at[k] += free_[6 * i + k];
    }
}

void IslandSystem::speedsAt(const double* v) {
    for (const SystemContact& c : contacts_)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points_[c.first + j];
            const DVec3 u = pointVelocity(v, c.b, p.armB) - pointVelocity(v, c.a, p.armA);
            p.speed[0] = dot(u, c.normal) + p.drift[0];
            p.speed[1] = dot(u, c.tangent1) + p.drift[1];
            p.speed[2] = dot(u, c.tangent2) + p.drift[2];
        }
    for (SystemRow& row : rows_) row.speed = rowSpeed(row, v);
}

Residual IslandSystem::evaluate(const double* v, double* gradient) {
    speedsAt(v);
    for (const SystemContact& c : contacts_)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points_[c.first + j];
            unbounded(p, c.friction, p.speed, p.asked);
            const ConePoint found = project(p.asked, c.friction);
            for (int k = 0; k < 3; ++k) p.impulse[k] = found.impulse[k];
            p.region = found.region;
        }
    for (SystemRow& row : rows_) {
        const double y = unbounded(row, row.speed);
        row.side = sideOf(row, y);
        row.impulse = atSide(row, row.side, y);
    }
    return gradientAt(v, gradient);
}

/// A load on the cone, of a point that slides by s along −t, is the projection of λ̂ + (s/R) (−μ, t).
void IslandSystem::askForLoads() {
    constexpr double kOnCone = 1 - 1e-6;  // loads are rounded to floats between steps
    for (const SystemContact& c : contacts_)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points_[c.first + j];
            const double held = std::sqrt(p.load[1] * p.load[1] + p.load[2] * p.load[2]);
            const bool slides = held > 0 && held >= kOnCone * c.friction * p.load[0];
            p.region = !(p.load[0] > 0) ? ConeRegion::apart : slides ? ConeRegion::slide : ConeRegion::stick;
            const double further = slides ? p.slip / p.resistance : 0;
            for (int k = 0; k < 3; ++k) p.asked[k] = p.impulse[k] = p.load[k];
            p.asked[0] -= c.friction * further;
            for (int k = 1; k < 3; ++k) p.asked[k] += slides ? further * p.load[k] / held : 0;
        }
}

Residual IslandSystem::gradientAt(const double* v, double* gradient) const {
    for (std::size_t i = 0; i < unknowns(); ++i) gradient[i] = 0;
    applyImpulses(gradient, false);
    Residual residual;
    residual.scale = impulseNorm(bodies_, gradient);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const SystemBody& body = bodies_[i];
        double* g = gradient + 6 * i;
        const double* from = free_.data() + 6 * i;
        for (int k = 0; k < 3; ++k) g[k] = body.mass[k] * (v[6 * i + static_cast<std::size_t>(k)] - from[k]) - g[k];
        const DVec3 turn = load(v + 6 * i + 3) - load(from + 3);
        store((body.inertia + body.stiffness) * turn - load(g + 3), g + 3);
    }
    residual.norm = impulseNorm(bodies_, gradient);
    return residual;
}

/// Rounding changes each load, and its arm, by parts of it: what that does to a body grows with all that it bears, and
/// shows most at the point that gives way most easily.
const double* IslandSystem::roundingSpeeds() {
    double *speeds = scratch_.trial.data(), *give = scratch_.direction.data();
    for (std::size_t i = 0; i < bodies_.size(); ++i) speeds[i] = give[i] = 0;
    for (const SystemContact& c : contacts_)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = points_[c.first + j];
            for (const std::int32_t body : {c.a, c.b}) {
                if (body == kFixed) continue;
                speeds[body] += p.load[0];
                if (p.resistance > give[body]) give[body] = p.resistance;
            }
        }
    constexpr double kPart = tuning::kLoadRounding / tuning::kContactResistance;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
        speeds[i] = tuning::kAtRest * gravityStep_ + kPart * speeds[i] * give[i];
    return speeds;
}

bool IslandSystem::loadsHold(double share) {
    const double *rounding = roundingSpeeds(), enoughOfRow = share * tuning::kSkip * gravityStep_;
    for (const SystemContact& c : contacts_) {
        const double ofA = c.a != kFixed ? rounding[c.a] : 0.0, ofB = c.b != kFixed ? rounding[c.b] : 0.0;
        const double enough = share * (ofA > ofB ? ofA : ofB);
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = points_[c.first + j];
            for (int k = 0; k < 3; ++k)
                if (std::fabs(p.impulse[k] - p.load[k]) * p.resistance > enough) return false;
        }
    }
    for (const SystemRow& row : rows_)
        if (std::fabs(row.impulse - row.load) * row.resistance > enoughOfRow) return false;
    return true;
}

void IslandSystem::keepLoads() {
    for (SystemPoint& p : points_)
        for (int k = 0; k < 3; ++k) p.impulse[k] = p.load[k];
    for (SystemRow& row : rows_) row.impulse = row.load;
}

/// Rigid rows that hold nothing new add up what rounding asks of them: λ ← R⁻¹ J H⁻¹ Jᵀ λ keeps all that moves a body,
/// but for the share R of its row's inverse mass, and nothing else.
void IslandSystem::dropSelfStress() {
    const auto isRigid = [](const SystemRow& row) {
        return !row.compliant && std::isinf(row.lower) && std::isinf(row.upper);
    };
    double* x = scratch_.direction.data();
    for (std::size_t i = 0; i < unknowns(); ++i) x[i] = 0;
    for (const SystemRow& row : rows_) {
        if (!isRigid(row)) continue;
        for (int k = 0; k < 6; ++k) {
            if (row.a != kFixed) x[6 * row.a + k] += row.ja[k] * row.impulse;
            if (row.b != kFixed) x[6 * row.b + k] += row.jb[k] * row.impulse;
        }
    }
    factor_.solve(x);
    for (SystemRow& row : rows_)
        if (isRigid(row)) row.impulse = rowSpeed(row, x) / row.resistance;
}

bool IslandSystem::isBelow(std::size_t index, double speed) const {
    const SystemBody& body = bodies_[index];
    const double* v = velocity_.data() + 6 * index;
    const DVec3 linear = load(v), turn = load(v + 3);
    return dot(linear, linear) + dot(turn, body.inertia * turn) / body.mass[0] <= speed * speed;
}

bool IslandSystem::stopBelow(std::size_t index, double speed) {
    if (!isBelow(index, speed)) return false;
    double* v = velocity_.data() + 6 * index;
    for (int k = 0; k < 6; ++k) v[k] = 0;
    return true;
}

void IslandSystem::stopRounding() {
    stopped_ = true;
    const double* rounding = roundingSpeeds();
    for (const SystemPoint& p : points_) stopped_ &= p.drift[0] == 0 && p.drift[1] == 0 && p.drift[2] == 0;
    // What rounding does to the foot of a column moves all that stands on it.
    double largest = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) largest = rounding[i] > largest ? rounding[i] : largest;
    bool all = true;
    for (std::size_t i = 0; i < bodies_.size(); ++i) all &= isBelow(i, largest);
    for (std::size_t i = 0; i < bodies_.size(); ++i) stopped_ &= stopBelow(i, all ? largest : rounding[i]);
}

bool IslandSystem::regionsChanged() const {
    for (const SystemPoint& p : points_)
        if (p.region != p.factored) return true;
    for (const SystemRow& row : rows_)
        if ((row.side == Side::within) != row.factored) return true;
    return false;
}

void IslandSystem::changeAlong(const double* d) {
    for (const SystemContact& c : contacts_)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points_[c.first + j];
            const DVec3 u = pointVelocity(d, c.b, p.armB) - pointVelocity(d, c.a, p.armA);
            p.change[0] = dot(u, c.normal);
            p.change[1] = dot(u, c.tangent1);
            p.change[2] = dot(u, c.tangent2);
        }
    for (SystemRow& row : rows_) row.change = rowSpeed(row, d);
}

double IslandSystem::slopeAlong(const double* v, const double* d, double alpha) const {
    double slope = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const SystemBody& body = bodies_[i];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t at = 6 * i + k;
            slope += d[at] * body.mass[k] * (v[at] + alpha * d[at] - free_[at]);
        }
        const DVec3 turn = load(v + 6 * i + 3) + alpha * load(d + 6 * i + 3) - load(free_.data() + 6 * i + 3);
        slope += dot(load(d + 6 * i + 3), (body.inertia + body.stiffness) * turn);
    }
    for (const SystemContact& c : contacts_)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = points_[c.first + j];
            const double u[3] = {p.speed[0] + alpha * p.change[0], p.speed[1] + alpha * p.change[1],
                                 p.speed[2] + alpha * p.change[2]};
            const ConePoint found = respond(p, c.friction, u);
            for (int k = 0; k < 3; ++k) slope -= p.change[k] * found.impulse[k];
        }
    for (const SystemRow& row : rows_) {
        const double y = unbounded(row, row.speed + alpha * row.change);
        slope -= row.change * atSide(row, sideOf(row, y), y);
    }
    return slope;
}

/// The convex cone lifts what slides: its normal row obeys u_n = μ |u_t|. Adding the slip to the row takes that back
/// [De Saxcé, Feng, 1998], also where nothing bears yet, or such points would come and go with each round.
template <class Visit>
static void visitSlips(SystemPoint* points, const AlignedArray<SystemContact>& contacts, Visit&& visit) {
    for (const SystemContact& c : contacts)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points[c.first + j];
            const bool sticks = p.region == ConeRegion::stick;
            visit(c, p, sticks ? 0.0 : std::sqrt(p.speed[1] * p.speed[1] + p.speed[2] * p.speed[2]));
        }
}

double IslandSystem::slipsChange() {
    double largest = 0;
    visitSlips(points_.data(), contacts_, [&](const SystemContact& c, const SystemPoint& p, double slip) {
        const double change = c.friction * std::fabs(slip - p.slip);
        if (change > largest) largest = change;
    });
    return largest;
}

void IslandSystem::updateSlips() {
    visitSlips(points_.data(), contacts_, [](const SystemContact&, SystemPoint& p, double slip) { p.slip = slip; });
}

}  // namespace ragtop::direct
