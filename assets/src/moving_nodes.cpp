#include "moving_nodes.h"

#include <algorithm>
#include <cmath>

namespace ragtop {
namespace {

bool isTurning(const ImportedChannel& channel) {
    const Quat& first = channel.rotations.front();
    return std::any_of(channel.rotations.begin(), channel.rotations.end(), [&](const Quat& q) {
        return std::abs(first.x * q.x + first.y * q.y + first.z * q.z + first.w * q.w) < 1 - 1e-6f;
    });
}

}  // namespace

std::vector<bool> movingSkeleton(const ImportedScene& scene) {
    const std::size_t count = scene.nodes.size();
    const auto above = [&](std::size_t i) { return scene.nodes[i].parent; };
    std::vector<bool> turns(count, false), device(count, false), bone(count, false);
    for (const ImportedClip& clip : scene.clips)
        for (const ImportedChannel& channel : clip.channels)
            // All that a BVH has is a skeleton, be it at rest.
            if (isTurning(channel) || scene.format.find("BVH") != std::string::npos)
                turns[static_cast<std::size_t>(channel.node)] = true;
    for (std::size_t i = 0; i < count; ++i) {
        device[i] = scene.nodes[i].device || (above(i) >= 0 && device[static_cast<std::size_t>(above(i))]);
        if (device[i]) turns[i] = false;
    }
    // Of each node that turns: the highest one above it that does, and how many there are on the way.
    std::vector<int> top(count, -1), depth(count, 0);
    std::vector<int> deepest(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
        if (above(i) >= 0) {
            top[i] = top[static_cast<std::size_t>(above(i))];
            depth[i] = depth[static_cast<std::size_t>(above(i))];
        }
        if (!turns[i]) continue;
        if (top[i] < 0) top[i] = static_cast<int>(i);
        int& most = deepest[static_cast<std::size_t>(top[i])];
        most = std::max(most, ++depth[i]);
    }
    for (std::size_t i = 0; i < count; ++i)
        bone[i] = !device[i] && top[i] >= 0 && deepest[static_cast<std::size_t>(top[i])] >= 3;
    return bone;
}

}  // namespace ragtop
