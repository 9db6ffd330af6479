#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "character_import.h"
#include "ragtop/visual.h"
#include "visual_builder.h"

namespace ragtop {
namespace {

/// Where a bone of the character hangs: on a part, in the frame of that part's bone.
struct Hold {
    int part = -1;
    Frame inPart;
};

class SkinCooker {
public:
    SkinCooker(const ImportedCharacter& from, const RagdollDef& ragdoll) : from_(from), ragdoll_(ragdoll) {}

    Visual cook() {
        findHolds();
        addJoints();
        addSurfaces();
        result_.warnings = from_.scene.warnings;
        result_.glb = builder_.finish(from_.character.file);
        return std::move(result_);
    }

private:
    const std::vector<Bone>& bones() const { return from_.character.skeleton.bones; }

    void findHolds() {
        std::map<std::string, const RagdollBone*> known;
        for (const RagdollBone& bone : ragdoll_.bones) known.emplace(bone.name, &bone);
        bool any = false;
        for (const Bone& bone : bones()) {
            if (const auto found = known.find(bone.name); found != known.end()) {
                holds_.push_back({found->second->part, found->second->inPart});
                any = true;
            } else if (bone.parent >= 0) {
                const Hold& before = holds_[static_cast<std::size_t>(bone.parent)];
                const Frame& rest = bones()[static_cast<std::size_t>(bone.parent)].bind;
                holds_.push_back({before.part, before.inPart * (inverse(rest) * bone.bind)});
            } else {
                holds_.push_back({0, inverse(ragdoll_.parts.front().bind) * bone.bind});
            }
        }
        if (!any) {
            throw AssetError(from_.character.file, "",
                             "has no bone of the ragdoll, such as '" + ragdoll_.bones.front().name + "'");
        }
    }

    /// The bone that moves as a part does carries it; the others hang on that.
    bool carries(std::size_t bone, int part) const {
        const auto at = static_cast<std::size_t>(ragdoll_.parts[static_cast<std::size_t>(part)].bone);
        return holds_[bone].part == part && bones()[bone].name == ragdoll_.bones[at].name;
    }

    void addJoints() {
        const int root = builder_.addNode("(ragdoll)");
        joints_.assign(bones().size(), -1);
        for (int part = 0; part < static_cast<int>(ragdoll_.parts.size()); ++part) {
            const RagdollPart& from = ragdoll_.parts[static_cast<std::size_t>(part)];
            const int node =
                builder_.addChild(root, ragdoll_.bones[static_cast<std::size_t>(from.bone)].name, from.bind);
            result_.nodes.push_back({builder_.nameOf(node), part});
            for (std::size_t bone = 0; bone < bones().size(); ++bone) {
                if (holds_[bone].part != part) continue;
                joints_[bone] =
                    carries(bone, part) ? node : builder_.addChild(node, bones()[bone].name, holds_[bone].inPart);
            }
        }
    }

    void addSurfaces() {
        std::vector<VisualSurface> surfaces = emptySurfaces(from_.scene);
        for (const CharacterPiece& piece : from_.pieces) {
            const ImportedMesh& mesh = from_.scene.meshes[piece.mesh];
            VisualSurface& surface = surfaceFor(mesh, surfaces);
            surface.append(mesh, from_.toModel * piece.place);
            const std::vector<VertexJoints> moved = jointsOf(mesh, piece);
            surface.joints.insert(surface.joints.end(), moved.begin(), moved.end());
        }
        const int mesh = builder_.addMesh(surfaces, builder_.addMaterials(from_.scene));
        if (mesh < 0) throw AssetError(from_.character.file, "", "has no mesh to look at");
        std::vector<Frame> rest;
        for (const Bone& bone : bones()) rest.push_back(bone.bind);
        builder_.addSkin(mesh, joints_, rest);
    }

    /// The four joints that move each vertex the most, their weights made to sum to one.
    std::vector<VertexJoints> jointsOf(const ImportedMesh& mesh, const CharacterPiece& piece) const {
        struct Influence {
            float weight;
            std::uint16_t joint;
            std::size_t place;
        };
        std::vector<std::vector<Influence>> influences(mesh.vertices.size());
        for (const ImportedBone& bone : mesh.bones) {
            const int at = bone.node < 0 ? -1 : from_.boneOf[static_cast<std::size_t>(bone.node)];
            if (at < 0) continue;
            for (const ImportedWeight& w : bone.weights) {
                std::vector<Influence>& all = influences[w.vertex];
                if (w.weight > 0) all.push_back({w.weight, static_cast<std::uint16_t>(at), all.size()});
            }
        }
        std::vector<VertexJoints> result;
        for (std::vector<Influence>& all : influences) {
            std::sort(all.begin(), all.end(), [](const Influence& a, const Influence& b) {
                return a.weight > b.weight || (a.weight == b.weight && a.place < b.place);
            });
            all.resize(std::min<std::size_t>(all.size(), 4));
            float sum = 0;
            for (const Influence& one : all) sum += one.weight;
            VertexJoints vertex;
            vertex.joints[0] = static_cast<std::uint16_t>(std::max(piece.bone, 0));
            for (std::size_t i = 0; i < all.size(); ++i) {
                vertex.joints[i] = all[i].joint;
                vertex.weights[i] = all[i].weight / sum;
            }
            result.push_back(vertex);
        }
        return result;
    }

    const ImportedCharacter& from_;
    const RagdollDef& ragdoll_;
    std::vector<Hold> holds_;  ///< one per bone
    std::vector<int> joints_;  ///< one node per bone
    VisualBuilder builder_;
    Visual result_;
};

}  // namespace

Visual cookSkin(const std::filesystem::path& character, const RagdollDef& ragdoll, const CharacterOptions& options) {
    if (const std::string wrong = whyInvalid(ragdoll); !wrong.empty()) {
        throw AssetError(character.string(), "", "goes with a ragdoll that is not usable: " + wrong);
    }
    return SkinCooker(importCharacter(character, options, ImportedDetail::looks), ragdoll).cook();
}

}  // namespace ragtop
