#include <cstring>
#include <fstream>

#include "layout.h"
#include "ragdoll_bytes.h"
#include "ragtop/cooked.h"
#include "ragtop/shape_image.h"

namespace ragtop {
namespace {

struct Section {
    SectionKind kind;
    std::vector<std::byte> bytes;
};

template <class T>
Section fieldsOf(SectionKind kind, const T& value) {
    FieldWriter writer;
    put(writer, value);
    writer.bytes.resize(padded(writer.bytes.size()));
    return {kind, std::move(writer.bytes)};
}

void requireUsable(const std::string& what, const std::string& why) {
    if (!why.empty()) throw std::invalid_argument("cook: " + what + " is not usable: " + why);
}

std::vector<Section> sectionsOf(const Cooked& asset) {
    std::vector<Section> sections;
    if (asset.mesh) sections.push_back({SectionKind::mesh, ShapeImage::of(*asset.mesh)});
    for (const ConvexHull& piece : asset.pieces) sections.push_back({SectionKind::piece, ShapeImage::of(piece)});
    if (!asset.clips.empty() && !asset.skeleton)
        throw std::invalid_argument("cook: clips have no skeleton, must have one");
    if (asset.skeleton) {
        requireUsable("skeleton", whyInvalid(*asset.skeleton));
        sections.push_back(fieldsOf(SectionKind::skeleton, *asset.skeleton));
    }
    for (const Clip& clip : asset.clips) {
        requireUsable("clip '" + clip.name + "'", whyInvalid(clip, *asset.skeleton));
        sections.push_back(fieldsOf(SectionKind::clip, clip));
    }
    if (asset.ragdoll) {
        requireUsable("ragdoll", whyInvalid(*asset.ragdoll));
        sections.push_back(fieldsOf(SectionKind::ragdoll, *asset.ragdoll));
    }
    if (asset.robot) {
        requireUsable("robot", whyInvalid(*asset.robot));
        sections.push_back(fieldsOf(SectionKind::robot, *asset.robot));
    }
    return sections;
}

}  // namespace

std::vector<std::byte> cook(const Cooked& asset) {
    const std::vector<Section> sections = sectionsOf(asset);
    if (sections.empty() || sections.size() > kMostSections)
        throw std::invalid_argument("cook: asset has " + std::to_string(sections.size()) +
                                    " sections, must have 1 to " + std::to_string(kMostSections));
    const std::size_t listed = sizeof(CookedHead) + padded(sections.size() * sizeof(CookedSection));
    std::vector<std::byte> bytes(listed);
    for (std::size_t i = 0; i < sections.size(); ++i) {
        const std::vector<std::byte>& part = sections[i].bytes;
        const CookedSection entry{sections[i].kind, 0, bytes.size(), part.size(), ShapeImage::checksum(part)};
        std::memcpy(bytes.data() + sizeof(CookedHead) + i * sizeof entry, &entry, sizeof entry);
        bytes.insert(bytes.end(), part.begin(), part.end());
    }
    CookedHead head;
    head.version = kCookedVersion;
    head.sections = static_cast<std::uint32_t>(sections.size());
    head.size = bytes.size();
    head.sourceHash = asset.sourceHash;
    std::memcpy(bytes.data(), &head, sizeof head);
    head.checksum = ShapeImage::checksum(std::span(bytes).first(listed));
    std::memcpy(bytes.data(), &head, sizeof head);
    return bytes;
}

void saveCooked(const Cooked& asset, const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = cook(asset);
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file.flush()) throw CookedError(path.string() + ": cannot be written");
}

std::uint64_t cookedHash(std::span<const std::byte> bytes) { return ShapeImage::checksum(bytes); }

}  // namespace ragtop
