#include "ragtop/decomposition.h"

#include <gmock/gmock.h>

#include <map>
#include <numbers>
#include <random>

#include "ragtop/world.h"
#include "solids/cut_solid.h"
#include "solids/pieces.h"
#include "solids/point_hull.h"
#include "solids/quick_hull.h"
#include "solids/surface_tree.h"
#include "solids/written_solids.h"

namespace ragtop {
namespace {

double sizeOf(const written::Solid& solid) {
    Bounds bounds{solid.vertices[0], solid.vertices[0]};
    for (const Vec3& v : solid.vertices) bounds = merge(bounds, {v, v});
    const Vec3 extent = bounds.upper - bounds.lower;
    return static_cast<double>(std::max({extent.x, extent.y, extent.z}));
}

PointHull hullOfPiece(const ConvexHull& piece) {
    std::vector<DVec3> points;
    for (const Vec3& v : piece.vertices()) points.emplace_back(v);
    return hullOf(points);
}

/// m, of the vertex that is farthest from being in a piece.
double farthestOutside(const written::Solid& solid, const Decomposition& made) {
    std::vector<PointHull> hulls;
    for (const ConvexHull& piece : made.pieces) hulls.push_back(hullOfPiece(piece));
    double worst = -1;
    for (const Vec3& v : solid.vertices) {
        double least = 1e30;
        for (const PointHull& hull : hulls) least = std::min(least, heightOver(hull, DVec3(v)));
        worst = std::max(worst, least);
    }
    return worst;
}

std::vector<std::vector<Vec3>> verticesOf(const Decomposition& made) {
    std::vector<std::vector<Vec3>> all;
    for (const ConvexHull& piece : made.pieces) all.emplace_back(piece.vertices().begin(), piece.vertices().end());
    return all;
}

TEST(Decomposition, PiecesHoldAllVerticesOfTwentySolidsWithinTheirLimits) {
    // Of n sectors of a ring the chords are r (1 - cos(pi / n)) from its inside, and faces of a hollow ball as far as
    // r · 2 / n at least: 16 pieces leave 6 mm of a spring, 23 mm of a shell. Of a gear of ten teeth
    // they could leave 4 mm: six wedges from teeth to the hole, six sectors between them, and the other teeth.
    // The search does not find these: what it leaves, m, instead of 5 mm, so that it gets no worse unseen.
    const std::map<std::string, double> beyond{{"gear", 0.023}, {"shell", 0.042}, {"spring", 0.012}, {"bowl", 0.038}};
    for (const written::Solid& solid : written::twenty()) {
        const DecompositionOptions options;
        const Decomposition made = decompose(solid.mesh(), options);
        EXPECT_LE(made.pieces.size(), 16u) << solid.name;
        for (const ConvexHull& piece : made.pieces) EXPECT_LE(piece.vertices().size(), 128u) << solid.name;
        EXPECT_LE(farthestOutside(solid, made), 5e-5 * sizeOf(solid)) << solid.name;
        EXPECT_LT(made.volume, 1.3f * made.solidVolume) << solid.name;
        if (const auto left = beyond.find(solid.name); left != beyond.end())
            EXPECT_LE(made.error, left->second) << solid.name;
        else
            EXPECT_TRUE(made.isWithin(options)) << solid.name << " " << made.error << " " << made.volume;
        if (made.error <= options.maxError) {
            EXPECT_LE(made.fewestPieces, static_cast<int>(made.pieces.size())) << solid.name;
        }
    }
}

/// A plate of n teeth takes n + 1 pieces, and with a hole of r = 3 cm n + 6: of six sectors the chords are
/// r (1 - cos(pi / 6)) = 4 mm inside of it. What a plane cuts off with a tooth of those beside it is joined to them.
TEST(Decomposition, OfGearsTakesAToothAtATime) {
    const DecompositionOptions options;
    for (const int teeth : {6, 8, 10, 12, 14}) {
        const Decomposition made = decompose(written::gear(teeth, 0.3, 0.38, 0).mesh(), options);
        EXPECT_TRUE(made.isWithin(options)) << teeth << " " << made.error << " " << made.volume;
    }
    for (const int teeth : {6, 8, 10}) {
        const Decomposition made = decompose(written::gear(teeth, 0.3, 0.38, 0.03).mesh(), options);
        EXPECT_TRUE(made.isWithin(options)) << teeth << " " << made.error << " " << made.volume;
    }
}

/// A piece that holds two points of the inside of a coil holds the way between them. Of seventeen, a sixteenth of the
/// coil apart, each such way leads through air deeper than the error, so that no sixteen pieces hold the coil within
/// it.
TEST(Decomposition, OfASpringTakesMoreThanSixteenPieces) {
    const written::Solid spring = written::byName("spring");
    constexpr int kSides = 10, kInside = 5, kSteps = 60, kPoints = 17, kLooks = 64;
    const std::vector<DVec3> vertices(spring.vertices.begin(), spring.vertices.end());
    const SurfaceTree surface(vertices, spring.triangles);
    const auto inside = [&](double step) {
        const int before = std::min(static_cast<int>(step), kSteps - 1);
        const DVec3 a = vertices[static_cast<std::size_t>(before * kSides + kInside)],
                    b = vertices[static_cast<std::size_t>((before + 1) * kSides + kInside)];
        return a + (step - before) * (b - a);
    };
    const auto deepestBetween = [&](const DVec3& a, const DVec3& b) {
        double deepest = 0;
        for (int k = 1; k < kLooks; ++k) {
            const DVec3 at = a + static_cast<double>(k) / kLooks * (b - a);
            if (surface.winding(at, {0.36, 0.48, 0.8}, 0) == 0) deepest = std::max(deepest, surface.distance(at));
        }
        return deepest;
    };
    constexpr double kApart = static_cast<double>(kSteps) / (kPoints - 1);
    for (int i = 0; i < kPoints; ++i)
        for (int j = 0; j < i; ++j)
            EXPECT_GT(deepestBetween(inside(kApart * i), inside(kApart * j)), DecompositionOptions{}.maxError)
                << i << " " << j;
}

void add(written::Solid& to, const written::Solid& part, const Vec3& at) {
    const auto first = static_cast<std::uint32_t>(to.vertices.size());
    for (const Vec3& v : part.vertices) to.vertices.push_back(v + at);
    for (const Triangle& t : part.triangles) to.triangles.push_back({first + t.a, first + t.b, first + t.c});
}

written::Solid ball(double radius, int around) {
    written::Solid solid{"ball", {{0, static_cast<float>(radius), 0}, {0, static_cast<float>(-radius), 0}}, {}};
    const int rows = around / 2 - 1;
    const auto at = [&](int row, int k) { return static_cast<std::uint32_t>(2 + row * around + k % around); };
    for (int row = 0; row < rows; ++row)
        for (int k = 0; k < around; ++k) {
            const double a = std::numbers::pi * (row + 1) / (rows + 1), b = 2 * std::numbers::pi * k / around;
            solid.vertices.push_back(
                toVec3(radius * DVec3{std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)}));
        }
    for (int k = 0; k < around; ++k) {
        solid.triangles.push_back({0, at(0, k + 1), at(0, k)});
        solid.triangles.push_back({1, at(rows - 1, k), at(rows - 1, k + 1)});
        for (int row = 0; row + 1 < rows; ++row) {
            solid.triangles.push_back({at(row, k), at(row, k + 1), at(row + 1, k)});
            solid.triangles.push_back({at(row + 1, k), at(row, k + 1), at(row + 1, k + 1)});
        }
    }
    return solid;
}

/// Blocks pushed into each other, as modellers build: what is inside of one is no air beside another.
TEST(Decomposition, OfBlocksThatOverlapIsTheBlocks) {
    written::Solid box{"box", {}, {}};
    for (int i = 0; i < 8; ++i) box.vertices.push_back({i & 1 ? 0.5f : 0, i & 2 ? 0.5f : 0, i & 4 ? 0.5f : 0});
    box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    written::Solid many{"blocks", {}, {}};
    for (const Vec3& at : {Vec3{}, Vec3{0.3f, 0.1f, 0.2f}, Vec3{0.6f, 0.2f, -0.1f}, Vec3{0.1f, 0.4f, 0.1f}})
        add(many, box, at);
    const Decomposition made = decompose(many.mesh());
    EXPECT_EQ(made.pieces.size(), 4u);
    EXPECT_NEAR(made.volume, made.solidVolume, 1e-5f);
    EXPECT_LT(made.error, 1e-5f);
}

/// More bodies than pieces: those near each other share one, and none is lost.
TEST(Decomposition, OfAThousandBallsHoldsThemAll) {
    const written::Solid one = ball(0.01, 8);
    written::Solid many{"balls", {}, {}};
    for (int i = 0; i < 1000; ++i) add(many, one, {0.05f * (i % 10), 0.05f * (i / 10 % 10), 0.05f * (i / 100)});
    const Decomposition made = decompose(many.mesh());
    EXPECT_LE(made.pieces.size(), 16u);
    EXPECT_LE(farthestOutside(many, made), 5e-5 * sizeOf(many));
}

/// One hull has too few corners for it: several share the ball.
TEST(Decomposition, OfABallKeepsToTheErrorWithFewCorners) {
    const written::Solid solid = ball(0.5, 60);
    const Decomposition made = decompose(solid.mesh());
    EXPECT_TRUE(made.isWithin({})) << made.error << " " << made.volume / made.solidVolume;
    EXPECT_LE(farthestOutside(solid, made), 5e-5);
    for (const ConvexHull& piece : made.pieces) EXPECT_LE(piece.vertices().size(), 128u);
    EXPECT_EQ(made.fewestPieces, 1);
}

/// Points of which no two fit in one piece: the bars of a frame, the boards of a shelf; of what curves, a point per
/// chord that is the error high, which is 3 times as many in a hollow ball as the pieces allowed.
TEST(Decomposition, TellsHowManyPiecesItTakesAtLeast) {
    const auto fewest = [](const char* name) { return decompose(written::byName(name).mesh()).fewestPieces; };
    EXPECT_EQ(fewest("U"), 3);
    EXPECT_EQ(fewest("frame"), 4);
    EXPECT_EQ(fewest("table"), 5);
    EXPECT_GE(fewest("shelf"), 5);
    EXPECT_LE(fewest("shelf"), 6);
    EXPECT_EQ(fewest("shell"), 17);
    EXPECT_EQ(fewest("bowl"), 17);
}

/// Many points lie in one plane but for rounding, at a cut: no face folds over there.
TEST(PointHull, IsOverAllOfItsPoints) {
    CutSolid ring;
    const written::Solid solid = written::turned(written::byName("torus"), 0.7f);
    for (const Vec3& v : solid.vertices) ring.vertices.emplace_back(v);
    ring.triangles = solid.triangles;
    std::mt19937 random(11);
    std::normal_distribution<double> part(0, 1);
    for (int i = 0; i < 200; ++i) {
        DVec3 n{part(random), part(random), part(random)};
        n = (1 / length(n)) * n;
        const DVec3 at = ring.vertices[random() % ring.vertices.size()];
        for (const std::vector<DVec3>& corners : remainderBelow(ring, {n, dot(n, at)}).corners) {
            const PointHull hull = hullOf(corners);
            if (hull.planes.empty()) continue;
            for (const DVec3& p : corners) ASSERT_LT(heightOver(hull, p), 2e-5) << i;
        }
    }
}

/// Cuts through the corners of a ring fit it however it lies; those across it alone would leave uneven sectors.
TEST(Decomposition, OfRoundSolidsKeepsToTheLimitsHoweverTheyLie) {
    for (const char* name : {"torus", "pipe", "cup", "dumbbell"}) {
        const written::Solid solid = written::turned(written::byName(name), 1.1f);
        const Decomposition made = decompose(solid.mesh());
        EXPECT_TRUE(made.isWithin({})) << name << " " << made.error << " " << made.volume / made.solidVolume;
        EXPECT_LE(farthestOutside(solid, made), 5e-5 * sizeOf(solid)) << name;
    }
}

/// Sectors of 20, 140 and 20 degrees become about alike: chords of 60 degrees are 0.2 (1 - cos 30°) from the inside.
TEST(EvenOut, MovesBordersOutOfTheDeepestPiece) {
    CutSolid pipe;
    const written::Solid solid = written::byName("pipe");
    for (const Vec3& v : solid.vertices) pipe.vertices.emplace_back(v);
    pipe.triangles = solid.triangles;
    const auto through = [](double degrees) {  // the vertical plane of a direction; below it is what comes before
        const double a = degrees * std::numbers::pi / 180;
        return DPlane{{-std::sin(a), 0, std::cos(a)}, 0};
    };
    const CutSolid half = partBelow(pipe, flipped(through(0)));
    std::vector<Piece> pieces;
    for (CutSolid part : {partBelow(half, through(20)), partBelow(partBelow(half, flipped(through(20))), through(160)),
                          partBelow(half, flipped(through(160)))}) {
        PointHull hull = hullOf(part.vertices);
        pieces.push_back({{std::move(part)}, std::move(hull)});
    }
    const Air air(half);
    const auto deepest = [&] {
        double most = 0;
        for (const Piece& piece : pieces) most = std::max(most, air.depthIn(piece.hull, 1e9));
        return most;
    };
    const double before = deepest(), volume = volumeOf(half), even = 0.2 * (1 - std::cos(std::numbers::pi / 6));
    EXPECT_GT(before, 3 * even);
    evenOut(pieces, volume, {3, 0.01, volume}, air, serialTasks());
    EXPECT_LT(deepest(), 1.3 * even);
    double sum = 0;
    for (const Piece& piece : pieces)
        for (const CutSolid& part : piece.solids) sum += volumeOf(part);
    EXPECT_NEAR(sum, volume, 1e-12);
}

TEST(QuickHull, HasTheVolumeOfQhullOrSaysNothing) {
    std::mt19937 random(5);
    std::normal_distribution<double> part(0, 0.3);
    int found = 0;
    const auto compare = [&](const std::vector<DVec3>& points) {
        const std::size_t triangles = quickHull(points).size();
        if (triangles == 0) return;
        ++found;
        EXPECT_NEAR(hullSize(points).volume, hullOf(points).volume, 1e-6);
    };
    for (std::size_t count = 4; count < 200; ++count) {
        std::vector<DVec3> points;
        while (points.size() < count) points.push_back({part(random), part(random), part(random)});
        compare(points);
    }
    EXPECT_EQ(found, 196);
    for (const written::Solid& solid : written::twenty()) {
        std::vector<DVec3> points;
        for (const Vec3& v : solid.vertices) points.emplace_back(v);
        compare(points);
    }
    EXPECT_TRUE(quickHull({}).empty());
    EXPECT_TRUE(quickHull(std::vector<DVec3>(9, {1, 2, 3})).empty());
    EXPECT_TRUE(quickHull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.3, 0.2, 0}}).empty());
    EXPECT_TRUE(quickHull({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}).empty());
}

