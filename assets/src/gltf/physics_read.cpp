#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <set>
#include <utility>

#include "described_file.h"
#include "gltf/node_tree.h"
#include "gltf/physics_document.h"
#include "gltf/physics_format.h"
#include "gltf/physics_joints.h"
#include "gltf/physics_shapes.h"
#include "import_text.h"

namespace ragtop {
namespace {

constexpr float kUsualDensity = 1000;  ///< kg/m³, of bodies without a mass
constexpr float kBareRadius = 0.01f;   ///< m, of bodies without a collider

/// A joint of the file and the bodies that it joins.
struct Link {
    int node = -1, from = -1, to = -1;  ///< nodes: of the joint, and the two bodies
};

class PhysicsReader {
public:
    PhysicsReader(const JsonValue& json, const GltfFile& file, const MeshPoints& points)
        : json_(json),
          file_(file),
          points_(points),
          tree_(file.nodes, json),
          order_(nodeOrder(tree_, file.nodes.size())) {}

    RagdollFromGltf read() {
        for (const int node : order_) collect(node);
        if (bodies_.empty())
            throw AssetError(json_.place().file, "",
                             "has no node with \"motion\" of KHR_physics_rigid_bodies, must have one "
                             "to be a ragdoll");
        for (const int node : order_) collectLink(node);
        orderBodies();
        collectBones();
        for (const int body : result_.parts) addPart(body);
        addJoints();
        ignorePairs();
        for (const int node : result_.bones) addBone(node);
        if (static_ > 0) warn(std::to_string(static_) + " colliders of no body are left out");
        if (triggers_ > 0) warn(std::to_string(triggers_) + " triggers are left out");
        result_.warnings = counted(result_.warnings);
        return std::move(result_);
    }

private:
    const GltfNode& node(int index) const { return file_.nodes[static_cast<std::size_t>(index)]; }
    const GltfNodePhysics* physics(int index) const {
        const std::optional<GltfNodePhysics>& found = node(index).extensions.physics;
        return found ? &*found : nullptr;
    }
    bool moves(int index) const { return physics(index) && physics(index)->motion; }
    int bodyOf(int index) const {
        return tree_.nearest(index, [&](int at) { return moves(at); });
    }
    JsonValue at(int index) const { return json_.at("nodes").at(static_cast<std::size_t>(index)); }
    JsonValue inPhysics(int index, const char* what) const {
        return at(index).at("extensions").at(std::string(kGltfPhysics)).at(what);
    }
    std::string called(int index) const {
        return node(index).name.empty() ? "node " + std::to_string(index) : "'" + node(index).name + "'";
    }
    void warn(std::string text) { result_.warnings.push_back(std::move(text)); }
    const Json* extras(const Json& of) const {
        if (!of.contains("extras") || !of["extras"].is_object() || !of["extras"].contains("ragtop")) return nullptr;
        return &of["extras"]["ragtop"];
    }

    void collect(int index) {
        const GltfNodePhysics* here = physics(index);
        if (!here) return;
        if (here->motion) bodies_.push_back(index);
        if (at(index).at("extensions").at(std::string(kGltfPhysics)).has("trigger")) ++triggers_;
        if (!here->collider) return;
        const int body = bodyOf(index);
        if (body < 0)
            ++static_;
        else
            colliders_[body].push_back(index);
    }

    void collectLink(int index) {
        const GltfNodePhysics* here = physics(index);
        if (!here || !here->joint) return;
        const GltfNodeJoint& joint = *here->joint;
        if (static_cast<std::size_t>(joint.connectedNode) >= file_.nodes.size())
            inPhysics(index, "joint")
                .at("connectedNode")
                .fail("is " + std::to_string(joint.connectedNode) + ", must be one of " +
                      std::to_string(file_.nodes.size()) + " nodes");
        if (static_cast<std::size_t>(joint.joint) >= file_.extensions.physics.physicsJoints.size())
            inPhysics(index, "joint")
                .at("joint")
                .fail("is " + std::to_string(joint.joint) + ", must be one of " +
                      std::to_string(file_.extensions.physics.physicsJoints.size()) + " joints of the file");
        const Link link{index, bodyOf(index), bodyOf(joint.connectedNode)};
        if (link.from < 0 || link.to < 0)
            warn("a joint to the world is left out");
        else if (link.from == link.to)
            warn("a joint within one body is left out");
        else
            links_.push_back(link);
    }

