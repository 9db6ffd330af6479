#include "character_clips.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace ragtop {
namespace {

constexpr float kScaleAgree = 1e-3f;  ///< scales that differ by less are the same

/// Keys of a channel at times that rise.
template <class Key>
class KeyReader {
public:
    KeyReader(const std::vector<float>& times, const std::vector<Key>& keys) : times_(times), keys_(keys) {}

    Key at(float time) {
        while (next_ < times_.size() && times_[next_] <= time) ++next_;
        if (next_ == 0) return keys_.front();
        const float before = times_[next_ - 1];
        if (next_ == times_.size() || before == time) return keys_[next_ - 1];
        return between(keys_[next_ - 1], keys_[next_], (time - before) / (times_[next_] - before));
    }

private:
    static Vec3 between(const Vec3& from, const Vec3& to, float share) { return from + share * (to - from); }
    static Quat between(const Quat& from, const Quat& to, float share) {
        return blend(Pose{{}, from}, Pose{{}, to}, static_cast<double>(share)).rotation;
    }

    const std::vector<float>& times_;
    const std::vector<Key>& keys_;
    std::size_t next_ = 0;  ///< key, behind the time asked for last
};

struct ChannelReader {
    explicit ChannelReader(const ImportedChannel& channel)
        : positions(channel.positionTimes, channel.positions),
          rotations(channel.rotationTimes, channel.rotations),
          scales(channel.scaleTimes, channel.scales) {}

    Affine at(float time) {
        const Mat3 turn = toMat3(rotations.at(time));
        const Vec3 scale = scales.at(time);
        return {{scale.x * turn.cx, scale.y * turn.cy, scale.z * turn.cz}, positions.at(time)};
    }

    KeyReader<Vec3> positions;
    KeyReader<Quat> rotations;
    KeyReader<Vec3> scales;
};

/// Of all keys; below zero they mirror.
bool isEvenlyScaled(const ImportedChannel& channel) {
    return std::all_of(channel.scales.begin(), channel.scales.end(),
                       [](const Vec3& scale) { return scale.x > 0 && scale.y == scale.x && scale.z == scale.x; });
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
        track.keys.reserve(track.times.size());
        const ImportedChannel* own = channels[static_cast<std::size_t>(node)];
        if (bone != 0 && way.size() == 1 && own && isEvenlyScaled(*own)) {
            ChannelReader reader(*own);
            for (const float time : track.times)
                track.keys.push_back({scale * reader.positions.at(time), reader.rotations.at(time)});
            return track;
        }
        std::vector<std::optional<ChannelReader>> readers;
        for (const int at : way) {
            const ImportedChannel* channel = channels[static_cast<std::size_t>(at)];
            readers.push_back(channel ? std::optional<ChannelReader>(*channel) : std::nullopt);
        }
        for (const float time : track.times) {
            Affine local;
            for (std::size_t i = 0; i < way.size(); ++i)
                local =
                    local * (readers[i] ? readers[i]->at(time) : scene_.nodes[static_cast<std::size_t>(way[i])].local);
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