/// Cuts run along the faces, so that pieces are as exact as these; in a grid of cells they would have steps.
TEST(Decomposition, OfFlatFacesHasTheVolumeOfTheSolid) {
    for (const char* name : {"chair", "table", "L", "T", "U", "H", "E", "stairs", "frame", "shelf", "cross"}) {
        const written::Solid solid = written::turned(written::byName(name), 1.1f);
        const Decomposition made = decompose(solid.mesh(), {.maxVolume = 1.01f});
        EXPECT_NEAR(made.volume, made.solidVolume, 2e-3f * made.solidVolume) << name;
        EXPECT_LT(made.error, 1e-3f) << name;
    }
    EXPECT_EQ(decompose(written::byName("table").mesh()).pieces.size(), 5u);
    EXPECT_EQ(decompose(written::byName("frame").mesh()).pieces.size(), 4u);
    EXPECT_EQ(decompose(written::byName("shelf").mesh()).pieces.size(), 6u);
}

TEST(Decomposition, KeepsToOtherErrorsAndNumbers) {
    const TriangleMesh ring = written::byName("torus").mesh();
    std::size_t before = 0;
    for (const float error : {0.1f, 0.03f, 0.01f}) {
        const DecompositionOptions options{.maxPieces = 32, .maxError = error, .maxVolume = 2};
        const Decomposition made = decompose(ring, options);
        EXPECT_LE(made.error, error);
        EXPECT_GE(made.pieces.size(), before) << error;
        before = made.pieces.size();
    }
    EXPECT_EQ(decompose(ring, {.maxPieces = 1}).pieces.size(), 1u);
    EXPECT_LE(decompose(ring, {.maxPieces = 5}).pieces.size(), 5u);
    const Decomposition coarse = decompose(ring, {.maxVertices = 12});
    for (const ConvexHull& piece : coarse.pieces) EXPECT_LE(piece.vertices().size(), 12u);
    EXPECT_LE(farthestOutside(written::byName("torus"), coarse), 5e-5);
}

