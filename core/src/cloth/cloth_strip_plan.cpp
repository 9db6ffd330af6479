// Quads of a cloth in strips, as mowers go over a field.

#include <algorithm>
#include <array>
#include <map>

#include "cloth/cloth_plan.h"

namespace ragtop::cloth {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

using Side = std::pair<int, int>;
Side inOrder(const Side& side) { return {std::min(side.first, side.second), std::max(side.first, side.second)}; }

class Mowing {
public:
    explicit Mowing(const ClothDef& def) : def_(def), used_(def.points.size(), 0), covered_(def.faces.size(), 0) {
        for (int f = 0; f < static_cast<int>(def.faces.size()); ++f) {
            if (def.faces[at(f)].d < 0) continue;
            for (const auto& [a, b] : sidesOf(f)) quadsOf_[inOrder({a, b})].push_back(f);
            ++open_;
        }
    }

    std::vector<StripLayer> take() {
        std::vector<StripLayer> layers;
        while (open_ > 0) layers.push_back(next());
        return layers;
    }

private:
    StripLayer next() {
        StripLayer layer;
        std::fill(used_.begin(), used_.end(), 0);
        for (int f = 0; f < static_cast<int>(def_.faces.size()); ++f) {
            const ClothFace& face = def_.faces[at(f)];
            if (face.d < 0 || covered_[at(f)] || !isFree({face.a, face.b}) || !isFree({face.c, face.d})) continue;
            layer.strips.push_back(stripFrom(f));
        }
        std::sort(layer.strips.begin(), layer.strips.end(), [](const Strip& a, const Strip& b) {
            return std::pair(b.rungs.size(), a.rungs.front()) < std::pair(a.rungs.size(), b.rungs.front());
        });
        return layer;
    }

    Strip stripFrom(int f) {
        const ClothFace& face = def_.faces[at(f)];
        Strip strip;
        addRung({face.a, face.b}, strip);
        cover(f);
        addRung({face.d, face.c}, strip);
        extend(strip);
        std::reverse(strip.rungs.begin(), strip.rungs.end());
        extend(strip);
        return strip;
    }

    /// Over quads that are open, beyond sides whose ends are free.
    void extend(Strip& strip) {
        for (bool grows = true; grows;) {
            grows = false;
            const Side last = strip.rungs.back();
            for (const int f : quadsOf_[inOrder(last)]) {
                const Side opposite = beyond(f, last);
                if (covered_[at(f)] || !isFree(opposite)) continue;
                cover(f);
                addRung(opposite, strip);
                grows = true;
                break;
            }
        }
    }

    /// The side of a quad opposite to another, each end beside the same end of that.
    Side beyond(int f, const Side& side) const {
        const std::array<Side, 4> sides = sidesOf(f);
        for (std::size_t i = 0; i < sides.size(); ++i) {
            const Side& opposite = sides[(i + 2) % 4];
            if (sides[i] == side) return {opposite.second, opposite.first};
            if (sides[i] == Side{side.second, side.first}) return opposite;
        }
        return side;
    }
    std::array<Side, 4> sidesOf(int f) const {
        const ClothFace& face = def_.faces[at(f)];
        return {Side{face.a, face.b}, {face.b, face.c}, {face.c, face.d}, {face.d, face.a}};
    }
    bool isFree(const Side& side) const { return !used_[at(side.first)] && !used_[at(side.second)]; }
    void cover(int f) {
        covered_[at(f)] = 1;
        --open_;
    }
    void addRung(const Side& side, Strip& strip) {
        used_[at(side.first)] = used_[at(side.second)] = 1;
        strip.rungs.push_back(side);
    }

    const ClothDef& def_;
    std::vector<char> used_, covered_;  ///< points of this layer; faces
    std::map<Side, std::vector<int>> quadsOf_;
    int open_ = 0;
};

}  // namespace

std::vector<StripLayer> makeStrips(const ClothDef& def) { return Mowing(def).take(); }

}  // namespace ragtop::cloth
