#include "character_import.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "axes.h"
#include "character_clips.h"
#include "character_springs.h"
#include "import_text.h"
#include "moving_nodes.h"

namespace ragtop {
namespace {

constexpr float kAgree = 1e-2f;  ///< relative difference of two maps that are meant to be the same

bool agree(const Affine& a, const Affine& b, float size) {
    const float scale = length(b.linear.cx) + length(b.linear.cy) + length(b.linear.cz);
    const float turn =
        length(a.linear.cx - b.linear.cx) + length(a.linear.cy - b.linear.cy) + length(a.linear.cz - b.linear.cz);
    return turn <= kAgree * scale && length(a.shift - b.shift) <= kAgree * size;
}

float extentOf(const std::vector<Vec3>& points) {
    if (points.empty()) return 0;
    Vec3 lower = points[0], upper = points[0];
    for (const Vec3& point : points) {
        lower = min(lower, point);
        upper = max(upper, point);
    }
    return length(upper - lower);
}

/// Builds the skeleton of a scene in the units and axes of the file.
class CharacterBuilder {
public:
    explicit CharacterBuilder(ImportedCharacter& into)
        : into_(into),
          scene_(into.scene),
          character_(into.character),
          globals_(globalTransforms(scene_)),
          bind_(globals_),
          skin_(scene_.nodes.size()),
          deforms_(scene_.nodes.size(), false) {
        into_.boneOf.assign(scene_.nodes.size(), -1);
    }

    void run() {
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i)
            if (!scene_.meshes[i].bones.empty()) addSkin(i);
        const bool skinned = std::find(deforms_.begin(), deforms_.end(), true) != deforms_.end();
        if (!skinned) useNodes();
        addBetween();
        collectBones(skinned);
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i)
            if (scene_.meshes[i].bones.empty()) addAttachments(i);
        warnAboutSkin();
    }

private:
    /// Where the rest pose of a mesh stands in the scene. If the nodes are at rest they say it: node = place · rest,
    /// which holds for every format. Where they are posed, only the node of the mesh is left to tell.
    Affine placeOf(const ImportedMesh& mesh) {
        const float size = extentOf(mesh.vertices);
        const Affine* first = nullptr;
        std::vector<Affine> places;
        std::string posed;
        for (const ImportedBone& bone : mesh.bones) {
            const bool moves = std::any_of(bone.weights.begin(), bone.weights.end(),
                                           [](const ImportedWeight& w) { return w.weight > 0; });
            if (bone.node < 0 || !moves) continue;
            places.push_back(globals_[static_cast<std::size_t>(bone.node)] * bone.offset);
            if (posed.empty() && !agree(places.back(), places.front(), size * length(places.front().linear.cx)))
                posed = bone.name;
        }
        if (!places.empty()) first = &places.front();
        if (first && posed.empty()) return *first;
        if (first && posedMeshes_++ == 0) firstPosed_ = "mesh '" + mesh.name + "' at '" + posed + "'";
        return mesh.nodes.empty() ? Affine{} : globals_[static_cast<std::size_t>(mesh.nodes.front())];
    }

