#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "bone_tree.h"
#include "ragtop/anatomy.h"

namespace ragtop {

/// Which limb of which body.
enum class LimbKind : std::uint8_t { arm, leg, foreleg, hindleg, wing, insectLeg };
constexpr std::size_t kLimbKinds = 6;

BodyRole firstRole(LimbKind kind);

/// The joints of a limb: shoulder, elbow and wrist, or hip, knee and ankle. The last is −1 where it is only skin.
struct Limb {
    int root = -1;  ///< the first bone that belongs to it alone, a clavicle maybe
    std::array<int, 3> joint{-1, -1, -1};
    std::array<Vec3, 4> point{};  ///< the joints and the tip, m; what is missing as far as it can be told
    float upper = 0, lower = 0;   ///< m; of the lower one 0 where nothing tells
    float misfit = 0;             ///< squared deviation from the proportions of its kind
    int named = 0, misnamed = 0;  ///< joints whose names say so, or say something else
    bool forced = false;          ///< a map says that it is one

    bool isComplete() const { return joint[2] >= 0; }
    Vec3 direction() const { return normalized(point[2] - point[0]); }
    float length2() const { return upper + lower; }  ///< m, of both long segments
};

/// Two limbs of equal build, one on each side. The second may be missing.
struct LimbPair {
    std::array<std::optional<Limb>, 2> limb;
    int attach = -1;   ///< the bone that carries both
    float misfit = 0;  ///< of both, and of one beside the other

    int count() const { return limb[1] ? 2 : 1; }
    Vec3 start() const;                   ///< mean of their first joints, m
    Vec3 direction() const;               ///< mean way from first to third joint, unit
    float length() const;                 ///< m, mean of both long segments
    float mean(int Limb::*number) const;  ///< of a count, per limb
};

/// What is known of bones beforehand.
struct KnownRoles {
    std::vector<std::optional<BoneRole>> of;  ///< by bone
    int head = -1;                            ///< bone that is known to be it
};

/// Finds limbs by branching and by the lengths of their bones, in any pose.
class LimbSearch {
public:
    LimbSearch(const BoneTree& tree, const KnownRoles& known);

    /// Bones that limbs may begin at, longest limb first, at most two dozen.
    std::span<const int> roots() const { return roots_; }
    /// The best pair of limbs of that kind that begin at two of the roots, if they are alike.
    std::optional<LimbPair> pair(int a, int b, LimbKind kind) const;
    /// One limb without another.
    std::optional<LimbPair> single(int root, LimbKind kind) const;
    /// Whether the two limbs have no bone in common and none carries the other.
    bool apart(int a, int b) const;

private:
    const std::vector<Limb>& limbs(int root, LimbKind kind) const;
    std::vector<Limb> fit(int root, LimbKind kind) const;
    void fitPath(const std::vector<int>& path, LimbKind kind, std::vector<Limb>& into) const;
    std::optional<Limb> limbAt(const std::vector<int>& path, const std::array<int, 3>& choice, LimbKind kind,
                               const std::vector<NameHint>& hints) const;
    bool allowed(const std::vector<int>& path, const Limb& limb, LimbKind kind, bool& forced) const;
    std::vector<std::vector<int>> paths(int root) const;
    int sideOf(const Limb& limb) const;
    float wayTo(const Limb& limb, int attach) const;

    const BoneTree& tree_;
    const KnownRoles& known_;
    std::vector<int> roots_;
    std::array<std::vector<std::vector<Limb>>, kLimbKinds> fitted_;  ///< by root
};

}  // namespace ragtop