    /// The list of nodes that the file gives for `what`, if it gives all of `known`.
    bool given(const char* what, std::vector<int> known, std::vector<int>& into) const {
        const Json* said = extras(json_.json());
        if (!said || !said->is_object() || !said->contains(what)) return false;
        std::vector<int> list;
        for (const Json& one : said->at(what))
            if (one.is_number_integer()) list.push_back(one.get<int>());
        into = list;
        std::sort(list.begin(), list.end());
        std::sort(known.begin(), known.end());
        if (list != known)
            json_.at("extras").at("ragtop").at(what).fail("is not the list of the " + std::to_string(known.size()) +
                                                          " nodes that it must order");
        return true;
    }

    /// From the first body along joints, then from the next one that is left.
    void orderBodies() {
        if (given("parts", bodies_, result_.parts)) return;
        std::map<int, std::vector<int>> beside;
        for (const Link& link : links_) beside[link.from].push_back(link.to), beside[link.to].push_back(link.from);
        std::set<int> met;
        for (const int first : bodies_) {
            std::deque<int> waiting;
            if (met.insert(first).second) waiting.push_back(first);
            for (; !waiting.empty(); waiting.pop_front()) {
                result_.parts.push_back(waiting.front());
                for (const int next : beside[waiting.front()])
                    if (met.insert(next).second) waiting.push_back(next);
            }
        }
    }

    /// Bodies, and nodes that the file says are bones beside them.
    void collectBones() {
        std::vector<int> bones = result_.parts;
        for (const int index : order_) {
            const Json* said = extras(at(index).json());
            if (said && said->contains("bone") && !moves(index) && bodyOf(index) >= 0) bones.push_back(index);
        }
        if (!given("bones", bones, result_.bones)) result_.bones = std::move(bones);
        for (std::size_t i = 0; i < result_.bones.size(); ++i) boneOf_[result_.bones[i]] = static_cast<int>(i);
        for (std::size_t i = 0; i < result_.parts.size(); ++i) partOf_[result_.parts[i]] = static_cast<int>(i);
    }

    void addPart(int body) {
        RagdollPart part{.name = nameOfBone(body), .bone = boneOf_.at(body), .bind = tree_.inScene(body)};
        const GltfMotion& motion = *physics(body)->motion;
        const std::vector<int>& colliders = colliders_[body];
        if (colliders.empty()) {
            part.shape = Sphere{kBareRadius};
            warn("a body has no collider: it is a ball of 1 cm");
        } else {
            BodyShape shape = shapeOfBody(file_, tree_, json_, points_, body, colliders);
            part.shape = std::move(shape.shape);
            part.frame = shape.frame;
            for (const std::string& lost : shape.lost) warn("a body " + lost);
            addSurface(part, colliders.front());
        }
        const bool weighs = motion.mass && *motion.mass > 0;
        part.mass = weighs ? *motion.mass : massOf(part.shape, kUsualDensity).mass;
        if (!weighs) warn("a body has no mass: it is that of its shape in water");
        if (motion.isKinematic) warn("a body that nothing moves is taken for one that moves");
        if (motion.centerOfMass || motion.inertiaDiagonal) warn("centre and moments of a body are those of its shape");
        if (motion.linearVelocity || motion.angularVelocity) warn("the velocity of a body is left out");
        if (motion.gravityFactor != 1) warn("the gravity factor of a body is left out");
        result_.def.parts.push_back(std::move(part));
    }

    std::string nameOfBone(int index) {
        std::string name = node(index).name.empty() ? "node " + std::to_string(index) : node(index).name;
        const int copies = ++names_[name];
        return copies == 1 ? name : name + " (" + std::to_string(copies) + ")";
    }

    static CombineRule ruleOf(GltfCombine rule) {
        return rule == GltfCombine::average   ? CombineRule::average
               : rule == GltfCombine::minimum ? CombineRule::minimum
               : rule == GltfCombine::maximum ? CombineRule::maximum
                                              : CombineRule::product;
    }

