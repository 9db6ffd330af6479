// Impacts that bounce, within a substep. Included by wide_kernels.inl.

namespace ragtop {
namespace {

constexpr int kBounceIterations = 8;  // passes over the points of a contact

/// What a contact knows of the impacts ahead of it in this substep. Bodies move with constant acceleration on the line that
/// ends with their velocity of now; displacements are such that this is so from the beginning of the substep.
template <int N>
struct Impacts {
    Mask<N> strikes[contact::kMaxPoints];
    Lanes<N> speed[contact::kMaxPoints];  ///< m/s along the normal when struck, below zero
    Lanes<N> time[contact::kMaxPoints];   ///< s from the beginning of the substep
    Lanes<N> gain[contact::kMaxPoints];   ///< m/s along the normal from then to its end
    Mask<N> any;
};

template <int N>
RAGTOP_INLINE void foresee(const ContactBundle<N>& c, const WideVec3<N>& acceleration, const SolverContext& context,
                           Impacts<N>& impacts) {
    WideVec3<N> dp;
    WideQuat<N> dqA, dqB;
    c.gatherDisplacements(dp, dqA, dqB);
    const Separations<N> separations(c, dp, dqA, dqB);
    const Lanes<N> zero(0.0f), h(context.h), threshold(-context.restitutionSpeed);
    const Lanes<N> a = dot(c.normal, acceleration);
    const Mask<N> bouncy = c.field(contact::kRestitution) > zero;
    impacts.any = {zero.v != zero.v};
    for (int j = 0; j < contact::kMaxPoints; ++j) {
        const WideVec3<N> anchor = c.vector(pointField(j, contact::kAnchor));
        const Lanes<N> gap = max(separations.at(c, j, anchor), zero);
        const Lanes<N> last = dot(c.normal, c.relativeVelocity(anchor, anchor - c.offset)), first = last - h * a;
        // The root of gap + first t + a t²/2.
        const Lanes<N> struck = sqrt(max(first * first - 2.0f * (a * gap), zero));
        const Lanes<N> time = divideOrZero(2.0f * gap, struck - first);
        const Mask<N> present = c.field(pointField(j, contact::kMass)) > zero;
        impacts.strikes[j] = bouncy & present & (-struck < threshold) & (first < zero) & (last < zero) & (time <= h);
        impacts.speed[j] = -struck;
        impacts.time[j] = min(time, h);
        impacts.gain[j] = a * (h - impacts.time[j]);
        impacts.any = impacts.any | impacts.strikes[j];
    }
}

/// u⁺ = −e u⁻ for the points that are struck in this substep, with Coulomb friction during the impact. Each body leaves
/// its old line for the new one where they meet: displacements take back what the new velocity would have moved it
/// before. What that sets in motion is struck in the next iteration, so impacts run through a row of bodies one by one.
template <int N>
bool bounceContacts(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    bool bounced = false;
    const Lanes<N> zero(0.0f), inverseH(context.inverseH);
    for (int i = begin; i < end; ++i) {
        float* fields = bundles + static_cast<long>(i) * contact::kFields * N;
        const Lanes<N> restitution = Lanes<N>::load(fields + contact::kRestitution * N);
        if (!any(restitution > 0.0f)) continue;
        ContactBundle<N> c(fields, arrays);
        const auto historiesA = c.rowsOf(arrays.history, contact::kBodyA);
        const auto historiesB = c.rowsOf(arrays.history, contact::kBodyB);
        Lanes<N> memoryA[8], memoryB[8];
        gather8<N>(historiesA, memoryA);
        gather8<N>(historiesB, memoryB);
        const WideVec3<N> startA = c.vA, startB = c.vB;
        const WideVec3<N> acceleration =
            inverseH * ((startB - WideVec3<N>{memoryB[0], memoryB[1], memoryB[2]}) -
                        (startA - WideVec3<N>{memoryA[0], memoryA[1], memoryA[2]}));
        Impacts<N> impacts;
        foresee(c, acceleration, context, impacts);
        if (!any(impacts.any)) continue;
        bounced = true;
        c.recallArms();

        Lanes<N> impulses[contact::kMaxPoints] = {zero, zero, zero, zero};
        for (int iteration = 0; iteration < kBounceIterations; ++iteration)
            for (int j = 0; j < contact::kMaxPoints; ++j) {
                const WideVec3<N> rA = c.arm(pointField(j, contact::kAnchor)), rB = rA - c.offset;
                const Lanes<N> speed = dot(c.normal, c.relativeVelocity(rA, rB)) - impacts.gain[j];
                const Lanes<N> change =
                    -(c.field(pointField(j, contact::kMass)) * (speed + restitution * impacts.speed[j]));
                const Lanes<N> impulse = select(impacts.strikes[j], max(impulses[j] + change, zero), zero);
                c.applyImpulse((impulse - impulses[j]) * c.normal, rA, rB);
                impulses[j] = impulse;
            }
        Lanes<N> total(0.0f), moment(0.0f);
        for (int j = 0; j < contact::kMaxPoints; ++j) {
            total = total + impulses[j];
            moment = moment + impulses[j] * impacts.time[j];
            const Lanes<N> approach = c.field(contact::kApproach + j);
            c.set(contact::kApproach + j, select(impacts.strikes[j], min(approach, impacts.speed[j]), approach));
            c.set(pointField(j, contact::kPeak), c.field(pointField(j, contact::kPeak)) + impulses[j]);
        }
        const WideVec3<N> center = c.arm(contact::kCenter);
        const WideVec3<N> slip = c.relativeVelocity(center, center - c.offset) + c.vector(contact::kSurface);
        Lanes<N> sliding = zero;
        c.applyImpulse(intoCone(c, stoppingImpulse(c, slip), total, sliding), center, center - c.offset);

        const Lanes<N> time = divideOrZero(moment, total);
        const WideVec3<N> changeA = c.vA - startA, changeB = c.vB - startB;
        memoryA[0] = memoryA[0] + changeA.x, memoryA[1] = memoryA[1] + changeA.y, memoryA[2] = memoryA[2] + changeA.z;
        memoryB[0] = memoryB[0] + changeB.x, memoryB[1] = memoryB[1] + changeB.y, memoryB[2] = memoryB[2] + changeB.z;
        c.displace(contact::kBodyA, -(time * changeA), c.massA);
        c.displace(contact::kBodyB, -(time * changeB), c.massB);
        scatterMoving<N>(historiesA, memoryA, c.massA);
        scatterMoving<N>(historiesB, memoryB, c.massB);
        c.writeVelocities();
    }
    return bounced;
}

}  // namespace
}  // namespace ragtop
