#include <algorithm>
#include <stdexcept>

#include "ragtop/retarget.h"

namespace ragtop {
namespace {

/// The turn about y of a turn that is one about y and then one about a level axis.
Quat headingOf(const Quat& turn) {
    const Quat heading{0, turn.y, 0, turn.w};
    return turn.y * turn.y + turn.w * turn.w > 0 ? normalized(heading) : Quat{};
}

}  // namespace

RootMotion takeRootMotion(Clip& clip, const Skeleton& skeleton) {
    if (const std::string problem = whyInvalid(clip, skeleton); !problem.empty())
        throw std::invalid_argument("root motion: clip: " + problem);
    const auto root =
        std::find_if(clip.tracks.begin(), clip.tracks.end(), [](const ClipTrack& track) { return track.bone == 0; });
    RootMotion motion;
    if (root == clip.tracks.end()) return motion;
    motion.times = root->times;
    const Frame first = root->keys.front();
    for (Frame& key : root->keys) {
        const Quat heading = headingOf(normalized(key.rotation * conjugate(first.rotation)));
        // What is left stays over the spot that the first bone was over at first.
        const Vec3 spot{first.position.x, 0, first.position.z}, now{key.position.x, 0, key.position.z};
        const Frame level{now - rotate(heading, spot), heading};
        motion.keys.push_back(level);
        key = inverse(level) * key;
        key.rotation = normalized(key.rotation);
    }
    return motion;
}

}  // namespace ragtop
