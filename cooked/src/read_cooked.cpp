#include <cstring>

#include "layout.h"
#include "mapped_file.h"
#include "ragdoll_bytes.h"
#include "ragtop/cooked.h"
#include "ragtop/shape_image.h"

namespace ragtop {
namespace {

/// Reads a file that is in memory.
class CookedReader {
public:
    CookedReader(std::span<const std::byte> bytes, std::shared_ptr<const void> owner, const std::string& name)
        : bytes_(bytes), owner_(std::move(owner)), name_(name) {}

    Cooked read() {
        const CookedHead head = readHead();
        result_.sourceHash = head.sourceHash;
        for (std::uint32_t i = 0; i < head.sections; ++i) {
            CookedSection section;
            std::memcpy(&section, bytes_.data() + sizeof head + i * sizeof section, sizeof section);
            add(i, section);
        }
        check();
        return std::move(result_);
    }

private:
    [[noreturn]] void fail(const std::string& why) const { throw CookedError(name_ + ": " + why); }

    CookedHead readHead() const {
        if (bytes_.size() < sizeof kCookedMagic || std::memcmp(bytes_.data(), &kCookedMagic, sizeof kCookedMagic) != 0)
            fail("is no cooked file: it does not begin with RAGTOP");
        CookedHead head;
        if (bytes_.size() < sizeof head) fail(cut(sizeof head));
        std::memcpy(&head, bytes_.data(), sizeof head);
        if (head.version != kCookedVersion)
            fail("has version " + std::to_string(head.version) + ", must have " + std::to_string(kCookedVersion) +
                 "; cook it again");
        const std::size_t listed = sizeof head + padded(std::min(head.sections, kMostSections) * sizeof(CookedSection));
        if (bytes_.size() < listed || head.size > bytes_.size()) fail(cut(std::max<std::uint64_t>(listed, head.size)));
        std::vector<std::byte> known(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(listed));
        CookedHead without = head;
        without.checksum = 0;
        std::memcpy(known.data(), &without, sizeof without);
        if (head.sections == 0 || head.sections > kMostSections || ShapeImage::checksum(known) != head.checksum)
            fail("is damaged: the checksum of its head is wrong");
        if (head.size != bytes_.size())
            fail("has " + std::to_string(bytes_.size()) + " bytes, must have " + std::to_string(head.size));
        return head;
    }
    std::string cut(std::uint64_t needed) const {
        return "is cut short: has " + std::to_string(bytes_.size()) + " bytes of " + std::to_string(needed);
    }

    void add(std::uint32_t number, const CookedSection& section) {
        const std::string what = "section " + std::to_string(number);
        if (section.offset % kCookedAlignment != 0 || section.offset > bytes_.size() ||
            section.size > bytes_.size() - section.offset)
            fail(what + " is not within the file");
        const std::span<const std::byte> part = bytes_.subspan(section.offset, section.size);
        if (ShapeImage::checksum(part) != section.checksum) fail("is damaged: the checksum of " + what + " is wrong");
        try {
            add(section.kind, part);
        } catch (const std::invalid_argument& error) {
            fail(what + " " + error.what());
        }
    }

    void add(SectionKind kind, std::span<const std::byte> part) {
        FieldReader fields(part);
        switch (kind) {
            case SectionKind::mesh:
                result_.mesh = ShapeImage::mesh(part, owner_);
                return;
            case SectionKind::piece:
                result_.pieces.push_back(ShapeImage::hull(part));
                return;
            case SectionKind::skeleton:
                result_.skeleton = getSkeleton(fields);
                return;
            case SectionKind::clip:
                result_.clips.push_back(getClip(fields));
                return;
            case SectionKind::ragdoll:
                result_.ragdoll = getRagdoll(fields);
                return;
            case SectionKind::robot:
                result_.robot = getRobot(fields);
                result_.robot->file = name_;
                return;
        }
        throw std::invalid_argument("is of kind " + std::to_string(static_cast<std::uint32_t>(kind)) +
                                    ", must be of 1 to 6");
    }

    void check() const {
        if (result_.skeleton) require("skeleton", whyInvalid(*result_.skeleton));
        if (!result_.clips.empty() && !result_.skeleton) fail("has clips, must have their skeleton");
        for (const Clip& clip : result_.clips) require("clip '" + clip.name + "'", whyInvalid(clip, *result_.skeleton));
        if (result_.ragdoll) require("ragdoll", whyInvalid(*result_.ragdoll));
        if (result_.robot) require("robot", whyInvalid(*result_.robot));
    }
    void require(const std::string& what, const std::string& why) const {
        if (!why.empty()) fail(what + " is not usable: " + why);
    }

    std::span<const std::byte> bytes_;
    std::shared_ptr<const void> owner_;
    const std::string& name_;
    Cooked result_;
};

}  // namespace

Cooked readCooked(std::span<const std::byte> bytes, std::shared_ptr<const void> owner, const std::string& name) {
    if (reinterpret_cast<std::uintptr_t>(bytes.data()) % kCookedAlignment != 0)
        throw CookedError(name + ": is not aligned to " + std::to_string(kCookedAlignment) + " bytes");
    return CookedReader(bytes, std::move(owner), name).read();
}

Cooked loadCooked(const std::filesystem::path& path) {
    const MappedFile file = mapFile(path);
    return readCooked(file.bytes, file.owner, path.string());
}

}  // namespace ragtop
