#pragma once

#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "ragtop/scene.h"

namespace ragtop::stability {

/// How a body moves: the pose of its definition's frame, the velocities of its centre of mass in world axes.
struct BodyMotion {
    Pose pose;
    Vec3 v;  ///< m/s
    Vec3 w;  ///< rad/s
};

/// What the first body of a joint does to the second, in world axes.
struct Reaction {
    Vec3 force;   ///< N
    Vec3 torque;  ///< N m, about the joint's point
};

/// Thrown by an adapter whose engine cannot represent something in a scene: the case is skipped for that engine.
struct Unsupported : std::runtime_error {
    using std::runtime_error::runtime_error;
};
/// Thrown where this program was built without what a case needs: the case is skipped, which is a failure where
/// everything should be there.
struct Missing : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A scene in one engine, with the engine's default settings, on one thread, never sleeping. Bodies are named by
/// their index in the scene.
class Engine {
public:
    virtual ~Engine() = default;
    virtual void step(double dt) = 0;
    virtual BodyMotion motion(int body) const = 0;
    virtual void setVelocity(int body, const Vec3& linear, const Vec3& angular) = 0;
    /// A force (N) at a point of the world, during the next step.
    virtual void push(int body, const Vec3& force, const DVec3& point) = 0;
    /// Puts another body into the scene and returns its index.
    virtual int add(const BodyDef&) { throw Unsupported("bodies that come later"); }
    virtual void remove(int body) = 0;
    /// Sum of the normal forces (N) between two bodies in the last step.
    virtual double normalForce(int a, int b) const = 0;
    /// Mean of the last step, of a joint by its index in the scene.
    virtual Reaction reaction(int) const { throw Unsupported("forces of joints"); }
    /// What the engine itself reports to have gone wrong since the scene began, such as a full buffer or a reset.
    virtual std::string complaint() const { return {}; }
};

struct EngineKind {
    std::string name;
    /// Null where this program was built without it.
    std::unique_ptr<Engine> (*make)(const Scene& scene);
};

/// All there are; Ragtop is the first.
std::span<const EngineKind> engineKinds();

std::unique_ptr<Engine> makeRagtop(const Scene& scene);
std::unique_ptr<Engine> makeBullet(const Scene& scene);
/// With 50 iterations instead of ten.
std::unique_ptr<Engine> makeBullet50(const Scene& scene);
/// With four steps where the others make one.
std::unique_ptr<Engine> makeBullet240(const Scene& scene);
/// Bullet as the speeds of other engines were compared with: hulls with its margin around them, limited balls as its
/// six-axis springs with motors for friction, sleeping as the scene says. Takes bodies that come later.
std::unique_ptr<Engine> makeBulletYardstick(const Scene& scene);
std::unique_ptr<Engine> makeMujoco(const Scene& scene);
/// With its own trees of joints instead of equality constraints.
std::unique_ptr<Engine> makeMujocoTrees(const Scene& scene);
std::unique_ptr<Engine> makeOde(const Scene& scene);
std::unique_ptr<Engine> makeOdeExact(const Scene& scene);

}  // namespace ragtop::stability
