#include "clip_curve.h"

#include <algorithm>

namespace ragtop {
namespace {

struct Layout {
    CurveKey lowest{};
    unsigned lowWidth = 0;
    std::array<unsigned, 3> widths{};
    CurveMarks marks = CurveMarks::all;
    std::size_t marksBits = 0;

    unsigned keyBits() const { return widths[0] + widths[1] + widths[2]; }
};

Layout layoutOf(const ClipCurve& curve, std::size_t timeCount) {
    Layout layout{curve.keys[0]};
    CurveKey most = curve.keys[0];
    for (const CurveKey& key : curve.keys)
        for (std::size_t i = 0; i < 3; ++i) {
            layout.lowest[i] = std::min(layout.lowest[i], key[i]);
            most[i] = std::max(most[i], key[i]);
        }
    for (std::size_t i = 0; i < 3; ++i) {
        layout.lowWidth = std::max(layout.lowWidth, signedWidth(layout.lowest[i]));
        layout.widths[i] =
            static_cast<unsigned>(std::bit_width(static_cast<std::uint32_t>(most[i] - layout.lowest[i])));
    }
    if (curve.kind == CurveKind::constant)
        layout.lowWidth = *std::lower_bound(kStillWidths.begin(), kStillWidths.end(), layout.lowWidth);
    if (curve.keys.size() == timeCount || curve.kind == CurveKind::constant) return layout;
    const std::size_t bits = timeCount + kRankBits * rankCount(timeCount),
                      list = curve.keys.size() * listWidth(timeCount);
    layout.marks = list < bits ? CurveMarks::list : CurveMarks::bits;
    layout.marksBits = std::min(list, bits);
    return layout;
}

void writeMarks(const ClipCurve& curve, CurveMarks marks, std::size_t timeCount, BitWriter& into) {
    if (marks == CurveMarks::list)
        for (const std::uint16_t at : curve.at) into.put(at, listWidth(timeCount));
    if (marks != CurveMarks::bits) return;
    std::vector<std::uint64_t> ranks;
    std::size_t next = 0;
    for (std::size_t i = 0; i < timeCount; ++i) {
        if (i > 0 && i % kMarked == 0) ranks.push_back(next);
        const bool has = next < curve.at.size() && curve.at[next] == i;
        into.put(has ? 1 : 0, 1);
        next += has ? 1 : 0;
    }
    for (const std::uint64_t rank : ranks) into.put(rank, kRankBits);
}

}  // namespace

std::size_t bitsOf(const ClipCurve& curve, std::size_t timeCount) {
    if (curve.kind == CurveKind::none) return 0;
    const Layout layout = layoutOf(curve, timeCount);
    const std::size_t lows = kStepBits + 3 * layout.lowWidth;
    if (curve.kind == CurveKind::constant) return lows + kStillWidthBits;
    return lows + kWidthBits + 3 * kWidthBits + kCountBits + kMarksBits + layout.marksBits +
           curve.keys.size() * layout.keyBits();
}

void write(const ClipCurve& curve, std::size_t timeCount, BitWriter& into) {
    if (curve.kind == CurveKind::none) return;
    const Layout layout = layoutOf(curve, timeCount);
    into.put(curve.step, kStepBits);
    if (curve.kind == CurveKind::constant) {
        const auto width = std::lower_bound(kStillWidths.begin(), kStillWidths.end(), layout.lowWidth);
        into.put(static_cast<std::uint64_t>(width - kStillWidths.begin()), kStillWidthBits);
    } else {
        into.put(layout.lowWidth, kWidthBits);
    }
    for (const std::int32_t low : layout.lowest)
        into.put(static_cast<std::uint32_t>(low - lowestOf(layout.lowWidth)), layout.lowWidth);
    if (curve.kind == CurveKind::constant) return;
    for (const unsigned width : layout.widths) into.put(width, kWidthBits);
    into.put(curve.keys.size() - 1, kCountBits);
    into.put(static_cast<std::uint64_t>(layout.marks), kMarksBits);
    writeMarks(curve, layout.marks, timeCount, into);
    for (const CurveKey& key : curve.keys)
        for (std::size_t i = 0; i < 3; ++i)
            into.put(static_cast<std::uint32_t>(key[i] - layout.lowest[i]), layout.widths[i]);
}

}  // namespace ragtop
