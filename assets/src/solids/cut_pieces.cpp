#include <algorithm>

#include "solids/pieces.h"

namespace ragtop {
namespace {

constexpr std::size_t kSpare = 2;      // cuts go on to so many times the pieces allowed: joining finds the better ones
constexpr double kAirOfCutting = 0.3;  // of the air allowed: the rest is for joining

struct Piece {
    CutSolid solid;
    PointHull hull;
    double volume = 0;
    bool done = false;

    explicit Piece(CutSolid s) : solid(std::move(s)), hull(hullOf(solid.vertices)), volume(volumeOf(solid)) {}
    double air() const { return std::max(0.0, hull.volume - volume); }
};

/// That with most air of those not done, by which of them exceed the error where there is little air.
Piece* worst(std::vector<Piece>& pieces, const PieceLimits& limits, const Air& air) {
    double total = 0;
    for (const Piece& piece : pieces) total += piece.air();
    Piece* found = nullptr;
    for (Piece& piece : pieces) {
        if (piece.done || (found && piece.air() <= found->air())) continue;
        constexpr double kNoAir = 1e-6;  // of the piece
        if (piece.air() <= kNoAir * piece.volume) {
            piece.done = true;
            continue;
        }
        if (total <= kAirOfCutting * limits.air && air.depthIn(piece.hull, limits.error) <= limits.error) {
            piece.done = true;
            continue;
        }
        found = &piece;
    }
    return found;
}

std::vector<PointHull> hullsOf(const std::vector<Piece>& pieces) {
    std::vector<PointHull> hulls;
    for (const Piece& piece : pieces) hulls.push_back(piece.hull);
    return hulls;
}

/// Replaces a piece by what a cut makes of it.
void cut(std::vector<Piece>& pieces, std::size_t at, const DPlane& plane) {
    const Piece whole = std::move(pieces[at]);
    pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(at));
    for (const DPlane& side : {plane, flipped(plane)})
        for (CutSolid& rest : separated(partBelow(whole.solid, side))) pieces.emplace_back(std::move(rest));
}

}  // namespace

void cutToPieces(CutSolid solid, const PieceLimits& limits, const Air& air, const TaskRunner& tasks,
                 const std::function<bool(std::vector<PointHull>)>& isEnough) {
    std::vector<Piece> pieces;
    for (CutSolid& part : separated(std::move(solid))) pieces.emplace_back(std::move(part));
    std::size_t next = limits.pieces;
    while (pieces.size() < kSpare * limits.pieces) {
        Piece* piece = worst(pieces, limits, air);
        if (!piece) break;
        const std::optional<DPlane> plane = bestCut(piece->solid, tasks);
        if (!plane) {
            piece->done = true;
            continue;
        }
        if (pieces.size() >= next) {
            if (isEnough(hullsOf(pieces))) return;
            next = pieces.size() + (limits.pieces + 1) / 2;
        }
        cut(pieces, static_cast<std::size_t>(piece - pieces.data()), *plane);
    }
    isEnough(hullsOf(pieces));
}

}  // namespace ragtop
