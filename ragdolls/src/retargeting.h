#pragma once

#include <array>
#include <optional>
#include <vector>

#include "leg.h"
#include "planted_feet.h"
#include "ragtop/retarget.h"
#include "role_mapping.h"

namespace ragtop {

/// One clip on its way to another body. What is not said to be in model space is seen along the heading of its body: x
/// to the left, y up, z forwards.
class Retargeting {
public:
    Retargeting(const Clip& clip, const RagdollDef& from, const RagdollDef& to, const RetargetOptions& options);
    Retargeted run();

private:
    struct Moment {
        std::vector<Pose> source{};  ///< bones of the clip's body, in its model space
        std::vector<Quat> parts{};   ///< turns of the parts, in model space
        Vec3 hips{};                 ///< m
    };
    /// Where a foot is to be.
    struct Hold {
        Vec3 ankle{};                     ///< m
        bool heel = false, ball = false;  ///< what of it stands
    };
    using Holds = std::array<std::vector<Hold>, 2>;
    /// How far a leg gets.
    struct Reached {
        Quat thigh{}, shank{}, foot{};  ///< in model space
        float miss = 0;                 ///< m, from what is to stand to where it is
    };

    float step() const;
    int window() const;
    LocalPose sampled(float time, const Pose& placement) const;
    bool repeats(Frame& again) const;
    void readClip();
    void place(const Moment& moment);
    Vec3 sourcePoint(const Moment& moment, int part, const Vec3& point) const;
    Vec3 pointNow(int part, const Vec3& point) const;
    FootWay sourceWay(std::size_t side) const;
    FootWay ownWay(std::size_t side);
    void findGround();
    void moveHips();
    Clip write();

    bool haveFeet() const;
    bool holdsFeet() const;
    int holdFeet();
    std::vector<Hold> holdsOf(std::size_t side, const Vec3& ground, int& stances);
    void lowerHips(const Holds& holds);
    template <class Misses>
    float leastDrop(Misses misses) const;
    Vec3 standsOn(const FootPoints& foot, const Hold& hold, const Quat& turn) const;
    Reached reached(const Moment& moment, const Leg& leg, std::size_t side, const Hold& hold, float lower) const;

    const Clip& clip_;
    const RetargetOptions& options_;
    RetargetBody from_, to_;
    RoleMapping mapping_;
    std::vector<Moment> moments_;
    std::vector<Frame> bones_;  ///< in model space, where `place` has put them
    std::array<std::optional<Leg>, 2> legs_;
    std::array<FootWay, 2> sourceWays_;
    std::vector<float> sourceHeights_;  ///< m, of the lower foot over the ground
    int steps_ = 0;                     ///< between the keys of the clip
    int before_ = 0;                    ///< moments before its beginning
    float scale_ = 1, sourceGround_ = 0;
};

}  // namespace ragtop
