#include "saboteurs.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

namespace ragtop::stability {
namespace {

/// Ragtop as it is; saboteurs spoil one thing each.
class Wrapped : public Engine {
public:
    explicit Wrapped(const Scene& scene) : inner_(makeRagtop(scene)) {
        for (const SceneBody& body : scene.bodies) moving_.push_back(body.def.type == BodyType::dynamic);
    }
    void step(double dt) override { inner_->step(dt); }
    BodyMotion motion(int body) const override { return inner_->motion(body); }
    void setVelocity(int body, const Vec3& linear, const Vec3& angular) override {
        inner_->setVelocity(body, linear, angular);
    }
    void push(int body, const Vec3& force, const DVec3& point) override { inner_->push(body, force, point); }
    void remove(int body) override {
        moving_[static_cast<std::size_t>(body)] = false;
        inner_->remove(body);
    }
    double normalForce(int a, int b) const override { return inner_->normalForce(a, b); }
    Reaction reaction(int joint) const override { return inner_->reaction(joint); }

protected:
    const Engine& inner() const { return *inner_; }
    bool isMoving(int body) const { return moving_[static_cast<std::size_t>(body)]; }
    int count() const { return static_cast<int>(moving_.size()); }

private:
    std::unique_ptr<Engine> inner_;
    std::vector<bool> moving_;
};

class Frozen : public Wrapped {
public:
    using Wrapped::Wrapped;
    void step(double) override {}
};

class Nowhere : public Wrapped {
public:
    using Wrapped::Wrapped;
    void step(double dt) override {
        ++steps_;
        Wrapped::step(dt);
    }
    BodyMotion motion(int body) const override {
        BodyMotion motion = Wrapped::motion(body);
        constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
        if (steps_ > 3 && isMoving(body)) motion.pose.position = {kNan, kNan, kNan};
        return motion;
    }

private:
    int steps_ = 0;
};

class Drifting : public Wrapped {
public:
    using Wrapped::Wrapped;
    void step(double dt) override {
        time_ += dt;
        Wrapped::step(dt);
    }
    BodyMotion motion(int body) const override {
        BodyMotion motion = Wrapped::motion(body);
        if (isMoving(body)) motion.pose.position = motion.pose.position + 0.001 * time_ * direction(body);
        return motion;
    }

private:
    /// Along one of the eight diagonals.
    static DVec3 direction(int body) {
        const auto sign = [body](int bit) { return (body >> bit) % 2 == 0 ? 1.0 : -1.0; };
        return 1 / std::sqrt(3.0) * DVec3{sign(0), sign(1), sign(2)};
    }
    double time_ = 0;
};

class Energetic : public Wrapped {
public:
    using Wrapped::Wrapped;
    void step(double dt) override {
        Wrapped::step(dt);
        const float faster = static_cast<float>(std::sqrt(1 + 0.01 * dt));
        for (int body = 0; body < count(); ++body) {
            if (!isMoving(body)) continue;
            const BodyMotion now = motion(body);
            setVelocity(body, faster * now.v, faster * now.w);
        }
    }
};

class Late : public Wrapped {
public:
    using Wrapped::Wrapped;
    void step(double dt) override {
        before_.clear();
        for (int body = 0; body < count(); ++body)
            before_.push_back(isMoving(body) ? Wrapped::motion(body) : BodyMotion{});
        Wrapped::step(dt);
    }
    BodyMotion motion(int body) const override {
        return before_.empty() || !isMoving(body) ? Wrapped::motion(body) : before_[static_cast<std::size_t>(body)];
    }

private:
    std::vector<BodyMotion> before_;
};

template <class Kind>
std::unique_ptr<Engine> make(const Scene& scene) {
    return std::make_unique<Kind>(scene);
}

std::unique_ptr<Engine> makeHollow(const Scene& scene) {
    Scene spoiled = scene;
    for (SceneBody& body : spoiled.bodies)
        for (ShapeDef& shape : body.def.shapes) shape.filter.mask = 0;
    return makeRagtop(spoiled);
}

std::unique_ptr<Engine> makeTilted(const Scene& scene) {
    Scene spoiled = scene;
    spoiled.settings.gravity = rotate(rotationAbout({0.6f, 0, 0.8f}, kPi / 4), scene.settings.gravity);
    return makeRagtop(spoiled);
}

std::unique_ptr<Engine> makeWeightless(const Scene& scene) {
    Scene spoiled = scene;
    spoiled.settings.gravity = {};
    return makeRagtop(spoiled);
}

/// Takes dry friction and what bearings have from all parts of a joint.
struct Smoothing {
    template <class Part>
    void operator()(const Tunable& tunable, Part& part) {
        if constexpr (std::is_same_v<Part, float>) {
            if (tunable.name == "friction") part = 0;
        } else if constexpr (std::is_same_v<Part, std::optional<Bearing>>) {
            part.reset();
        } else if constexpr (std::is_same_v<Part, AxisDef>) {
            smooth(part);
        }
    }
    template <class Part>
    void smooth(Part& part) {
        describe(*this, part, static_cast<const Part*>(nullptr));
    }
};

std::unique_ptr<Engine> makeFrictionless(const Scene& scene) {
    Scene spoiled = scene;
    for (SceneBody& body : spoiled.bodies)
        for (ShapeDef& shape : body.def.shapes) shape.material.friction = 0;
    for (SceneJoint& joint : spoiled.joints) std::visit([](auto& def) { Smoothing{}.smooth(def); }, joint.def);
    return makeRagtop(spoiled);
}

/// Takes the limits from all parts of a joint.
struct Unlimiting {
    template <class Part>
    void operator()(const Tunable&, Part& part) {
        if constexpr (std::is_same_v<Part, std::optional<Range>>)
            part.reset();
        else if constexpr (std::is_same_v<Part, AxisDef>)
            unlimit(part);
    }
    template <class Part>
    void unlimit(Part& part) {
        describe(*this, part, static_cast<const Part*>(nullptr));
    }
};

std::unique_ptr<Engine> makeLimitless(const Scene& scene) {
    Scene spoiled = scene;
    for (SceneJoint& joint : spoiled.joints) std::visit([](auto& def) { Unlimiting{}.unlimit(def); }, joint.def);
    return makeRagtop(spoiled);
}

}  // namespace

std::span<const EngineKind> saboteurKinds() {
    static const std::array kinds{
        EngineKind{"hollow", makeHollow},
        EngineKind{"tilted", makeTilted},
        EngineKind{"frozen", make<Frozen>},
        EngineKind{"weightless", makeWeightless},
        EngineKind{"frictionless", makeFrictionless},
        EngineKind{"drifting", make<Drifting>},
        EngineKind{"energetic", make<Energetic>},
        EngineKind{"late", make<Late>},
        EngineKind{"limitless", makeLimitless},
        EngineKind{"nan", make<Nowhere>},
    };
    return kinds;
}

}  // namespace ragtop::stability
