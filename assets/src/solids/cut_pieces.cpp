#include <algorithm>

#include "solids/few_corners.h"
#include "solids/pieces.h"

namespace ragtop {
namespace {

constexpr std::size_t kSpare = 2;      // cuts go on to so many times the pieces allowed: joining finds the better ones
constexpr double kAirOfCutting = 0.3;  // of the air allowed: the rest is for joining

struct Uncut {
    CutSolid solid;
    PointHull hull;
    double air = 0, volume = 0;
    bool done = false;

    Uncut(CutSolid s, const PieceLimits& limits)
        : solid(std::move(s)), hull(hullOf(solid.vertices)), volume(volumeOf(solid)) {
        air = std::max(0.0, hull.volume - volume) + airOfFewCorners(hull.volume, hull.points.size(), limits.corners);
    }
};

/// That with most air of those not done, by which of them exceed the error where there is little air.
Uncut* worst(std::vector<Uncut>& pieces, const PieceLimits& limits, const Air& air) {
    double total = 0;
    for (const Uncut& piece : pieces) total += piece.air;
    Uncut* found = nullptr;
    for (Uncut& piece : pieces) {
        if (piece.done || (found && piece.air <= found->air)) continue;
        constexpr double kNoAir = 1e-6;  // of the piece
        const bool none = piece.air <= kNoAir * piece.volume;
        if (none || total <= kAirOfCutting * limits.air) {
            const PointHull few = withFewCorners(piece.hull, limits.corners);
            const bool exact = none && few.points.size() == piece.hull.points.size();
            piece.done = exact || air.depthIn(few, limits.error) <= limits.error;
        }
        if (piece.done) continue;
        found = &piece;
    }
    return found;
}

std::vector<Piece> copyOf(const std::vector<Uncut>& uncut) {
    std::vector<Piece> pieces;
    for (const Uncut& piece : uncut) pieces.push_back({{piece.solid}, piece.hull});
    return pieces;
}

/// Replaces a piece by what a cut makes of it.
void cut(std::vector<Uncut>& pieces, std::size_t at, const DPlane& plane, const PieceLimits& limits) {
    const Uncut whole = std::move(pieces[at]);
    pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(at));
    for (const DPlane& side : {plane, flipped(plane)})
        for (CutSolid& rest : separated(partBelow(whole.solid, side))) pieces.emplace_back(std::move(rest), limits);
}

}  // namespace

void cutToPieces(CutSolid solid, CutOrder order, const PieceLimits& limits, const Air& air, const TaskRunner& tasks,
                 const std::function<bool(std::vector<Piece>)>& isEnough) {
    std::vector<Uncut> pieces;
    for (CutSolid& part : bodiesOf(std::move(solid), 2 * kSpare * limits.pieces))
        pieces.emplace_back(std::move(part), limits);
    std::size_t next = limits.pieces;
    while (pieces.size() < kSpare * limits.pieces) {
        Uncut* piece = worst(pieces, limits, air);
        if (!piece) break;
        const std::optional<DPlane> plane = bestCut(piece->solid, order, limits.corners, tasks);
        if (!plane) {
            piece->done = true;
            continue;
        }
        if (pieces.size() >= next) {
            if (isEnough(copyOf(pieces))) return;
            next = pieces.size() + (limits.pieces + 1) / 2;
        }
        cut(pieces, static_cast<std::size_t>(piece - pieces.data()), *plane, limits);
    }
    isEnough(copyOf(pieces));
}

}  // namespace ragtop
