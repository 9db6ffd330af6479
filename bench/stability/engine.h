#pragma once

#include <functional>
#include <memory>
#include <optional>
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

/// All cars of a scene together, with what carries their wheels.
struct CarSums {
    double mass = 0;                    ///< kg
    double kinetic = 0, potential = 0;  ///< J; potential is −Σ m g·x
    double held = 0;                    ///< J, of springs, squashed tires and what turns
    double work = 0;                    ///< J, of engines, net of what resists in them
    double fastest = 0;                 ///< m/s
    DVec3 momentum;                     ///< kg m/s
    double way = 0;                     ///< kg m/s, Σ m |v|
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

/// What the last step had to do.
struct StepWork {
    int contacts = 0;  ///< contact points that the engine solved
    int passes = 0;    ///< over the constraints, or iterations of Newton's method, in all substeps
    /// Processor time, ms, where the engine measures its own; otherwise whoever steps it measures.
    std::optional<double> cpuMs{};
};

/// A scene in one engine, with the engine's default settings unless its maker says otherwise, on one thread, never
/// sleeping. Bodies are named by their index in the scene.
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
    /// Of cars, by their index in the scene; they do what its scripts say.
    virtual CarSums cars() const { throw Unsupported("cars"); }
    virtual BodyMotion car(int) const { throw Unsupported("cars"); }
    virtual void layCar(int, const BodyMotion&) { throw Unsupported("cars"); }
    virtual void remove(int body) = 0;
    /// Sum of the normal forces (N) between two bodies in the last step.
    virtual double normalForce(int a, int b) const = 0;
    /// Mean of the last step, of a joint by its index in the scene.
    virtual Reaction reaction(int) const { throw Unsupported("forces of joints"); }
    virtual StepWork work() const { return {}; }
    /// What the engine itself reports to have gone wrong since the scene began, such as a full buffer or a reset.
    virtual std::string complaint() const { return {}; }
};

using MakeEngine = std::function<std::unique_ptr<Engine>(const Scene& scene)>;

struct EngineKind {
    std::string name;
    /// Null where this program was built without it.
    MakeEngine make;
};

/// All there are; Ragtop is the first.
std::span<const EngineKind> engineKinds();

// What a chart varies of each engine; 0 is the engine's own default.

struct RagtopOptions {
    int substeps = 0;
    SolverChoice solver = SolverChoice::automatic;
};
std::unique_ptr<Engine> makeRagtop(const Scene& scene, const RagtopOptions& options = {});

enum class BulletSolver {
    sequential,  ///< sequential impulses, Bullet's default
    nncg,        ///< nonlinear nonsmooth conjugate gradients
};
struct BulletOptions {
    int substeps = 1;  ///< steps where the others make one
    int iterations = 10;
    BulletSolver solver = BulletSolver::sequential;
    /// As the speeds of other engines were compared with: hulls with a margin around them, limited balls as six-axis
    /// springs with motors for friction, sleeping as the scene says. Takes bodies that come later.
    bool yardstick = false;
};
std::unique_ptr<Engine> makeBullet(const Scene& scene, const BulletOptions& options = {});
std::unique_ptr<Engine> makeBulletDouble(const Scene& scene, const BulletOptions& options = {});
/// Joints in reduced coordinates; of the options the solver and the yardstick do not count.
std::unique_ptr<Engine> makeBulletMultibody(const Scene& scene, const BulletOptions& options = {});
std::string bulletVersion();

enum class MujocoJoints {
    equalities,  ///< every body is free, and joints are equality constraints
    trees,       ///< bodies are nested in those they hang on; joints that close loops are equality constraints
};
enum class MujocoIntegrator { euler, rk4, implicit };
struct MujocoOptions {
    MujocoJoints joints = MujocoJoints::equalities;
    MujocoIntegrator integrator = MujocoIntegrator::euler;
    bool pyramids = false;  ///< friction in a pyramid, MuJoCo's default, instead of a cone
    int substeps = 0;       ///< by default steps of about 2 ms, MuJoCo's own
    int iterations = 0;     ///< at most, of Newton's method; by default 100
};
std::unique_ptr<Engine> makeMujoco(const Scene& scene, const MujocoOptions& options = {});
std::string mujocoVersion();

struct OdeOptions {
    bool exact = false;   ///< the pivoting solver instead of sweeps
    int substeps = 1;     ///< steps where the others make one
    int iterations = 20;  ///< sweeps of the quick step
};
std::unique_ptr<Engine> makeOde(const Scene& scene, const OdeOptions& options = {});
std::string odeVersion();

struct DartOptions {
    bool sweeps = false;  ///< projected Gauss-Seidel instead of Dantzig's pivoting
    int iterations = 30;  ///< sweeps
};
std::unique_ptr<Engine> makeDart(const Scene& scene, const DartOptions& options = {});
std::string dartVersion();

struct SimbodyOptions {
    int digits = 3;  ///< of accuracy, that its control of errors is asked for
};
std::unique_ptr<Engine> makeSimbody(const Scene& scene, const SimbodyOptions& options = {});
std::string simbodyVersion();

/// A program that speaks the protocol of docs/chart.md.
struct ProgramOptions {
    std::string command;  ///< for the shell
    int substeps = 1, iterations = 0;
    double patience = 10;  ///< s, that an answer may take
};
/// What a program says of itself, as JSON. Throws std::runtime_error where it does not.
std::string programHello(const std::string& command, double patience);
std::unique_ptr<Engine> makeProgram(const Scene& scene, const ProgramOptions& options);

}  // namespace ragtop::stability
