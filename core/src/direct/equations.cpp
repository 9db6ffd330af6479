// Evaluation, loads and line search of the equations.

#include "direct/equations.h"

#include <cmath>

namespace ragtop::direct {

Equations::Equations(std::pmr::memory_resource* memory)
    : bodies(memory),
      contacts(memory),
      points(memory),
      pairs(memory),
      rows(memory),
      velocity(memory),
      free(memory),
      hessian(memory),
      scratch{AlignedArray<double>(memory), AlignedArray<double>(memory), AlignedArray<double>(memory)} {}

namespace {

DVec3 pointVelocity(const double* v, std::int32_t body, const DVec3& arm) {
    if (body == kFixed) return {};
    const double* at = v + 6 * body;
    return load(at) + cross(load(at + 3), arm);
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
void Equations::applyImpulses(double* momentum, bool loads) const {
    for (const SystemContact& c : contacts) {
        DVec3 sum, momentA, momentB;
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = points[c.first + j];
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
    for (const SystemPair& pair : pairs) {
        Twist sum;
        for (std::uint32_t i = pair.first; i < pair.first + pair.count; ++i)
            if (const double l = loads ? rows[i].load : rows[i].impulse; l != 0) addAlong(rows[i], l, sum);
        push(pair, sum, momentum);
    }
}

Twist Equations::motionOf(const SystemPair& pair, const double* v) const {
    Twist u;
    if (pair.b != kFixed) {
        const double* at = v + 6 * pair.b;
        const Twist of = unlocked(bodies[static_cast<std::size_t>(pair.b)].locks, {load(at), load(at + 3)});
        u = {of.linear + cross(of.turn, pair.armB), of.turn};
    }
    if (pair.a != kFixed) {
        const double* at = v + 6 * pair.a;
        const Twist of = unlocked(bodies[static_cast<std::size_t>(pair.a)].locks, {load(at), load(at + 3)});
        u = {u.linear - (of.linear + cross(of.turn, pair.armA)), u.turn - of.turn};
    }
    return u;
}

void Equations::push(const SystemPair& pair, const Twist& load, double* momentum) const {
    const auto give = [&](std::int32_t body, double sign, const DVec3& arm) {
        const Twist given = unlocked(bodies[static_cast<std::size_t>(body)].locks,
                                     {sign * load.linear, sign * (cross(arm, load.linear) + load.turn)});
        add(given.linear, momentum + 6 * body);
        add(given.turn, momentum + 6 * body + 3);
    };
    if (pair.a != kFixed) give(pair.a, -1, pair.armA);
    if (pair.b != kFixed) give(pair.b, 1, pair.armB);
}

void Equations::velocityOfLoads(double* v) const {
    for (std::size_t i = 0; i < unknowns(); ++i) v[i] = 0;
    applyImpulses(v, true);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        double* at = v + 6 * i;
        for (int k = 0; k < 3; ++k) at[k] *= bodies[i].inverseMass[k];
        store(bodies[i].inverseTaut * load(at + 3), at + 3);
        for (std::size_t k = 0; k < 6; ++k) at[k] += free[6 * i + k];
    }
}

void Equations::freeBefore(const double* v) {
    double* given = scratch.gradient.data();
    for (std::size_t k = 0; k < unknowns(); ++k) given[k] = 0;
    applyImpulses(given, false);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const double* at = given + 6 * i;
        for (std::size_t k = 0; k < 3; ++k) free[6 * i + k] = v[6 * i + k] - bodies[i].inverseMass[k] * at[k];
        store(load(v + 6 * i + 3) - bodies[i].inverseTaut * load(at + 3), free.data() + 6 * i + 3);
    }
}

void Equations::speedsAt(const double* v) {
    for (const SystemContact& c : contacts)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points[c.first + j];
            const DVec3 u = pointVelocity(v, c.b, p.armB) - pointVelocity(v, c.a, p.armA);
            p.speed[0] = dot(u, c.normal) + p.drift[0];
            p.speed[1] = dot(u, c.tangent1) + p.drift[1];
            p.speed[2] = dot(u, c.tangent2) + p.drift[2];
        }
    for (const SystemPair& pair : pairs) {
        const Twist u = motionOf(pair, v);
        for (std::uint32_t i = pair.first; i < pair.first + pair.count; ++i) rows[i].speed = alongRow(rows[i], u);
    }
}

Residual Equations::evaluate(const double* v, double* gradient) {
    loadsAt(v);
    return gradientAt(v, gradient);
}

void Equations::loadsAt(const double* v) {
    speedsAt(v);
    for (const SystemContact& c : contacts)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points[c.first + j];
            unbounded(p, c.friction, p.speed, p.asked);
            const ConePoint found = project(p.asked, c.friction);
            for (int k = 0; k < 3; ++k) p.impulse[k] = found.impulse[k];
            p.region = found.region;
        }
    for (SystemRow& row : rows) {
        const double y = unbounded(row, row.speed);
        row.side = sideOf(row, y);
        row.impulse = atSide(row, row.side, y);
    }
}