TEST(Decomposition, InOnePieceIsTheHull) {
    for (const char* name : {"L", "star", "spring"}) {
        const written::Solid solid = written::byName(name);
        std::vector<DVec3> points;
        for (const Vec3& v : solid.vertices) points.emplace_back(v);
        const Decomposition made = decompose(solid.mesh(), {.maxPieces = 1, .maxVertices = 128});
        ASSERT_EQ(made.pieces.size(), 1u);
        const PointHull hull = hullOf(points);
        // Corners that have to be left out are made up for by others, which move outwards.
        const double more = hull.points.size() <= 128 ? 1e-4 : 0.05;
        EXPECT_GE(static_cast<double>(made.volume), (1 - 1e-4) * hull.volume) << name;
        EXPECT_LE(static_cast<double>(made.volume), (1 + more) * hull.volume) << name;
    }
}

TEST(Decomposition, ScalesWithTheSolidToTheBit) {
    for (const char* name : {"chair", "pipe"}) {
        const written::Solid solid = written::turned(written::byName(name), 0.4f);
        const auto one = verticesOf(decompose(solid.mesh()));
        for (const float scale : {1.0f / 1024, 2048.0f}) {  // millimetres and kilometres
            written::Solid other = solid;
            for (Vec3& v : other.vertices) v = scale * v;
            auto pieces = verticesOf(decompose(other.mesh(), {.maxError = 0.005f * scale}));
            for (auto& piece : pieces)
                for (Vec3& v : piece) v = (1 / scale) * v;
            EXPECT_EQ(pieces, one) << name << " " << scale;
        }
    }
}