    template <class T>
    const T& indexed(int index, const char* what, int wanted, const std::vector<T>& all) const {
        if (static_cast<std::size_t>(wanted) >= all.size())
            inPhysics(index, "collider")
                .at(what)
                .fail("is " + std::to_string(wanted) + ", must be one of " + std::to_string(all.size()));
        return all[static_cast<std::size_t>(wanted)];
    }

    void addSurface(RagdollPart& part, int index) {
        const GltfCollider& collider = *physics(index)->collider;
        if (collider.physicsMaterial) {
            const GltfMaterial& from =
                indexed(index, "physicsMaterial", *collider.physicsMaterial, file_.extensions.physics.physicsMaterials);
            part.material.friction = from.staticFriction;
            part.material.slidingShare =
                from.staticFriction > 0 ? std::min(from.dynamicFriction / from.staticFriction, 1.0f) : 1.0f;
            part.material.restitution = from.restitution;
            part.material.frictionRule = ruleOf(from.frictionCombine);
            part.material.restitutionRule = ruleOf(from.restitutionCombine);
        }
        if (collider.collisionFilter)
            filters_[result_.def.parts.size()] = &indexed(index, "collisionFilter", *collider.collisionFilter,
                                                          file_.extensions.physics.collisionFilters);
    }

    /// What its filter says that a part does not meet.
    static bool excludes(const GltfFilter& filter, const GltfFilter* other) {
        const auto names = [&](const std::vector<std::string>& systems) {
            return other && std::any_of(systems.begin(), systems.end(), [&](const std::string& system) {
                       const std::vector<std::string>& of = other->collisionSystems;
                       return std::find(of.begin(), of.end(), system) != of.end();
                   });
        };
        if (!filter.collideWithSystems.empty()) return !names(filter.collideWithSystems);
        return names(filter.notCollideWithSystems);
    }

    /// Filters hold between the parts; of what else there is in the file they say nothing to us.
    void ignorePairs() {
        RagdollDef& def = result_.def;
        const auto filterOf = [&](std::size_t part) -> const GltfFilter* {
            const auto found = filters_.find(part);
            return found == filters_.end() ? nullptr : found->second;
        };
        bool all = def.parts.size() > 1;
        for (std::size_t i = 0; i < def.parts.size(); ++i)
            for (std::size_t j = i + 1; j < def.parts.size(); ++j) {
                const GltfFilter *a = filterOf(i), *b = filterOf(j);
                const bool apart = (a && excludes(*a, b)) || (b && excludes(*b, a));
                all &= apart;
                const RagdollPair pair{static_cast<int>(i), static_cast<int>(j)};
                if (apart && !ignoreEachOther(def, pair.first, pair.second)) def.ignored.push_back(pair);
            }
        if (!all) return;
        def.selfCollision = false;
        def.ignored.clear();
    }

    void addJoints() {
        std::map<int, std::pair<Link, bool>> carriedBy;  // by the part that is carried; true: the joint is turned round
        for (const Link& link : links_) {
            int parent = partOf_.at(link.from), child = partOf_.at(link.to);
            const bool turned = parent > child;
            if (turned) std::swap(parent, child);
            if (!carriedBy.try_emplace(child, link, turned).second) warn("a joint that closes a loop is left out");
        }
        std::vector<int> known, wanted;
        std::map<int, int> childOf;
        for (const auto& [child, carried] : carriedBy)
            known.push_back(carried.first.node), childOf[known.back()] = child;
        if (!given("joints", known, wanted)) wanted = known;
        for (const int index : wanted) addJoint(childOf.at(index), carriedBy.at(childOf.at(index)));
        result_.joints = std::move(wanted);
        const std::size_t loose = result_.parts.size() - carriedBy.size() - 1;
        if (loose > 0) warn(std::to_string(loose) + " bodies hang on no joint");
    }