/// A load on the cone, of a point that slides by s along −t, is the projection of λ̂ + (s/R) (−μ, t).
void Equations::askForLoads() {
    constexpr double kOnCone = 1 - 1e-6;  // loads are rounded to floats between steps
    for (const SystemContact& c : contacts)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points[c.first + j];
            const double held = std::sqrt(p.load[1] * p.load[1] + p.load[2] * p.load[2]);
            const bool slides = held > 0 && held >= kOnCone * c.friction * p.load[0];
            p.region = !(p.load[0] > 0) ? ConeRegion::apart : slides ? ConeRegion::slide : ConeRegion::stick;
            const double further = slides ? p.slip / p.resistance : 0;
            for (int k = 0; k < 3; ++k) p.asked[k] = p.impulse[k] = p.load[k];
            p.asked[0] -= c.friction * further;
            for (int k = 1; k < 3; ++k) p.asked[k] += slides ? further * p.load[k] / held : 0;
        }
}

Residual Equations::gradientAt(const double* v, double* gradient) const {
    for (std::size_t i = 0; i < unknowns(); ++i) gradient[i] = 0;
    applyImpulses(gradient, false);
    Residual residual;
    residual.scale = impulseNorm(bodies, gradient);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const SystemBody& body = bodies[i];
        double* g = gradient + 6 * i;
        const double* from = free.data() + 6 * i;
        for (int k = 0; k < 3; ++k) g[k] = body.mass[k] * (v[6 * i + static_cast<std::size_t>(k)] - from[k]) - g[k];
        const DVec3 turn = load(v + 6 * i + 3) - load(from + 3);
        store((body.inertia + body.stiffness) * turn - load(g + 3), g + 3);
    }
    residual.norm = impulseNorm(bodies, gradient);
    return residual;
}

/// Rounding changes each load, and its arm, by parts of it: what that does to a body grows with all that it bears, and
/// shows most at the point that gives way most easily.
const double* Equations::roundingSpeeds() {
    double *speeds = scratch.trial.data(), *give = scratch.direction.data();
    for (std::size_t i = 0; i < bodies.size(); ++i) speeds[i] = give[i] = 0;
    for (const SystemContact& c : contacts)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = points[c.first + j];
            for (const std::int32_t body : {c.a, c.b}) {
                if (body == kFixed) continue;
                speeds[body] += p.load[0];
                if (p.resistance > give[body]) give[body] = p.resistance;
            }
        }
    constexpr double kPart = tuning::kLoadRounding / tuning::kContactResistance;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        speeds[i] = tuning::kAtRest * gravityStep + kPart * speeds[i] * give[i];
    return speeds;
}

bool Equations::loadsHold(double share) {
    const double *rounding = roundingSpeeds(), enoughOfRow = share * tuning::kSkip * gravityStep;
    for (const SystemContact& c : contacts) {
        const double ofA = c.a != kFixed ? rounding[c.a] : 0.0, ofB = c.b != kFixed ? rounding[c.b] : 0.0;
        const double enough = share * (ofA > ofB ? ofA : ofB);
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = points[c.first + j];
            for (int k = 0; k < 3; ++k)
                if (std::fabs(p.impulse[k] - p.load[k]) * p.resistance > enough) return false;
        }
    }
    for (const SystemRow& row : rows)
        if (std::fabs(row.impulse - row.load) * row.resistance > enoughOfRow) return false;
    return true;
}

void Equations::keepPointLoads() {
    for (SystemPoint& p : points)
        for (int k = 0; k < 3; ++k) p.impulse[k] = p.load[k];
}

void Equations::keepLoads() {
    keepPointLoads();
    for (SystemRow& row : rows) row.impulse = row.load;
}

/// Rigid rows that hold nothing new add up what rounding asks of them: λ ← R⁻¹ J H⁻¹ Jᵀ λ keeps all that moves a body,
/// but for the share R of its row's inverse mass, and nothing else.
void Equations::dropSelfStress() {
    const auto isRigid = [](const SystemRow& row) {
        return !row.compliant && std::isinf(row.lower) && std::isinf(row.upper);
    };
    double* x = scratch.direction.data();
    for (std::size_t i = 0; i < unknowns(); ++i) x[i] = 0;
    for (const SystemPair& pair : pairs) {
        Twist sum;
        for (std::uint32_t i = pair.first; i < pair.first + pair.count; ++i)
            if (isRigid(rows[i])) addAlong(rows[i], rows[i].impulse, sum);
        push(pair, sum, x);
    }
    hessian.solve(x);
    for (const SystemPair& pair : pairs) {
        const Twist u = motionOf(pair, x);
        for (std::uint32_t i = pair.first; i < pair.first + pair.count; ++i)
            if (isRigid(rows[i])) rows[i].impulse = alongRow(rows[i], u) / rows[i].resistance;
    }
}

