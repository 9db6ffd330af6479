#include "assimp_clips.h"

#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "assimp_math.h"

namespace ragtop {
namespace {

/// What of a file's clips nothing becomes of.
struct LeftOutOfClips {
    int keys = 0, tracks = 0, morphs = 0;

    void tell(std::vector<std::string>& warnings) const {
        const auto say = [&](int count, const char* what) {
            if (count > 0) warnings.push_back(std::to_string(count) + what);
        };
        say(keys, " keys of clips that come no later than the one before are left out");
        say(tracks, " tracks of clips that move no node, or have no keys, are left out");
        say(morphs, " tracks of clips that move vertices are left out");
    }
};

/// Keys in seconds, those that do not come later than the one before left out. Equal ones are one.
template <class Key, class Value, class Convert>
void readKeys(const Key* keys, unsigned count, double rate, std::vector<float>& times, std::vector<Value>& values,
              int& leftOut, Convert convert) {
    for (unsigned i = 0; i < count; ++i) {
        const auto time = static_cast<float>(keys[i].mTime / rate);
        const Value value = convert(keys[i].mValue);
        if (!times.empty() && !(time > times.back())) {
            leftOut += time == times.back() && value == values.back() ? 0 : 1;
            continue;
        }
        times.push_back(time);
        values.push_back(value);
    }
}

/// What is no number stays so, to be refused.
Quat toQuat(const aiQuaternion& q) {
    const Quat quat{q.x, q.y, q.z, q.w};
    return isFinite(quat) ? normalized(quat) : quat;
}

ImportedChannel toChannel(const aiNodeAnim& from, std::int32_t node, double rate, int& leftOut) {
    ImportedChannel channel;
    channel.node = node;
    const auto vector = [](const aiVector3D& v) { return toVec3(v); };
    const auto read = [&](auto* keys, unsigned count, auto& times, auto& values, auto convert) {
        readKeys(keys, count, rate, times, values, leftOut, convert);
    };
    read(from.mPositionKeys, from.mNumPositionKeys, channel.positionTimes, channel.positions, vector);
    read(from.mRotationKeys, from.mNumRotationKeys, channel.rotationTimes, channel.rotations, toQuat);
    read(from.mScalingKeys, from.mNumScalingKeys, channel.scaleTimes, channel.scales, vector);
    return channel;
}

bool isComplete(const ImportedChannel& channel) {
    return !channel.positions.empty() && !channel.rotations.empty() && !channel.scales.empty();
}

/// Some files begin before zero.
void beginAtZero(ImportedClip& clip) {
    float first = 0;
    const auto eachTimes = [&](auto use) {
        for (ImportedChannel& channel : clip.channels)
            for (auto* times : {&channel.positionTimes, &channel.rotationTimes, &channel.scaleTimes}) use(*times);
    };
    eachTimes([&](const std::vector<float>& times) { first = std::min(first, times.front()); });
    eachTimes([&](std::vector<float>& times) {
        for (float& time : times) time -= first;
    });
}

}  // namespace

void addClips(const aiScene& from, ImportedScene& to) {
    std::map<std::string, std::int32_t> nodeOf;
    for (std::size_t i = 0; i < to.nodes.size(); ++i) nodeOf.emplace(to.nodes[i].name, static_cast<std::int32_t>(i));
    LeftOutOfClips left;
    for (unsigned i = 0; i < from.mNumAnimations; ++i) {
        const aiAnimation& clip = *from.mAnimations[i];
        const double rate = clip.mTicksPerSecond > 0 ? clip.mTicksPerSecond : 25.0;
        ImportedClip read{clip.mName.C_Str(), clip.mDuration / rate, {}};
        if (read.name.empty()) read.name = "clip " + std::to_string(i);
        for (unsigned k = 0; k < clip.mNumChannels; ++k) {
            const auto node = nodeOf.find(clip.mChannels[k]->mNodeName.C_Str());
            ++left.tracks;
            if (node == nodeOf.end()) continue;
            ImportedChannel channel = toChannel(*clip.mChannels[k], node->second, rate, left.keys);
            if (!isComplete(channel)) continue;
            read.channels.push_back(std::move(channel));
            --left.tracks;
        }
        left.morphs += static_cast<int>(clip.mNumMeshChannels + clip.mNumMorphMeshChannels);
        beginAtZero(read);
        to.clips.push_back(std::move(read));
    }
    left.tell(to.warnings);
}

std::string whyInvalid(const ImportedClip& clip, std::size_t nodeCount) {
    const auto rises = [](const std::vector<float>& times, std::size_t keys) {
        if (times.empty() || times.size() != keys || !std::isfinite(times.back())) return false;
        for (std::size_t i = 0; i < times.size(); ++i)
            if (!(times[i] >= 0) || (i > 0 && !(times[i] > times[i - 1]))) return false;
        return true;
    };
    const auto finite = [](const auto& values) {
        return std::all_of(values.begin(), values.end(), [](const auto& value) { return isFinite(value); });
    };
    if (!(clip.seconds >= 0 && std::isfinite(clip.seconds))) return "has a length that is not finite";
    for (const ImportedChannel& channel : clip.channels) {
        if (channel.node < 0 || static_cast<std::size_t>(channel.node) >= nodeCount) return "moves no such node";
        if (!rises(channel.positionTimes, channel.positions.size()) ||
            !rises(channel.rotationTimes, channel.rotations.size()) ||
            !rises(channel.scaleTimes, channel.scales.size()))
            return "has keys whose times do not rise";
        if (!finite(channel.positions) || !finite(channel.rotations) || !finite(channel.scales))
            return "has a key that is not finite";
    }
    return {};
}

}  // namespace ragtop