TEST(Decomposition, IsTheSameWithAnyTasks) {
    const TriangleMesh mesh = written::turned(written::byName("pipe"), 0.3f).mesh();
    const auto serial = verticesOf(decompose(mesh));
    for (const int workers : {2, 3, 7}) {
        EXPECT_EQ(verticesOf(decompose(mesh, {}, tbbTasks(workers))), serial);
        EXPECT_EQ(verticesOf(decompose(mesh, {}, threadTasks(workers))), serial);
    }
}

/// Doubled vertices, triangles without area and faces in many parts change nothing about a solid.
TEST(Decomposition, TakesRoughTriangles) {
    written::Solid solid = written::byName("U");
    const std::size_t count = solid.triangles.size();
    for (std::size_t i = 0; i < count; ++i) {  // each triangle in three parts, one of them with vertices of its own
        const Triangle t = solid.triangles[i];
        const Vec3 a = solid.vertices[t.a], b = solid.vertices[t.b], c = solid.vertices[t.c];
        const auto first = static_cast<std::uint32_t>(solid.vertices.size());
        solid.vertices.insert(solid.vertices.end(), {0.25f * a + 0.25f * b + 0.5f * c, a, b});
        solid.triangles[i] = {first + 1, first + 2, first};
        solid.triangles.push_back({t.b, t.c, first});
        solid.triangles.push_back({t.c, t.a, first});
        solid.triangles.push_back({first, first, t.a});
    }
    const Decomposition made = decompose(solid.mesh());
    EXPECT_EQ(made.pieces.size(), 3u);
    EXPECT_NEAR(made.volume, made.solidVolume, 1e-4f * made.solidVolume);
}