    void addSkin(std::size_t index) {
        const ImportedMesh& mesh = scene_.meshes[index];
        const Affine place = placeOf(mesh);
        into_.pieces.push_back({index, place, -1});
        std::vector<float> sum(mesh.vertices.size(), 0.0f), most(mesh.vertices.size(), 0.0f);
        std::vector<int> owner(mesh.vertices.size(), -1), influences(mesh.vertices.size(), 0);
        for (const ImportedBone& bone : mesh.bones) {
            if (bone.node < 0) {
                if (homeless_++ == 0) firstHomeless_ = bone.name;
                continue;
            }
            bool moves = false;
            for (const ImportedWeight& w : bone.weights) {
                negative_ += w.weight < 0;
                if (!(w.weight > 0)) continue;
                moves = true;
                sum[w.vertex] += w.weight;
                ++influences[w.vertex];
                if (w.weight <= most[w.vertex]) continue;
                most[w.vertex] = w.weight;
                owner[w.vertex] = bone.node;
            }
            const auto node = static_cast<std::size_t>(bone.node);
            if (moves && !deforms_[node]) {
                deforms_[node] = true;
                bind_[node] = place * inverse(bone.offset);
            }
        }
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
            if (owner[i] < 0) continue;
            skin_[static_cast<std::size_t>(owner[i])].push_back(transformPoint(place, mesh.vertices[i]));
        }
        count(mesh, sum, influences);
    }

    /// Rigid pieces that hang on bones: helmets, eyes, hair. They keep their place on the bone.
    void addAttachments(std::size_t index) {
        for (const std::int32_t at : scene_.meshes[index].nodes) {
            int node = at;
            while (node >= 0 && !deforms_[static_cast<std::size_t>(node)])
                node = scene_.nodes[static_cast<std::size_t>(node)].parent;
            if (node < 0) continue;
            const auto bone = static_cast<std::size_t>(node);
            const Affine place = bind_[bone] * inverse(globals_[bone]) * globals_[static_cast<std::size_t>(at)];
            into_.pieces.push_back({index, place, into_.boneOf[bone]});
        }
    }

    void count(const ImportedMesh& mesh, const std::vector<float>& sum, const std::vector<int>& influences) {
        SkinInfo& skin = character_.skin;
        ++skin.meshes;
        skin.vertices += static_cast<int>(mesh.vertices.size());
        skin.triangles += static_cast<int>(mesh.triangles.size() / 3);
        for (std::size_t i = 0; i < sum.size(); ++i) {
            skin.influences = std::max(skin.influences, influences[i]);
            if (influences[i] == 0) {
                ++skin.unweighted;
                continue;
            }
            skin.renormalized += std::abs(sum[i] - 1.0f) > 1e-2f;
            skin.leastSum = std::min(skin.leastSum, sum[i]);
            skin.greatestSum = std::max(skin.greatestSum, sum[i]);
        }
    }

    void warnAboutSkin() {
        if (homeless_ > 0)
            character_.warnings.push_back(std::to_string(homeless_) + (homeless_ == 1 ? " bone has" : " bones have") +
                                          " no node and " + (homeless_ == 1 ? "is" : "are") + " left out, such as '" +
                                          firstHomeless_ + "'");
        if (posedMeshes_ > 0)
            character_.warnings.push_back("the nodes of " + std::to_string(posedMeshes_) +
                                          " meshes do not stand in the bind pose, such as " + firstPosed_ +
                                          "; the bind pose of the skin is used");
        const SkinInfo& skin = character_.skin;
        if (skin.renormalized > 0)
            character_.warnings.push_back(std::to_string(skin.renormalized) + " of " + std::to_string(skin.vertices) +
                                          " vertices have weights that do not sum to one (" +
                                          shortNumber(skin.leastSum) + " to " + shortNumber(skin.greatestSum) +
                                          "); normalised");
        if (negative_ > 0)
            character_.warnings.push_back(std::to_string(negative_) + " weights are below zero and left out");
        if (skin.unweighted > 0)
            character_.warnings.push_back(std::to_string(skin.unweighted) + " of " + std::to_string(skin.vertices) +
                                          " vertices follow no bone");
        if (!character_.droppedBones.empty())
            character_.warnings.push_back(std::to_string(character_.droppedBones.size()) +
                                          " bones move no vertex and are left out, such as '" +
                                          character_.droppedBones.front() + "'");
    }

    /// A file of motion alone: its nodes are its bones.
    void useNodes() {
        for (const ImportedMesh& mesh : scene_.meshes)
            if (!mesh.bones.empty())
                throw AssetError(character_.file, "",
                                 "mesh '" + mesh.name + "' has " + std::to_string(mesh.bones.size()) +
                                     " bones, but no weight of its vertices is a number above zero");
        for (const ImportedMesh& mesh : scene_.meshes)
            if (!mesh.triangles.empty())
                throw AssetError(character_.file, "", "has no bones: nothing is skinned or moves as a skeleton");
        deforms_ = movingSkeleton(scene_);
        if (std::find(deforms_.begin(), deforms_.end(), true) == deforms_.end())
            throw AssetError(character_.file, "", "has no bones: nothing is skinned or moves as a skeleton");
        character_.warnings.push_back("has no skin: shapes are made from the lengths of its bones");
    }

    /// What lies between bones is one, moving no vertex itself. It stands to those above it as the nodes do.
    void addBetween() {
        std::vector<bool> between(scene_.nodes.size(), false);
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
            const int above = deforms_[i] ? parentBone(static_cast<int>(i)) : -1;
            if (above < 0) continue;
            for (int at = scene_.nodes[i].parent; at != above; at = scene_.nodes[static_cast<std::size_t>(at)].parent)
                between[static_cast<std::size_t>(at)] = true;
        }
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
            if (!between[i]) continue;
            const auto above = static_cast<std::size_t>(scene_.nodes[i].parent);
            bind_[i] = bind_[above] * scene_.nodes[i].local;
            deforms_[i] = true;
        }
    }

    int parentBone(int node) const {
        const auto above = [&](int at) { return scene_.nodes[static_cast<std::size_t>(at)].parent; };
        int at = above(node);
        while (at >= 0 && !deforms_[static_cast<std::size_t>(at)]) at = above(at);
        return at;
    }

    /// One root is needed: the nearest node above all bones joins where they have none in common.
    void joinRoots() {
        int root = -1;
        bool several = false;
        for (int node = 0; node < static_cast<int>(scene_.nodes.size()); ++node) {
            if (!deforms_[static_cast<std::size_t>(node)] || parentBone(node) >= 0) continue;
            several = several || root >= 0;
            root = root < 0 ? node : commonNode(root, node);
        }
        if (several && root >= 0) deforms_[static_cast<std::size_t>(root)] = true;
    }

    int commonNode(int a, int b) const {
        while (a != b) {
            int& later = a > b ? a : b;
            later = scene_.nodes[static_cast<std::size_t>(later)].parent;
        }
        return a;
    }

    void collectBones(bool skinned) {
        joinRoots();
        std::map<std::string, int> used;
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
            if (!deforms_[i]) continue;
            Bone bone{scene_.nodes[i].name, parentBone(static_cast<int>(i)), rigidPart(bind_[i])};
            if (bone.parent >= 0) bone.parent = into_.boneOf[static_cast<std::size_t>(bone.parent)];
            if (const int copies = used[bone.name]++; copies > 0) bone.name += " (" + std::to_string(copies + 1) + ")";
            into_.boneOf[i] = static_cast<int>(character_.skeleton.bones.size());
            character_.skeleton.bones.push_back(std::move(bone));
            if (skinned) character_.skeleton.skin.push_back(std::move(skin_[i]));
        }
        std::set<std::int32_t> dropped;
        for (const ImportedMesh& mesh : scene_.meshes)
            for (const ImportedBone& bone : mesh.bones) {
                if (bone.node < 0 || deforms_[static_cast<std::size_t>(bone.node)]) continue;
                if (dropped.insert(bone.node).second) character_.droppedBones.push_back(bone.name);
            }
    }

    ImportedCharacter& into_;
    const ImportedScene& scene_;
    Character& character_;
    std::vector<Affine> globals_, bind_;
    std::vector<std::vector<Vec3>> skin_;
    std::vector<bool> deforms_;
    int posedMeshes_ = 0, homeless_ = 0, negative_ = 0;
    std::string firstPosed_, firstHomeless_;
};

