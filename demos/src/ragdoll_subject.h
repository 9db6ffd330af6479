#pragma once

#include <optional>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "ragtop/clip.h"
#include "ragtop/ragdoll.h"
#include "ragtop/robot.h"
#include "ragtop/skeleton.h"
#include "ragtop/world.h"

namespace ragtop::demos {

/// A ragdoll or robot that is put to the test.
struct RagdollSubject {
    std::string name;
    std::variant<RagdollDef, Robot> def;
    std::string body{};   ///< of a character: what it was taken for, as JSON
    Skeleton skeleton{};  ///< of a character, with its animations
    std::vector<Clip> clips{};
    bool holding = false;  ///< a robot's servos hold every joint where it begins
};

/// A ragdoll file, a character or a robot description. Throws AssetError.
RagdollSubject loadRagdollSubject(const std::string& asset);

/// The subject in a world of its own.
struct RagdollStage {
    World world;
    std::optional<Ragdoll> ragdoll;
    std::vector<BodyId> bodies;      ///< that move, those of the definition in its order
    std::vector<std::string> names;  ///< of bodies
    std::vector<JointId> joints;
    std::vector<std::string> jointNames;

    /// The origin of the subject's model at `placement`.
    RagdollStage(const RagdollSubject& subject, const Pose& placement, const WorldSettings& settings = {});
    RagdollStage(const RagdollStage&) = delete;
    RagdollStage& operator=(const RagdollStage&) = delete;
    void addGround();

    double mass() const;
    DVec3 centerOfMass() const;
    DVec3 momentum() const;                 ///< kg m/s
    DVec3 angularMomentum() const;          ///< kg m²/s, about the centre of mass
    double meanSquareSpeed() const;         ///< m²/s², of the centres of all bodies
    double lowestPoint() const;             ///< m, of all shapes
    double reach(const DVec3& from) const;  ///< m, to the farthest corner of the bounds of a shape
    bool asleep() const;
    /// What one would push: the chest, else the heaviest body.
    std::size_t chest() const;
    /// What one would hold it by: hands and feet, else bodies that carry no other one.
    std::vector<std::size_t> holds() const;

private:
    void place(const RagdollDef& def, const Pose& placement);
    void place(const Robot& robot, const Pose& placement, bool holding);
};

/// Any rotation, all of them as likely.
Quat anyRotation(std::mt19937& random);
/// In [−1, 1).
float anyNumber(std::mt19937& random);

}  // namespace ragtop::demos
