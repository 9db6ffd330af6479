#include "bone_names.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace ragtop {
namespace {

bool isLower(char c) { return c >= 'a' && c <= 'z'; }
bool isUpper(char c) { return c >= 'A' && c <= 'Z'; }

/// "Bip01 L UpperArm" as bip, l, upper, arm.
std::vector<std::string> wordsOf(const std::string& name) {
    std::vector<std::string> words;
    bool open = false;
    for (std::size_t i = 0; i < name.size(); ++i) {
        const char c = name[i];
        if (!isLower(c) && !isUpper(c)) {
            open = false;
            continue;
        }
        const bool begins =
            !open || (isUpper(c) && (isLower(name[i - 1]) || (i + 1 < name.size() && isLower(name[i + 1]))));
        if (begins) words.emplace_back();
        words.back() += isUpper(c) ? static_cast<char>(c - 'A' + 'a') : c;
        open = true;
    }
    return words;
}

bool has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

template <std::size_t N>
bool hasAny(std::string_view text, const std::array<std::string_view, N>& parts) {
    return std::any_of(parts.begin(), parts.end(), [&](std::string_view part) { return has(text, part); });
}

template <std::size_t N>
bool isAny(const std::vector<std::string>& words, const std::array<std::string_view, N>& wanted) {
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
        return std::find(wanted.begin(), wanted.end(), word) != wanted.end();
    });
}

// Short ones count as whole words, long ones anywhere.
constexpr std::array<std::string_view, 16> kLooseWords{"ik",  "ctrl", "pole", "cam", "slot", "eye",  "ear",  "jaw",
                                                       "hat", "belt", "coat", "lip", "robe", "brow", "prop", "gun"};
constexpr std::array<std::string_view, 23> kLooseParts{"target", "control", "camera", "socket",   "effector", "cape",
                                                       "cloak",  "skirt",   "cloth",  "dress",    "scarf",    "strap",
                                                       "ribbon", "hair",    "braid",  "ponytail", "beard",    "breast",
                                                       "weapon", "shield",  "tongue", "sword",    "feather"};

using Word = std::pair<std::string_view, NameHint>;
constexpr std::array<Word, 52> kHints{{
    {"forearm", NameHint::elbow},
    {"lowerarm", NameHint::elbow},
    {"loarm", NameHint::elbow},
    {"elbow", NameHint::elbow},
    {"radius", NameHint::elbow},
    {"finger", NameHint::finger},
    {"thumb", NameHint::finger},
    {"index", NameHint::finger},
    {"pinky", NameHint::finger},
    {"hand", NameHint::wrist},
    {"wrist", NameHint::wrist},
    {"palm", NameHint::wrist},
    {"upperarm", NameHint::shoulder},
    {"uparm", NameHint::shoulder},
    {"humerus", NameHint::shoulder},
    {"clavicle", NameHint::clavicle},
    {"collar", NameHint::clavicle},
    {"scapula", NameHint::clavicle},
    {"thigh", NameHint::hip},
    {"upleg", NameHint::hip},
    {"upperleg", NameHint::hip},
    {"femur", NameHint::hip},
    {"calf", NameHint::knee},
    {"shin", NameHint::knee},
    {"shank", NameHint::knee},
    {"knee", NameHint::knee},
    {"lowerleg", NameHint::knee},
    {"loleg", NameHint::knee},
    {"tibia", NameHint::knee},
    {"toe", NameHint::toe},
    {"foot", NameHint::ankle},
    {"ankle", NameHint::ankle},
    {"hoof", NameHint::ankle},
    {"paw", NameHint::ankle},
    {"metatars", NameHint::ankle},
    {"hock", NameHint::ankle},
    {"head", NameHint::head},
    {"skull", NameHint::head},
    {"neck", NameHint::neck},
    {"tail", NameHint::tail},
    {"wing", NameHint::wing},
    {"pelvis", NameHint::pelvis},
    {"hips", NameHint::pelvis},
    {"chest", NameHint::chest},
    {"thorax", NameHint::chest},
    {"spine", NameHint::spine},
    {"abdomen", NameHint::spine},
    {"torso", NameHint::spine},
    {"waist", NameHint::spine},
    {"shoulder", NameHint::shoulderOrClavicle},
    // What is left of arms and legs by now: "LeftArm" next to "LeftForeArm", "LeftLeg" next to "LeftUpLeg".
    {"arm", NameHint::arm},
    {"leg", NameHint::leg},
}};

