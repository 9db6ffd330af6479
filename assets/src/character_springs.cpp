#include "character_springs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "import_text.h"

namespace ragtop {
namespace {

constexpr double kFrame = 1.0 / 60;  ///< s, at which VRM's numbers are tuned
constexpr double kMostDrag = 0.999;  ///< a motion that is lost at once has no rate
constexpr float kSlowest = 0.05f, kFastest = 30, kMostDamping = 10, kMostSag = 1.5f;  ///< bounds of SpringChain

struct Oscillator {
    float frequency, dampingRatio;
};

Oscillator oscillatorOf(const ImportedSpring& spring, double length) {
    const double kept = 1 - std::min(static_cast<double>(spring.drag), kMostDrag);
    const double decay = -0.5 * std::log(kept);  // ζ ω dt
    const double pull = kFrame * static_cast<double>(spring.stiffness) / length;
    const double cosine = std::max((1 + kept - pull) / (2 * std::sqrt(kept)), -1.0);
    const double turn = cosine <= 1 ? std::acos(cosine) : std::acosh(cosine);
    const double squared = decay * decay + (cosine <= 1 ? turn * turn : -turn * turn);
    const double omega = std::sqrt(std::max(squared, 0.0)) / kFrame;
    const auto frequency = std::clamp(static_cast<float>(omega) / (2 * kPi), kSlowest, kFastest);
    return {frequency, std::min(static_cast<float>(decay / kFrame) / (2 * kPi * frequency), kMostDamping)};
}

class SpringMaker {
public:
    explicit SpringMaker(ImportedCharacter& imported)
        : imported_(imported), globals_(globalTransforms(imported.scene)) {}

    SpringBonesDef make() {
        for (const ImportedSpring& spring : imported_.scene.springs.bones) addBone(spring);
        for (const ImportedSpringCollider& collider : imported_.scene.springs.colliders) addCollider(collider);
        if (imported_.scene.springs.grouped && !def_.colliders.empty())
            warn("groups of colliders of springs are left out: all colliders stop all bones");
        return keepUsable();
    }

private:
    void warn(std::string text) { imported_.character.warnings.push_back(std::move(text)); }
    Frame frameOf(std::int32_t node) const { return rigidPart(globals_[static_cast<std::size_t>(node)]); }
    float unit() const { return imported_.character.metersPerUnit; }
    /// A node's place in the bone that carries it.
    Vec3 placeIn(std::int32_t above, std::int32_t node) const {
        return unit() * inverseTransformPoint(frameOf(above), globals_[static_cast<std::size_t>(node)].shift);
    }
    int boneOf(std::int32_t node) const { return imported_.boneOf[static_cast<std::size_t>(node)]; }

    void addBone(const ImportedSpring& spring) {
        if (boneOf(spring.node) < 0) return warn("a spring of a node that moves no skin is left out");
        SpringChain chain{.first = boneOf(spring.node), .last = boneOf(spring.node)};
        chain.tip = placeIn(spring.node, spring.end);
        const float length = ragtop::length(chain.tip);
        if (!(length > 1e-6f)) return warn("a spring without length is left out");
        if (!(spring.stiffness > 0)) return warn("a spring without stiffness is left out");
        const Oscillator oscillator = oscillatorOf(spring, static_cast<double>(length));
        chain.frequency = oscillator.frequency;
        chain.dampingRatio = oscillator.dampingRatio;
        chain.sag = std::min(std::atan(spring.gravityPower / spring.stiffness), kMostSag);
        chain.inertia = spring.centered ? 0.0f : 1.0f;
        chain.radius = spring.hitRadius;
        if (spring.gravityPower > 0 && dot(normalized(spring.gravity), {0, -1, 0}) < 0.99f)
            warn("the gravity of a spring that does not pull down is taken for one that does");
        def_.chains.push_back(chain);
    }

    void addCollider(const ImportedSpringCollider& collider) {
        if (!(collider.radius > 0)) return warn("a collider of springs without size is left out");
        std::int32_t carrier = collider.node;
        while (carrier >= 0 && boneOf(carrier) < 0)
            carrier = imported_.scene.nodes[static_cast<std::size_t>(carrier)].parent;
        SpringCollider made{.bone = carrier < 0 ? -1 : boneOf(carrier)};
        const Affine& node = globals_[static_cast<std::size_t>(collider.node)];
        const auto place = [&](const Vec3& point) {
            const Vec3 inScene = transformPoint(node, point);
            return unit() * (carrier < 0 ? inScene : inverseTransformPoint(frameOf(carrier), inScene));
        };
        const Vec3 from = place(collider.from), to = place(collider.to);
        const float reach = length(to - from);
        made.frame.position = 0.5f * (from + to);
        if (reach > 0) made.frame.rotation = rotationBetween({0, 1, 0}, (1 / reach) * (to - from));
        const float radius = unit() * collider.radius;
        if (reach > 0)
            made.shape = Capsule{radius, reach / 2};
        else
            made.shape = Sphere{radius};
        def_.colliders.push_back(made);
    }

    /// Chains and colliders that SpringBones refuses are left out one by one, from the last.
    SpringBonesDef keepUsable() {
        const Skeleton& skeleton = imported_.character.skeleton;
        SpringBonesDef kept;
        for (const SpringChain& chain : def_.chains) {
            kept.chains.push_back(chain);
            if (const std::string wrong = whyInvalid(kept, skeleton); !wrong.empty()) {
                kept.chains.pop_back();
                warn("a spring is left out: " + wrong);
            }
        }
        for (const SpringCollider& collider : def_.colliders) {
            kept.colliders.push_back(collider);
            if (const std::string wrong = whyInvalid(kept, skeleton); !wrong.empty()) {
                kept.colliders.pop_back();
                warn("a collider of springs is left out: " + wrong);
            }
        }
        return kept;
    }

    ImportedCharacter& imported_;
    std::vector<Affine> globals_;
    SpringBonesDef def_;
};

}  // namespace

SpringBonesDef makeSprings(ImportedCharacter& imported) {
    if (imported.scene.springs.bones.empty()) return {};
    return SpringMaker(imported).make();
}

}  // namespace ragtop