void transform(Skeleton& skeleton, UpAxis up, float scale) {
    const Quat turn = uprightRotation(up);
    for (Bone& bone : skeleton.bones) {
        bone.bind.position = scale * upright(up, bone.bind.position);
        if (up != UpAxis::y) bone.bind.rotation = normalized(turn * bone.bind.rotation);
    }
    for (auto& vertices : skeleton.skin)
        for (Vec3& vertex : vertices) vertex = scale * upright(up, vertex);
}

const char* nameOf(UpAxis axis) { return axis == UpAxis::x ? "x" : axis == UpAxis::y ? "y" : "z"; }

/// A human stands along one axis of its file, whatever that says; of other bodies only the file can tell.
UpAxis decideUpAxis(const ImportedScene& scene, const CharacterOptions& options, const Anatomy& anatomy,
                    std::vector<std::string>& warnings) {
    if (options.upAxis) return *options.upAxis;
    const UpAxis said = scene.upAxis >= 0 ? static_cast<UpAxis>(scene.upAxis) : UpAxis::y;
    if (!anatomy.isHuman()) {
        if (scene.upAxis < 0) warnings.push_back("the file names no up axis; taken as y");
        return said;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const float along = anatomy.up[axis];
        if (along * along < 0.7f) continue;
        const auto seen = static_cast<UpAxis>(axis);
        if (along < 0) {
            warnings.push_back(std::string("the body stands on its head along ") + nameOf(seen) + "; left as it is");
            return said;
        }
        if (seen != said)
            warnings.push_back(std::string("the body stands along ") + nameOf(seen) + " of the file" +
                               (scene.upAxis >= 0 ? std::string(", which calls ") + nameOf(said) + " up" : "") +
                               "; turned to y up");
        return seen;
    }
    warnings.push_back(std::string("the body stands along no axis of the file; ") + nameOf(said) + " is taken as up");
    return said;
}