TEST(Decomposition, ThinWallsStayThin) {
    // A tray of sheet metal, 1 mm thick.
    const written::Solid tray = written::cup(0.1, 0.001, 0.05, 4);
    const Decomposition made = decompose(tray.mesh());
    EXPECT_EQ(made.pieces.size(), 5u);
    EXPECT_LE(farthestOutside(tray, made), 5e-5 * sizeOf(tray));
    EXPECT_NEAR(made.volume, made.solidVolume, 0.02f * made.solidVolume);
}

TEST(Decomposition, OfAHollowBallLeavesItHollow) {
    const written::Solid shell = written::byName("shell");
    const Decomposition made = decompose(shell.mesh(), {.maxPieces = 24, .maxError = 0.1f});
    for (const ConvexHull& piece : made.pieces) EXPECT_GT(heightOver(hullOfPiece(piece), {0, 0, 0}), 0.02);
}

TEST(Decomposition, RefusesWhatIsNoSolidInOneLine) {
    const auto complaint = [](const TriangleMesh& mesh, const DecompositionOptions& options = {}) {
        try {
            decompose(mesh, options);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    written::Solid solid = written::byName("L");
    written::Solid open = solid;
    open.triangles.pop_back();
    EXPECT_THAT(complaint(open.mesh()), testing::HasSubstr("is open at the edge of vertices"));
    written::Solid inside = solid;
    for (Triangle& t : inside.triangles) std::swap(t.b, t.c);
    EXPECT_THAT(complaint(inside.mesh()), testing::HasSubstr("clockwise seen from outside"));
    for (const float size : {1e-20f, 1e20f}) {
        written::Solid scaled = solid;
        for (Vec3& v : scaled.vertices) v = size * v;
        EXPECT_THAT(complaint(scaled.mesh()), testing::HasSubstr("must be in [1e-30, 1e+30] m³")) << size;
    }
    EXPECT_THAT(complaint(solid.mesh(), {.maxPieces = 0}), testing::HasSubstr("maxPieces is 0, must be in [1, 256]"));
    EXPECT_THAT(complaint(solid.mesh(), {.maxError = std::nanf("")}), testing::HasSubstr("maxError is nan"));
    for (const std::string& line : {complaint(open.mesh()), complaint(inside.mesh())})
        EXPECT_EQ(line.find('\n'), std::string::npos);
}

/// Vertices of no triangle, triangles that are a point or a line, and two of them back to back that reach out of the
/// solid are no part of it.
TEST(Decomposition, LeavesOutWhatHasNoArea) {
    const written::Solid solid = written::byName("L");
    const Decomposition plain = decompose(solid.mesh(), {});
    const auto last = static_cast<std::uint32_t>(solid.vertices.size());
    const Vec3 &a = solid.vertices[0], &b = solid.vertices[1];
    std::vector<written::Solid> made(4, solid);
    for (written::Solid& each : made) each.vertices.push_back(a + 3 * (b - a));
    made[1].triangles.push_back({0, 0, 1});
    made[1].triangles.push_back({last, last, last});
    made[2].triangles.insert(made[2].triangles.end(), {{0, 1, last}, {0, last, 1}});
    made[3].triangles.insert(made[3].triangles.begin(), {{last, 1, 0}, {last, 0, 1}, {1, 1, 1}});
    for (const written::Solid& each : made) {
        const Decomposition now = decompose(each.mesh(), {});
        EXPECT_EQ(verticesOf(now), verticesOf(plain));
        EXPECT_EQ(now.error, plain.error);
    }
}

TEST(CutSolid, CutsKeepTheVolumeAndHullsHoldIt) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> part(-1, 1);
    for (const written::Solid& solid : written::twenty()) {
        CutSolid whole;
        for (const Vec3& v : solid.vertices) whole.vertices.emplace_back(v);
        whole.triangles = solid.triangles;
        const double volume = volumeOf(whole);
        std::vector<CutSolid> parts{whole};
        for (int k = 0; k < 6; ++k) {
            DVec3 n{part(random), part(random), part(random)};
            if (k < 3) n = {k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0};  // along faces where there are any
            n = (1 / length(n)) * n;
            const DPlane plane{n, dot(n, DVec3(solid.vertices[random() % solid.vertices.size()]))};
            std::vector<CutSolid> next;
            for (const CutSolid& each : parts) {
                const CutSolid below = partBelow(each, plane), above = partBelow(each, flipped(plane));
                EXPECT_NEAR(volumeOf(below) + volumeOf(above), volumeOf(each), 1e-12) << solid.name;
                EXPECT_NEAR(remainderBelow(each, plane).volume, volumeOf(below), 1e-12) << solid.name;
                for (CutSolid half : {below, above})
                    for (CutSolid& one : separated(std::move(half))) next.push_back(std::move(one));
            }
            parts = std::move(next);
        }
        double sum = 0;
        for (const CutSolid& each : parts) {
            sum += volumeOf(each);
            EXPECT_GT(hullOf(each.vertices).volume, volumeOf(each) - 1e-7) << solid.name;
        }
        EXPECT_NEAR(sum, volume, 1e-12) << solid.name;
    }
}

/// A ball that fits with room to spare lies on the floor of the cup, and stays there when the cup is let fall.
TEST(Decomposition, ABallRestsInTheCup) {
    for (const bool falls : {false, true}) {
        World world;
        BodyDef ground;
        ground.type = BodyType::fixed;
        ground.shapes = {{.geometry = Box{{2, 0.5f, 2}}}};
        ground.pose.position = {0, -0.5, 0};
        world.create(ground);
        BodyDef cup;
        cup.type = falls ? BodyType::dynamic : BodyType::fixed;
        cup.shapes = {{.geometry = compoundOf(decompose(written::byName("cup").mesh()))}};
        cup.pose.position = {0, falls ? 0.02 : 0, 0};
        const BodyId held = world.create(cup);
        BodyDef ball;
        ball.shapes = {{.geometry = Sphere{0.025f}}};
        ball.pose.position = {0.004, 0.06, 0.003};
        const BodyId dropped = world.create(ball);
        for (int i = 0; i < 180; ++i) world.step(1.0f / 60);
        const DVec3 at = world.pose(dropped).position, floor = world.pose(held).position;
        constexpr double kWall = 0.006, kRadius = 0.025, kSlack = 5e-4;
        EXPECT_NEAR(at.y - floor.y, kWall + kRadius, kSlack) << falls;
        EXPECT_LT(std::hypot(at.x - floor.x, at.z - floor.z), 0.04 - kRadius + kSlack) << falls;
    }
}

}  // namespace
}  // namespace ragtop