bool Equations::isBelow(std::size_t index, double speed) const {
    const SystemBody& body = bodies[index];
    const double* v = velocity.data() + 6 * index;
    const DVec3 linear = load(v), turn = load(v + 3);
    return dot(linear, linear) + dot(turn, body.inertia * turn) / body.mass[0] <= speed * speed;
}

bool Equations::stopBelow(std::size_t index, double speed) {
    if (!isBelow(index, speed)) return false;
    double* v = velocity.data() + 6 * index;
    for (int k = 0; k < 6; ++k) v[k] = 0;
    return true;
}

void Equations::stopRounding() {
    stopped = true;
    const double* rounding = roundingSpeeds();
    for (const SystemPoint& p : points) stopped &= p.drift[0] == 0 && p.drift[1] == 0 && p.drift[2] == 0;
    // What rounding does to the foot of a column moves all that stands on it.
    double largest = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) largest = rounding[i] > largest ? rounding[i] : largest;
    bool all = true;
    for (std::size_t i = 0; i < bodies.size(); ++i) all &= isBelow(i, largest);
    for (std::size_t i = 0; i < bodies.size(); ++i) stopped &= stopBelow(i, all ? largest : rounding[i]);
}

bool Equations::regionsChanged() const {
    for (const SystemPoint& p : points)
        if (p.region != p.factored) return true;
    for (const SystemRow& row : rows)
        if ((row.side == Side::within) != row.factored) return true;
    return false;
}

void Equations::changeAlong(const double* d) {
    for (const SystemContact& c : contacts)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            SystemPoint& p = points[c.first + j];
            const DVec3 u = pointVelocity(d, c.b, p.armB) - pointVelocity(d, c.a, p.armA);
            p.change[0] = dot(u, c.normal);
            p.change[1] = dot(u, c.tangent1);
            p.change[2] = dot(u, c.tangent2);
        }
    for (const SystemPair& pair : pairs) {
        const Twist u = motionOf(pair, d);
        for (std::uint32_t i = pair.first; i < pair.first + pair.count; ++i) rows[i].change = alongRow(rows[i], u);
    }
}

double Equations::slopeAlong(const double* v, const double* d, double alpha) const {
    double slope = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const SystemBody& body = bodies[i];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t at = 6 * i + k;
            slope += d[at] * body.mass[k] * (v[at] + alpha * d[at] - free[at]);
        }
        const DVec3 turn = load(v + 6 * i + 3) + alpha * load(d + 6 * i + 3) - load(free.data() + 6 * i + 3);
        slope += dot(load(d + 6 * i + 3), (body.inertia + body.stiffness) * turn);
    }
    for (const SystemContact& c : contacts)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = points[c.first + j];
            const double u[3] = {p.speed[0] + alpha * p.change[0], p.speed[1] + alpha * p.change[1],
                                 p.speed[2] + alpha * p.change[2]};
            const ConePoint found = respond(p, c.friction, u);
            for (int k = 0; k < 3; ++k) slope -= p.change[k] * found.impulse[k];
        }
    for (const SystemRow& row : rows) {
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

double Equations::slipsChange() {
    double largest = 0;
    visitSlips(points.data(), contacts, [&](const SystemContact& c, const SystemPoint& p, double slip) {
        const double change = c.friction * std::fabs(slip - p.slip);
        if (change > largest) largest = change;
    });
    return largest;
}

void Equations::updateSlips() {
    visitSlips(points.data(), contacts, [](const SystemContact&, SystemPoint& p, double slip) { p.slip = slip; });
}

void Equations::relieve() {
    constexpr double kWedge = 100;  // times a force: a wedge of half a degree
    double given = 0, largest = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const DVec3 change = load(velocity.data() + 6 * i) - load(free.data() + 6 * i);
        given += bodies[i].mass[0] * (length(change) + gravityStep);
    }
    for (const SystemPoint& p : points) largest = p.load[0] > largest ? p.load[0] : largest;
    if (!(largest > kWedge * given)) return;
    for (SystemPoint& p : points)
        for (double& load : p.load) load *= kWedge * given / largest;
    loadsKept = false;
}

void Equations::scaleResistance(double scale) {
    for (SystemPoint& p : points) p.resistance *= scale;
}

void Equations::takePointLoads() {
    for (SystemPoint& p : points)
        for (int k = 0; k < 3; ++k) {
            loadsKept &= p.load[k] == p.impulse[k];
            p.load[k] = p.impulse[k];
        }
    relieve();
}

void Equations::takeLoads() {
    takePointLoads();
    for (SystemRow& row : rows)
        if (!row.compliant) row.load = row.impulse;
}

}  // namespace ragtop::direct
