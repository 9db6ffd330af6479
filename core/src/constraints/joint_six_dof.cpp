#include <cmath>

#include "constraints/axes_writer.h"

namespace ragtop {
namespace {

/// How much faster than the rotation the swing may turn about the x axis, θ/sin θ at 2.5 rad; it grows without bound
/// towards a half turn, where the swing has no direction.
constexpr float kFastest = 4.2f;
/// The twist is as much faster than the rotation, 1/cos(θ/2); there the same.
constexpr float kLeastCosine = 0.3f;

struct SwingRows {
    float y, z;
    Vec3 rowY, rowZ;  ///< of the relative angular velocity, in A's frame
    bool vague;       ///< slower than the swing
};

/// With B's x axis d = (cos θ, sin θ n_z, −sin θ n_y) and m = (0, n_y, n_z), ω turns it by θ' = ω · m and
/// φ' = ω · (d × m)/sin θ, so that the swing vector θ n has the rate θ' n + θ φ' n⊥.
SwingRows swingRows(const Vec3& d) {
    const float across = std::sqrt(d.y * d.y + d.z * d.z), angle = arcTan2(across, d.x);
    const bool turned = across > 1e-6f;
    const float ny = turned ? -d.z / across : 1.0f, nz = turned ? d.y / across : 0.0f;
    const bool vague = angle >= kFastest * across && d.x < 0;
    const float rate = vague ? kFastest : turned ? angle / across : 1.0f;
    const Vec3 m{0, ny, nz}, around = rate * cross(d, m);
    return {angle * ny, angle * nz, ny * m - nz * around, nz * m + ny * around, vague};
}

}  // namespace

void writeSixDof(AxesWriter& write, const JointPlace& place) {
    const Vec3 xA = rotate(place.a, {1, 0, 0}), xB = rotate(place.b, {1, 0, 0});
    const SwingTwist angles = swingTwist(place.a, place.b);
    const float c = angles.cosHalfSwing > kLeastCosine ? angles.cosHalfSwing : kLeastCosine;
    write.free({{}, (1 / c) * twistAxis(xA, xB)}, write.turn(angles.twist));
    const SwingRows swing = swingRows(inverseRotate(place.a, xB));
    write.setVague((angles.cosHalfSwing > kLeastCosine ? 0u : 1u) | (swing.vague ? 6u : 0u));
    write.free({{}, rotate(place.a, swing.rowY)}, static_cast<double>(swing.y));
    write.free({{}, rotate(place.a, swing.rowZ)}, static_cast<double>(swing.z));
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        const Vec3 direction = rotate(place.a, axis);
        write.free(travelRow(direction, place.gap), static_cast<double>(dot(direction, place.gap)));
    }
}

}  // namespace ragtop
