#include "character_clips.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace ragtop {
namespace {

constexpr float kScaleAgree = 1e-3f;  ///< scales that differ by less are the same

/// Where a list of keys is at a time: the key before it, and the way to the next.
struct Place {
    std::size_t key = 0;
    float share = 0;
};

Place placeIn(const std::vector<float>& times, float time) {
    const auto later = std::upper_bound(times.begin(), times.end(), time);
    if (later == times.begin()) return {};
    const auto i = static_cast<std::size_t>(later - times.begin()) - 1;
    if (later == times.end()) return {i, 0};
    return {i, (time - times[i]) / (times[i + 1] - times[i])};
}

Vec3 vectorAt(const std::vector<float>& times, const std::vector<Vec3>& keys, float time) {
    const Place place = placeIn(times, time);
    if (place.share == 0) return keys[place.key];
    return keys[place.key] + place.share * (keys[place.key + 1] - keys[place.key]);
}

Quat rotationAt(const std::vector<float>& times, const std::vector<Quat>& keys, float time) {
    const Place place = placeIn(times, time);
    if (place.share == 0) return keys[place.key];
    const Pose from{{}, keys[place.key]}, to{{}, keys[place.key + 1]};
    return blend(from, to, static_cast<double>(place.share)).rotation;
}

Affine localAt(const ImportedNode& node, const ImportedChannel* channel, float time) {
    if (!channel) return node.local;
    const Mat3 turn = toMat3(rotationAt(channel->rotationTimes, channel->rotations, time));
    const Vec3 scale = vectorAt(channel->scaleTimes, channel->scales, time);
    return {{scale.x * turn.cx, scale.y * turn.cy, scale.z * turn.cz},
            vectorAt(channel->positionTimes, channel->positions, time)};
}

float scaleOf(const Affine& a) { return std::cbrt(std::abs(determinant(a.linear))); }

bool changesSize(const ImportedChannel& channel) {
    return std::any_of(channel.scales.begin(), channel.scales.end(), [&](const Vec3& scale) {
        return length(scale - channel.scales.front()) > kScaleAgree * length(channel.scales.front());
    });
}

class ClipMaker {
public:
    explicit ClipMaker(const ImportedCharacter& imported)
        : scene_(imported.scene), imported_(imported), globals_(globalTransforms(imported.scene)) {}

    Clip make(const ImportedClip& from, int& sized) const {
        std::vector<const ImportedChannel*> channels(scene_.nodes.size(), nullptr);
        for (const ImportedChannel& channel : from.channels) {
            channels[static_cast<std::size_t>(channel.node)] = &channel;
            sized += changesSize(channel);
        }
        Clip clip{from.name, static_cast<float>(from.seconds), {}};
        for (std::size_t node = 0; node < scene_.nodes.size(); ++node) {
            const int bone = imported_.boneOf[node];
            if (bone < 0) continue;
            ClipTrack track = trackOf(static_cast<int>(node), bone, channels);
            if (track.times.empty()) continue;
            clip.seconds = std::max(clip.seconds, track.times.back());
            clip.tracks.push_back(std::move(track));
        }
        return clip;
    }

private:
    /// The nodes that make a bone's place in its parent bone, or in the scene, from above.
    std::vector<int> wayTo(int node) const {
        std::vector<int> way{node};
        const auto above = [&] { return scene_.nodes[static_cast<std::size_t>(way.back())].parent; };
        while (above() >= 0 && imported_.boneOf[static_cast<std::size_t>(above())] < 0) way.push_back(above());
        std::reverse(way.begin(), way.end());
        return way;
    }

    ClipTrack trackOf(int node, int bone, const std::vector<const ImportedChannel*>& channels) const {
        const std::vector<int> way = wayTo(node);
        ClipTrack track{bone, {}, {}};
        for (const int at : way) {
            const ImportedChannel* channel = channels[static_cast<std::size_t>(at)];
            if (!channel) continue;
            for (const auto* times : {&channel->positionTimes, &channel->rotationTimes, &channel->scaleTimes})
                track.times.insert(track.times.end(), times->begin(), times->end());
        }
        std::sort(track.times.begin(), track.times.end());
        track.times.erase(std::unique(track.times.begin(), track.times.end()), track.times.end());
        const int above = scene_.nodes[static_cast<std::size_t>(way.front())].parent;
        // The first bone is in model space; what is above it counts, and the unit and axes of the file.
        Affine carrier = imported_.toModel;
        if (above >= 0) carrier = carrier * globals_[static_cast<std::size_t>(above)];
        const float scale = scaleOf(carrier);
        for (const float time : track.times) {
            Affine local;
            for (const int at : way)
                local = local * localAt(scene_.nodes[static_cast<std::size_t>(at)],
                                        channels[static_cast<std::size_t>(at)], time);
            Frame key = rigidPart(bone == 0 ? carrier * local : local);
            if (bone != 0) key.position = scale * local.shift;
            track.keys.push_back(key);
        }
        return track;
    }

    const ImportedScene& scene_;
    const ImportedCharacter& imported_;
    std::vector<Affine> globals_;
};

}  // namespace

std::vector<Clip> makeClips(ImportedCharacter& imported) {
    const ClipMaker maker(imported);
    std::vector<Clip> clips;
    int sized = 0;
    for (const ImportedClip& clip : imported.scene.clips) clips.push_back(maker.make(clip, sized));
    if (sized > 0)
        imported.character.warnings.push_back("clips change the size of nodes in " + std::to_string(sized) +
                                              " channels, which is left out");
    return clips;
}

}  // namespace ragtop
