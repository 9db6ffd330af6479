#pragma once

#include <string>
#include <variant>
#include <vector>

#include "../engine.h"

/// What the adapters of other engines share. Their bodies live in the frame of the principal axes about the centre of
/// mass, which those engines want; definitions are in the body's own frame.
namespace ragtop::stability {

struct Inertial {
    double mass = 0;
    Vec3 moments{1, 1, 1};  ///< kg m², along the axes of `frame`
    Frame frame{};          ///< in the body's own; the identity for bodies that do not move by forces
};
Inertial inertialOf(const BodyDef& def);

/// Bodies of a scene as a peer sees them.
class PeerBodies {
public:
    explicit PeerBodies(const Scene& scene);
    void add(const BodyDef& def);

    int count() const { return static_cast<int>(defs_.size()); }
    const BodyDef& def(int body) const { return defs_[index(body)]; }
    const Inertial& inertial(int body) const { return inertials_[index(body)]; }
    Pose startPose(int body) const { return def(body).pose * inertial(body).frame; }
    /// A frame of the definition, seen from the peer's body; kWorld has the world's.
    Frame local(int body, const Frame& frame) const;
    /// The pose of the definition's frame, from that of the peer's body.
    Pose ownPose(int body, const Pose& peer) const { return peer * inverse(inertial(body).frame); }

private:
    static std::size_t index(int body) { return static_cast<std::size_t>(body); }
    std::vector<BodyDef> defs_;
    std::vector<Inertial> inertials_;
};

const JointBodies& bodiesOf(const JointDef& def);
/// Has the hinge only what every engine has: hard stops, and no friction but dry one?
bool isPlain(const HingeDef& hinge);

[[noreturn]] inline void refuse(const std::string& what) { throw Unsupported(what); }

}  // namespace ragtop::stability
