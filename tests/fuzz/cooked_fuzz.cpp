#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <span>

#include "layout.h"
#include "ragtop/cooked.h"
#include "ragtop/shape_image.h"

namespace {

/// One section of the input's first kind, with the rest of it in it, and checksums that fit: what is behind them is
/// read.
struct AroundInput {
    std::size_t size;
    std::unique_ptr<std::byte, void (*)(std::byte*)> bytes;

    AroundInput(const std::uint8_t* input, std::size_t count)
        : size(2 * ragtop::kCookedAlignment + ragtop::padded(count)),
          bytes(static_cast<std::byte*>(::operator new(size, kAlignment)),
                [](std::byte* at) { ::operator delete(at, kAlignment); }) {
        std::fill_n(bytes.get(), size, std::byte{0});
        constexpr std::uint32_t kKinds = 6;
        std::memcpy(bytes.get() + 2 * ragtop::kCookedAlignment, input, count);
        const std::span<const std::byte> part(bytes.get() + 2 * ragtop::kCookedAlignment, ragtop::padded(count));
        ragtop::CookedSection section{static_cast<ragtop::SectionKind>(1 + input[count - 1] % kKinds), 0,
                                      2 * ragtop::kCookedAlignment, part.size(), ragtop::ShapeImage::checksum(part)};
        ragtop::CookedHead head;
        head.version = ragtop::kCookedVersion;
        head.sections = 1;
        head.size = size;
        std::memcpy(bytes.get(), &head, sizeof head);
        std::memcpy(bytes.get() + sizeof head, &section, sizeof section);
        head.checksum = ragtop::ShapeImage::checksum({bytes.get(), 2 * ragtop::kCookedAlignment});
        std::memcpy(bytes.get(), &head, sizeof head);
    }

private:
    static constexpr std::align_val_t kAlignment{ragtop::kCookedAlignment};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
    if (count == 0) return 0;
    const AroundInput file(bytes, count);
    try {
        ragtop::readCooked({file.bytes.get(), file.size}, nullptr, "fuzz");
    } catch (const ragtop::CookedError&) {
    }
    return 0;
}
