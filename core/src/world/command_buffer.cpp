#include "ragtop/command_buffer.h"

#include <utility>

namespace ragtop {

std::size_t CommandBuffer::create(BodyDef def) {
    commands_.emplace_back(CreateBody{std::move(def)});
    return bodyCount_++;
}

void CommandBuffer::destroy(BodyId body) { commands_.emplace_back(DestroyBody{body}); }

void CommandBuffer::applyImpulse(BodyId body, const Vec3& impulse, const DVec3& point) {
    commands_.emplace_back(Impulse{body, impulse, point});
}

void CommandBuffer::applyAngularImpulse(BodyId body, const Vec3& impulse) {
    commands_.emplace_back(AngularImpulse{body, impulse});
}

void CommandBuffer::setVelocity(BodyId body, const Vec3& linear, const Vec3& angular) {
    commands_.emplace_back(SetVelocity{body, linear, angular});
}

void CommandBuffer::setPose(BodyId body, const Pose& pose) { commands_.emplace_back(SetPose{body, pose}); }

void CommandBuffer::wake(BodyId body) { commands_.emplace_back(Wake{body}); }

std::size_t CommandBuffer::create(JointDef def) {
    commands_.emplace_back(CreateJoint{std::move(def)});
    return jointCount_++;
}

void CommandBuffer::destroy(JointId joint) { commands_.emplace_back(DestroyJoint{joint}); }

void CommandBuffer::clear() {
    commands_.clear();
    created_.clear();
    createdJoints_.clear();
    bodyCount_ = 0;
    jointCount_ = 0;
}

}  // namespace ragtop
