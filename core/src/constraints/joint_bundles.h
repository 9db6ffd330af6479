#pragma once

#include <memory_resource>

#include "base/aligned_array.h"
#include "constraints/constraint_graph.h"
#include "constraints/joint_image.h"

namespace ragtop {

/// The joints of each colour in bundles of equal structure. What has none, or is the only one in its colour, stays
/// single and is solved one by one, with the same bits. Derived from the graph and the joints; nothing of it is saved.
class JointBundles {
public:
    struct Color {
        int begin = 0, end = 0;              ///< bundles
        int firstSingle = 0, endSingle = 0;  ///< joints
    };

    JointBundles(int lanes, std::pmr::memory_resource* memory);
    /// After joints came, went or changed.
    void build(const ConstraintGraph& graph, JointSim* const* sims);

    /// Of a list of the graph that passes visit.
    const Color& color(int index) const { return colors_[static_cast<std::size_t>(index)]; }
    int bundleCount() const { return static_cast<int>(bundles_.size()); }
    std::uint32_t single(int place) const { return singles_[static_cast<std::size_t>(place)]; }
    JointLanesView view(JointSim* const* sims);
    std::size_t bytes() const;

private:
    void addColor(const ConstraintGraph::Color& color, JointSim* const* sims);
    void addBundle(const JointBundle& bundle, JointSim* const* sims, std::size_t first, std::size_t count);

    std::size_t lanes_;
    AlignedArray<Color> colors_;  ///< per list of the graph
    AlignedArray<JointBundle> bundles_;
    AlignedArray<std::uint32_t> joints_, statesA_, statesB_, singles_;
    AlignedArray<std::uint64_t> sorted_;  ///< keys and joints
    AlignedArray<float> fields_;
    JointSim blank_{};
};

/// Can the joint be solved in lanes?
bool isWide(const JointSim& joint);
/// Joints with the same number can be in one bundle; 0: those that are solved alone.
std::uint64_t placeInBundles(const JointSim& joint);

}  // namespace ragtop
