#include "borrowed_clips.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "ragtop/character.h"
#include "ragtop/find_asset.h"
#include "ragtop/retarget.h"

namespace ragtop::demos {

std::vector<Clip> borrowClips(const std::string& asset, const RagdollDef& to) {
    const Character other = loadCharacter(findAsset(asset));
    if (other.clips.empty()) throw AssetError(asset + ": has no clips, must have one or more to be borrowed");
    std::vector<Clip> clips;
    try {
        const RagdollDef from = makeRagdoll(other);
        for (const Clip& clip : other.clips) {
            Retargeted made = retarget(clip, from, to);
            fmt::print("{}: {:.2f} s, ways times {:.3f}, {} stances held, {} parts still\n", clip.name, clip.seconds,
                       made.scale, made.stances, made.still.size());
            clips.push_back(std::move(made.clip));
        }
    } catch (const std::invalid_argument& error) {
        throw AssetError(asset + ": " + error.what());
    }
    return clips;
}

}  // namespace ragtop::demos