float extentAlong(const Skeleton& skeleton, const Vec3& direction) {
    float lower = std::numeric_limits<float>::infinity(), upper = -lower;
    const auto include = [&](const Vec3& point) {
        lower = std::min(lower, dot(point, direction));
        upper = std::max(upper, dot(point, direction));
    };
    for (const Bone& bone : skeleton.bones) include(bone.bind.position);
    for (const auto& vertices : skeleton.skin)
        for (const Vec3& vertex : vertices) include(vertex);
    return upper - lower;
}

/// A human is one to two and a half metres tall where the file does not say how long its units are: the usual unit that
/// makes it so, nearest to 1.75 m, or that height where none does.
float guessUnit(float height, std::vector<std::string>& warnings) {
    constexpr float kUsual = 1.75f, kTall = 2.2f, kSmall = 1.2f;
    if (height > 0.3f && height < 4.0f) return 1;
    float unit = kUsual / height;
    const char* name = "";
    float off = std::numeric_limits<float>::infinity();
    for (const auto& [usual, called] : {std::pair{0.01f, "centimetres"},
                                        {0.0254f, "inches"},
                                        {0.001f, "millimetres"},
                                        {0.3048f, "feet"},
                                        {0.1f, "decimetres"}}) {
        const float tall = height * usual, away = std::abs(std::log(tall / kUsual));
        if (tall < kSmall || tall > kTall || away > off) continue;
        off = away;
        unit = usual;
        name = called;
    }
    warnings.push_back("the file does not say its units: taken as " +
                       (*name ? std::string(name) : shortNumber(unit) + " m") + ", which make the body " +
                       shortNumber(height * unit) + " m tall");
    return unit;
}

float decideUnit(const ImportedScene& scene, const CharacterOptions& options, const std::string& file,
                 const Anatomy& anatomy, float height, std::vector<std::string>& warnings) {
    if (!options.metersPerUnit) {
        if (scene.unitScale > 0) return static_cast<float>(scene.unitScale);
        return anatomy.isHuman() && height > 0 ? guessUnit(height, warnings) : 1.0f;
    }
    if (!(*options.metersPerUnit > 0 && std::isfinite(*options.metersPerUnit)))
        throw AssetError(file, "", "metersPerUnit is " + shortNumber(*options.metersPerUnit) + ", must be above 0");
    return *options.metersPerUnit;
}

}  // namespace

int Character::findClip(std::string_view name) const {
    for (std::size_t i = 0; i < clips.size(); ++i)
        if (clips[i].name == name) return static_cast<int>(i);
    return -1;
}

ImportedCharacter importCharacter(const std::filesystem::path& path, const CharacterOptions& options,
                                  ImportedDetail detail) {
    ImportedCharacter imported{{}, importScene(path, detail), {}, {}, {}};
    const ImportedScene& scene = imported.scene;
    Character& character = imported.character;
    character.file = path.string();
    character.format = scene.format;
    character.warnings = scene.warnings;
    CharacterBuilder(imported).run();
    if (const std::string problem = whyInvalid(character.skeleton); !problem.empty())
        throw AssetError(character.file, "", problem);

    const Anatomy anatomy = recognise(character.skeleton);
    character.upAxis = decideUpAxis(scene, options, anatomy, character.warnings);
    const float tall = extentAlong(character.skeleton, anatomy.up);
    character.metersPerUnit = decideUnit(scene, options, character.file, anatomy, tall, character.warnings);
    transform(character.skeleton, character.upAxis, character.metersPerUnit);
    imported.toModel = uprightScaling(character.upAxis, character.metersPerUnit);
    character.clips = makeClips(imported);
    character.springs = makeSprings(imported);
    const Bounds bounds = boundsOf(character.skeleton);
    character.height = bounds.upper.y - bounds.lower.y;
    const bool likely = character.height >= 0.3f && character.height <= 4.0f;
    if (anatomy.isHuman() && !likely)
        character.warnings.push_back("the body is " + shortNumber(character.height) + " m tall at " +
                                     shortNumber(character.metersPerUnit) +
                                     " m per unit; set CharacterOptions::metersPerUnit");
    if (!anatomy.note.empty()) character.warnings.push_back(anatomy.note);
    character.warnings = counted(character.warnings);
    return imported;
}

Character loadCharacter(const std::filesystem::path& path, const CharacterOptions& options) {
    return importCharacter(path, options, ImportedDetail::skeleton).character;
}

RagdollDef makeRagdoll(const Character& character, const RagdollOptions& options) {
    return makeRagdoll(character.skeleton, options);
}

}  // namespace ragtop