NameHint hintOf(std::string_view text, const std::vector<std::string>& words) {
    // Twist bones carry the name of the segment whose middle they are in.
    if (has(text, "twist") || has(text, "roll") || has(text, "armature") || has(text, "armor")) return NameHint::none;
    for (const auto& [word, hint] : kHints)
        if (has(text, word)) return hint;
    if (isAny(words, std::array<std::string_view, 1>{"ball"})) return NameHint::toe;
    return isAny(words, std::array<std::string_view, 1>{"hip"}) ? NameHint::pelvis : NameHint::none;
}

int sideOf(std::string_view text, const std::vector<std::string>& words) {
    if (has(text, "left")) return -1;
    if (has(text, "right")) return 1;
    if (isAny(words, std::array<std::string_view, 1>{"l"})) return -1;
    return isAny(words, std::array<std::string_view, 1>{"r"}) ? 1 : 0;
}

}  // namespace

BoneName readName(const std::string& name) {
    const std::vector<std::string> words = wordsOf(name);
    std::string text;
    for (const std::string& word : words) text += word;
    BoneName read;
    read.loose = isAny(words, kLooseWords) || hasAny(text, kLooseParts);
    read.side = sideOf(text, words);
    if (read.loose) return read;
    read.hint = hintOf(text, words);
    // "LeftHip" is where the thigh begins.
    if (read.hint == NameHint::pelvis && read.side != 0) read.hint = NameHint::hip;
    read.beast = hasAny(text, std::array<std::string_view, 3>{"hoof", "paw", "hock"});
    const bool front = isAny(words, std::array<std::string_view, 2>{"front", "fore"}) && read.hint != NameHint::elbow;
    const bool limb = read.hint == NameHint::leg || (read.hint >= NameHint::hip && read.hint <= NameHint::toe);
    const bool hind = isAny(words, std::array<std::string_view, 2>{"hind", "rear"}) ||
                      (limb && isAny(words, std::array<std::string_view, 1>{"back"}));
    read.end = front || has(text, "foreleg") ? 1 : hind || has(text, "hindleg") ? -1 : 0;
    return read;
}

std::vector<NameHint> jointHints(std::span<const NameHint> chain) {
    std::vector<NameHint> hints(chain.begin(), chain.end());
    const auto count = [&](NameHint hint) { return std::count(hints.begin(), hints.end(), hint); };
    const auto replace = [&](NameHint from, NameHint to) { std::replace(hints.begin(), hints.end(), from, to); };
    // One that all bones have tells them apart no more than a number does.
    const bool oneArm = count(NameHint::arm) == 1, oneLeg = count(NameHint::leg) == 1;
    replace(NameHint::arm, oneArm && count(NameHint::shoulder) == 0 ? NameHint::shoulder : NameHint::none);
    if (oneLeg && count(NameHint::knee) == 0 && count(NameHint::hip) > 0) replace(NameHint::leg, NameHint::knee);
    replace(NameHint::leg, oneLeg && count(NameHint::hip) == 0 ? NameHint::hip : NameHint::none);
    const bool shoulder = count(NameHint::shoulderOrClavicle) == 1 && count(NameHint::shoulder) == 0;
    replace(NameHint::shoulderOrClavicle, shoulder ? NameHint::shoulder : NameHint::clavicle);
    return hints;
}

}  // namespace ragtop
