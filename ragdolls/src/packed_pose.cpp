#include "ragtop/packed_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "point_joint.h"

namespace ragtop {
namespace {

constexpr int kPlaceBits = 32, kOffBits = 6, kTurnBits = 10;
constexpr double kPlacesPerMeter = 4096;
constexpr float kOffsPerMeter = 1000;
constexpr float kLargestSmall = 0.70710678f;  ///< of the three smaller components of a unit quaternion
constexpr std::size_t kRootBits = 3 * kPlaceBits + 2 + 3 * kTurnBits;
constexpr std::size_t kJointedBits = 3 * kOffBits + 2 + 3 * kTurnBits;

class BitWriter {
public:
    explicit BitWriter(std::span<std::byte> into) : into_(into) { std::fill(into.begin(), into.end(), std::byte{0}); }
    void put(std::uint32_t value, int bits) {
        for (int i = 0; i < bits; ++i, ++at_)
            if (value >> i & 1u) into_[at_ / 8] |= std::byte{1} << (at_ % 8);
    }

private:
    std::span<std::byte> into_;
    std::size_t at_ = 0;
};

class BitReader {
public:
    explicit BitReader(std::span<const std::byte> from) : from_(from) {}
    std::uint32_t take(int bits) {
        std::uint32_t value = 0;
        for (int i = 0; i < bits; ++i, ++at_)
            value |= (std::to_integer<std::uint32_t>(from_[at_ / 8]) >> (at_ % 8) & 1u) << i;
        return value;
    }

private:
    std::span<const std::byte> from_;
    std::size_t at_ = 0;
};

/// Which component is the largest, and the three others in steps from −1/√2 to 1/√2, the largest being above zero.
struct PackedTurn {
    std::uint32_t largest = 0;
    std::array<std::uint32_t, 3> others{};
};

constexpr float kTurnSteps = (1 << kTurnBits) - 1;

PackedTurn packedTurn(const Quat& q) {
    const std::array<float, 4> parts{q.x, q.y, q.z, q.w};
    PackedTurn packed;
    for (std::uint32_t i = 1; i < 4; ++i)
        if (std::abs(parts[i]) > std::abs(parts[packed.largest])) packed.largest = i;
    const float sign = parts[packed.largest] < 0 ? -1.0f : 1.0f;
    for (std::uint32_t i = 0, k = 0; i < 4; ++i) {
        if (i == packed.largest) continue;
        const float share = 0.5f + 0.5f * sign * parts[i] / kLargestSmall;
        packed.others[k++] = static_cast<std::uint32_t>(std::clamp(share, 0.0f, 1.0f) * kTurnSteps + 0.5f);
    }
    return packed;
}

Quat turnOf(const PackedTurn& packed) {
    std::array<float, 4> parts{};
    float rest = 1;
    for (std::uint32_t i = 0, k = 0; i < 4; ++i) {
        if (i == packed.largest) continue;
        parts[i] = kLargestSmall * (2 * (static_cast<float>(packed.others[k++]) / kTurnSteps) - 1);
        rest -= parts[i] * parts[i];
    }
    parts[packed.largest] = std::sqrt(std::max(rest, 0.0f));
    return normalized(Quat{parts[0], parts[1], parts[2], parts[3]});
}

std::uint32_t packedOff(float off) {
    constexpr float kMost = (1 << (kOffBits - 1)) - 1;
    return static_cast<std::uint32_t>(std::floor(std::clamp(off * kOffsPerMeter, -kMost, kMost) + 0.5f) + kMost);
}
float offOf(std::uint32_t packed) {
    constexpr float kMost = (1 << (kOffBits - 1)) - 1;
    return (static_cast<float>(packed) - kMost) / kOffsPerMeter;
}

constexpr double kHalfRange = 2147483648.0;

bool fits(const Pose& pose) {
    const auto within = [](double x) { return std::abs(x) * kPlacesPerMeter < kHalfRange - 1; };
    return isFinite(pose.position) && isFinite(pose.rotation) && within(pose.position.x) && within(pose.position.y) &&
           within(pose.position.z);
}
std::uint32_t packedPlace(double x) {
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(x * kPlacesPerMeter + 0.5) + kHalfRange));
}
double placeOf(std::uint32_t packed) { return (static_cast<double>(packed) - kHalfRange) / kPlacesPerMeter; }

}  // namespace

std::size_t packedSize(const RagdollDef& def) {
    std::size_t bits = 0;
    for (std::size_t i = 0; i < def.parts.size(); ++i)
        bits += pointJointOf(def, static_cast<int>(i)) ? kJointedBits : kRootBits;
    return (bits + 7) / 8;
}

bool pack(const RagdollDef& def, std::span<const Pose> parts, std::span<std::byte> into) {
    if (parts.size() != def.parts.size() || into.size() != packedSize(def)) return false;
    if (!std::all_of(parts.begin(), parts.end(), fits)) return false;
    BitWriter writer(into);
    // What the other side will have: errors of one part are made good by the next.
    std::vector<Pose> unpacked(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const PackedTurn turn = packedTurn(parts[i].rotation);
        writer.put(turn.largest, 2);
        for (const std::uint32_t other : turn.others) writer.put(other, kTurnBits);
        unpacked[i].rotation = turnOf(turn);
        if (const auto joint = pointJointOf(def, static_cast<int>(i))) {
            const DVec3 expected =
                jointed(*joint, unpacked[static_cast<std::size_t>(joint->parent)], unpacked[i].rotation);
            Vec3 off = relative(parts[i].position, expected);
            for (int axis = 0; axis < 3; ++axis) {
                const std::uint32_t steps = packedOff(off[axis]);
                writer.put(steps, kOffBits);
                off[axis] = offOf(steps);
            }
            unpacked[i].position = expected + off;
            continue;
        }
        const DVec3& at = parts[i].position;
        for (const double x : {at.x, at.y, at.z}) writer.put(packedPlace(x), kPlaceBits);
        unpacked[i].position = {placeOf(packedPlace(at.x)), placeOf(packedPlace(at.y)), placeOf(packedPlace(at.z))};
    }
    return true;
}

bool unpack(const RagdollDef& def, std::span<const std::byte> from, std::span<Pose> parts) {
    if (parts.size() != def.parts.size() || from.size() != packedSize(def)) return false;
    BitReader reader(from);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        PackedTurn turn;
        turn.largest = reader.take(2);
        for (std::uint32_t& other : turn.others) other = reader.take(kTurnBits);
        parts[i].rotation = turnOf(turn);
        if (const auto joint = pointJointOf(def, static_cast<int>(i))) {
            Vec3 off;
            for (int axis = 0; axis < 3; ++axis) off[axis] = offOf(reader.take(kOffBits));
            parts[i].position =
                jointed(*joint, parts[static_cast<std::size_t>(joint->parent)], parts[i].rotation) + off;
            continue;
        }
        const double x = placeOf(reader.take(kPlaceBits)), y = placeOf(reader.take(kPlaceBits));
        parts[i].position = {x, y, placeOf(reader.take(kPlaceBits))};
    }
    return true;
}

bool poseOfBones(const RagdollDef& def, std::span<const Pose> parts, std::span<Pose> bones) {
    if (parts.size() != def.parts.size() || bones.size() != def.bones.size()) return false;
    for (std::size_t i = 0; i < bones.size(); ++i)
        bones[i] = parts[static_cast<std::size_t>(def.bones[i].part)] * def.bones[i].inPart;
    return true;
}

}  // namespace ragtop