    void addJoint(int child, const std::pair<Link, bool>& carried) {
        const auto& [link, turned] = carried;
        const GltfNodeJoint& said = *physics(link.node)->joint;
        const GltfJoint& file = file_.extensions.physics.physicsJoints[static_cast<std::size_t>(said.joint)];
        JointFromGltf made = jointFromGltf(turned ? reversed(file) : file);
        for (const std::string& lost : made.lost) warn("a joint has " + lost);
        const auto frame = [&](int index, int body) {
            Frame in = tree_.within(index, body);
            in.position = scale(tree_.scaleWithin(body), in.position);
            if (made.turn != Quat{}) in.rotation = normalized(in.rotation * made.turn);
            return in;
        };
        Frame a = frame(link.node, link.from), b = frame(said.connectedNode, link.to);
        if (turned) std::swap(a, b);
        std::visit([&](auto& kind) { kind.bodies = {.frameA = a, .frameB = b, .collide = said.enableCollision}; },
                   made.joint);
        const int parent = partOf_.at(turned ? link.to : link.from);
        parentOf_[child] = parent;
        result_.def.joints.push_back({parent, child, std::move(made.joint)});
    }

    void addBone(int index) {
        const int body = bodyOf(index), part = partOf_.at(body), own = boneOf_.at(index);
        RagdollBone bone{.part = part};
        if (index == body) {
            bone.name = result_.def.parts[static_cast<std::size_t>(part)].name;
            const auto above = parentOf_.find(part);
            if (above != parentOf_.end())
                bone.parent = boneOf_.at(result_.parts[static_cast<std::size_t>(above->second)]);
        } else {
            bone.name = nameOfBone(index);
            bone.inPart = tree_.within(index, body);
            bone.inPart.position = scale(tree_.scaleWithin(body), bone.inPart.position);
            bone.parent = boneOf_.at(tree_.nearest(tree_.parent(index), [&](int at) { return boneOf_.contains(at); }));
        }
        if (bone.parent >= own) bone.parent = -1;
        result_.def.bones.push_back(std::move(bone));
    }

    const JsonValue& json_;
    const GltfFile& file_;
    const MeshPoints& points_;
    GltfTree tree_;
    std::vector<int> order_, bodies_;
    std::vector<Link> links_;
    std::map<int, std::vector<int>> colliders_;
    std::map<std::size_t, const GltfFilter*> filters_;  ///< by part
    std::map<int, int> boneOf_, partOf_, parentOf_;
    std::map<std::string, int> names_;
    int static_ = 0, triggers_ = 0;
    RagdollFromGltf result_;
};

}  // namespace

namespace {

void checkLimits(const GltfFile& file, const JsonValue& json) {
    const std::vector<GltfJoint>& joints = file.extensions.physics.physicsJoints;
    for (std::size_t i = 0; i < joints.size(); ++i)
        for (std::size_t k = 0; k < joints[i].limits.size(); ++k) {
            const GltfLimit& limit = joints[i].limits[k];
            if (!limit.min || !limit.max || *limit.min <= *limit.max) continue;
            json.at("extensions")
                .at(std::string(kGltfPhysics))
                .at("physicsJoints")
                .at(i)
                .at("limits")
                .at(k)
                .at("min")
                .fail(fmt::format("is {}, must be at most \"max\", {}", *limit.min, *limit.max));
        }
}

}  // namespace

bool hasGltfPhysics(const JsonDocument& gltf) {
    const Json& root = gltf.root();
    if (!root.is_object() || !root.contains("nodes") || !root["nodes"].is_array()) return false;
    const Json::json_pointer motion("/extensions/" + std::string(kGltfPhysics) + "/motion");
    return std::any_of(root["nodes"].begin(), root["nodes"].end(),
                       [&](const Json& node) { return node.contains(motion); });
}

RagdollFromGltf readGltfPhysics(const JsonDocument& gltf, const MeshPoints& points) {
    const JsonValue json(gltf);
    const auto file = readOpenDocument<GltfFile>(gltf);
    checkLimits(file, json);
    RagdollFromGltf read = PhysicsReader(json, file, points).read();
    if (const std::string wrong = whyInvalid(read.def); !wrong.empty())
        throw AssetError(json.place().file, "", "makes no ragdoll: " + wrong);
    return read;
}

}  // namespace ragtop
