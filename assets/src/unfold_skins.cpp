#include "unfold_skins.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ragtop {
namespace {

constexpr float kSame = 1e-5f;  ///< relative difference of maps that are the same but for rounding

bool same(const Affine& a, const Affine& b) {
    const auto near = [](const Vec3& u, const Vec3& v) {
        return length(u - v) <= kSame * std::max(length(u), length(v));
    };
    return near(a.linear.cx, b.linear.cx) && near(a.linear.cy, b.linear.cy) && near(a.linear.cz, b.linear.cz) &&
           near(a.shift, b.shift);
}

bool moves(const ImportedBone& bone) {
    return bone.node >= 0 && std::any_of(bone.weights.begin(), bone.weights.end(),
                                         [](const ImportedWeight& weight) { return weight.weight > 0; });
}

/// All bones in one place at bind, and in several at rest.
bool isFolded(const ImportedMesh& mesh, const std::vector<Affine>& globals) {
    const ImportedBone* first = nullptr;
    bool apart = false;
    for (const ImportedBone& bone : mesh.bones) {
        if (!moves(bone)) continue;
        const Affine& at = globals[static_cast<std::size_t>(bone.node)];
        if (determinant(at.linear) == 0) return false;
        if (!first) first = &bone;
        if (!same(bone.offset, first->offset)) return false;
        apart = apart || !same(at, globals[static_cast<std::size_t>(first->node)]);
    }
    return apart;
}

/// Normals turn with planes: by the cofactors, which are the inverse transpose but for scale.
Vec3 turned(const Mat3& m, const Vec3& normal) {
    return normalized(normal.x * cross(m.cy, m.cz) + normal.y * cross(m.cz, m.cx) + normal.z * cross(m.cx, m.cy));
}

/// v = Σ w G O v₀ / Σ w, of the nodes' places G and the offsets O.
void unfold(ImportedMesh& mesh, const std::vector<Affine>& globals) {
    std::vector<float> sums(mesh.vertices.size(), 0.0f);
    std::vector<Vec3> places(mesh.vertices.size()), normals(mesh.normals.size());
    for (ImportedBone& bone : mesh.bones) {
        if (bone.node < 0) continue;
        const Affine& at = globals[static_cast<std::size_t>(bone.node)];
        const Affine brings = at * bone.offset;
        for (const ImportedWeight& weight : bone.weights) {
            if (!(weight.weight > 0)) continue;
            sums[weight.vertex] += weight.weight;
            places[weight.vertex] += weight.weight * transformPoint(brings, mesh.vertices[weight.vertex]);
            if (weight.vertex < normals.size())
                normals[weight.vertex] += weight.weight * turned(brings.linear, mesh.normals[weight.vertex]);
        }
        bone.offset = inverse(at);
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (!(sums[i] > 0)) continue;
        mesh.vertices[i] = 1 / sums[i] * places[i];
        if (i < normals.size()) mesh.normals[i] = normalized(normals[i], mesh.normals[i]);
    }
}

}  // namespace

void unfoldSkins(ImportedScene& scene) {
    const std::vector<Affine> globals = globalTransforms(scene);
    for (ImportedMesh& mesh : scene.meshes)
        if (isFolded(mesh, globals)) unfold(mesh, globals);
}

}  // namespace ragtop
