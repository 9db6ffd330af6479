#pragma once

#include <vector>

#include "../scenery.h"
#include "peer.h"

namespace ragtop::stability {

/// How a body hangs on others.
struct TreeNode {
    static constexpr int kFree = -1;
    int parent = kWorld;
    int joint = kFree;  ///< of the scene, to the parent
    std::vector<int> children{};
};

/// The trees that the joints of a scene make, for engines with reduced coordinates: from what is fixed, then from the
/// first body of whatever hangs on nothing. Joints that close loops are none of theirs.
class Trees {
public:
    /// All bodies free.
    explicit Trees(const PeerBodies& bodies) : nodes_(static_cast<std::size_t>(bodies.count())) {}
    Trees(const Scene& scene, const PeerBodies& bodies);

    const TreeNode& node(int body) const { return nodes_[static_cast<std::size_t>(body)]; }
    bool has(int joint) const;
    /// All bodies, each after the one that it hangs on.
    std::vector<int> parentsFirst() const;

private:
    void grow(const Scene& scene, const PeerBodies& bodies, std::vector<int> front, std::vector<bool>& reached);

    std::vector<TreeNode> nodes_;
};

/// May the ball turn freely in all directions?
bool isFree(const BallDef& ball);
/// May the hinge turn freely about its axis?
bool isFree(const HingeDef& hinge);

}  // namespace ragtop::stability
