#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "ragtop/body.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"

namespace ragtop {

/// Changes to a world, recorded by a job and applied later by World::apply. Each job has its own buffer with its own
/// key. Keys, not threads, decide the order, so results are reproducible. The calls are those of World.
class CommandBuffer {
public:
    explicit CommandBuffer(std::uint64_t key) : key_(key) {}

    /// Returns the place in created() where the body's id is after World::apply.
    std::size_t create(BodyDef def);
    void destroy(BodyId body);
    void applyImpulse(BodyId body, const Vec3& impulse, const DVec3& point);
    void applyAngularImpulse(BodyId body, const Vec3& impulse);
    void setVelocity(BodyId body, const Vec3& linear, const Vec3& angular);
    void setPose(BodyId body, const Pose& pose);
    void wake(BodyId body);
    std::size_t create(JointDef def);
    void destroy(JointId joint);

    std::uint64_t key() const { return key_; }
    /// Ids of what was created by the last World::apply, in the order of the calls; null where one threw.
    const std::vector<BodyId>& created() const { return created_; }
    const std::vector<JointId>& createdJoints() const { return createdJoints_; }
    void clear();  ///< forgets all commands, for the next frame

private:
    friend class World;
    struct CreateBody { BodyDef def; };
    struct DestroyBody { BodyId body; };
    struct Impulse { BodyId body; Vec3 impulse; DVec3 point; };
    struct AngularImpulse { BodyId body; Vec3 impulse; };
    struct SetVelocity { BodyId body; Vec3 linear, angular; };
    struct SetPose { BodyId body; Pose pose; };
    struct Wake { BodyId body; };
    struct CreateJoint { JointDef def; };
    struct DestroyJoint { JointId joint; };
    using Command = std::variant<CreateBody, DestroyBody, Impulse, AngularImpulse, SetVelocity, SetPose, Wake,
                                 CreateJoint, DestroyJoint>;

    std::uint64_t key_;
    std::size_t bodyCount_ = 0, jointCount_ = 0;
    std::vector<Command> commands_;
    std::vector<BodyId> created_;
    std::vector<JointId> createdJoints_;
};

}  // namespace ragtop
