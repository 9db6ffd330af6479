#include "ragtop/cloth.h"

#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <vector>

#include "heap_counter.h"
#include "world_support.h"

namespace ragtop::test::cloth_laws {
namespace {

ClothDef withoutAir(ClothDef def) {
    def.airDensity = 0;
    return def;
}

/// A square of 1 m and 1,024 points that hangs by its first row.
ClothDef hangingSquare() {
    ClothDef def = withoutAir(clothSheet(32, 32, {1, 0, 0}, {0, -1, 0}));
    for (int i = 0; i < 32; ++i) def.attachments.push_back({i});
    return def;
}

void runFor(World& world, double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / kDt); ++i) world.step(kDt);
}

double lengthOf(const Cloth& cloth, int a, int b) { return length(relative(cloth.point(a), cloth.point(b))); }

/// Of all sides of faces and lines, over their lengths at rest.
double largestStretch(const Cloth& cloth) {
    const ClothDef& def = cloth.def();
    double largest = 0;
    const auto look = [&](int a, int b) {
        const float rest = length(def.points[static_cast<std::size_t>(a)] - def.points[static_cast<std::size_t>(b)]);
        largest = std::max(largest, lengthOf(cloth, a, b) / rest - 1);
    };
    for (const ClothFace& face : def.faces) {
        look(face.a, face.b);
        look(face.b, face.c);
        if (face.d >= 0) look(face.c, face.d);
        look(face.d >= 0 ? face.d : face.c, face.a);
    }
    for (const ClothLine& line : def.lines) look(line.a, line.b);
    return largest;
}

DVec3 momentumOf(const Cloth& cloth) {
    DVec3 sum;
    for (int i = 0; i < cloth.pointCount(); ++i)
        sum = sum + static_cast<double>(cloth.mass(i)) * DVec3(cloth.velocity(i));
    return sum;
}

double mechanicalEnergy(const Cloth& cloth) {
    double sum = 0;
    for (int i = 0; i < cloth.pointCount(); ++i)
        sum += cloth.mass(i) * (0.5 * lengthSquared(cloth.velocity(i)) + kGravity * cloth.point(i).y);
    return sum;
}

/// Of what swings through zero.
template <class Read>
double periodOf(World& world, int steps, Read&& read) {
    std::vector<double> crossings;
    for (int i = 0; i < steps; ++i) {
        const double before = read();
        world.step(kDt);
        const double now = read();
        if (before < 0 && now >= 0) crossings.push_back(world.time() - kDt * now / (now - before));
    }
    EXPECT_GE(crossings.size(), 3u);
    return (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
}

double weightOf(const Cloth& cloth) {
    double sum = 0;
    for (int i = 0; i < cloth.pointCount(); ++i) sum += cloth.mass(i) * kGravity;
    return sum;
}

/// A strip whose weight stretches it by ρ g L²/2K, as each piece bears what hangs below it.
TEST(Cloth, AHangingStripStretchesByItsWeight) {
    World world(withoutSleep());
    ClothDef def = withoutAir(clothSheet(5, 33, {0.1f, 0, 0}, {0, -1, 0}));
    def.stretch = 40;
    def.shear = 0;
    def.tethers = false;
    def.damping = 1;
    for (int i = 0; i < 5; ++i) def.attachments.push_back({i});
    Cloth cloth(world, def);
    runFor(world, 15);
    const double expected = def.density * kGravity / (2 * def.stretch);
    EXPECT_NEAR(-cloth.point(32 * 5 + 2).y - 1, expected, 0.02 * expected);
}

/// One quad with its upper side held: the lower one, of half the mass, swings with ½ G γ² A, γ = x/L.
TEST(Cloth, AShearedQuadSwingsWithItsShearStiffness) {
    World world(withoutSleep());
    ClothDef def = withoutAir(clothSheet(2, 2, {0.5f, 0, 0}, {0, -1, 0}));
    def.shear = 10;
    def.tethers = false;
    def.gravityScale = 0;
    def.attachments = {{0}, {1}};
    Cloth cloth(world, def);
    cloth.push({0.1f, 0, 0});
    const double period = periodOf(world, 240, [&] { return cloth.point(2).x; });
    EXPECT_NEAR(period, 2 * 3.14159265 / std::sqrt(2 * def.shear / def.density), 0.02 * period);
    EXPECT_NEAR(cloth.point(2).x, cloth.point(3).x - 0.5, 1e-4);
}

/// A strip that two of its rows clamp: at each point l² κ = l² M/B, with M the moment of the weights beyond it.
TEST(Cloth, AClampedStripBendsByItsWeight) {
    World world(withoutSleep());
    constexpr int kRows = 9;
    const float l = 0.5f / (kRows - 1);
    ClothDef def = withoutAir(clothSheet(2, kRows, {0, 0, 0.1f}, {0.5f, 0, 0}));
    def.bending = 1.5e-3f;
    def.gravityScale = 1e-3f;
    def.damping = 3;
    def.attachments = {{0}, {1}, {2}, {3}};
    Cloth cloth(world, def);
    runFor(world, 20);
    double slope = 0, expected = 0;
    for (int i = 1; i + 1 < kRows; ++i) {
        double moment = 0;  // per width
        for (int j = i + 1; j < kRows; ++j)
            moment += def.density * l * (j + 1 < kRows ? 1 : 0.5) * 1e-3 * kGravity * l * (j - i);
        slope += l * moment / def.bending;
        expected += l * slope;
    }
    EXPECT_NEAR(-cloth.point(2 * kRows - 1).y, expected, 0.02 * expected);
}

/// Held along two sides, each line is a parabola whose length is that of its tension: 8 d²/3 = ε, T = ρ g/8 d = K ε.
TEST(Cloth, ATautNetSagsAsAParabolaOfItsTension) {
    World world;
    ClothDef def = withoutAir(clothSheet(32, 32, {1, 0, 0}, {0, 0, 1}));
    def.tethers = false;
    def.bending = 0;
    for (int i = 0; i < 32; ++i) {
        def.attachments.push_back({i});
        def.attachments.push_back({31 * 32 + i});
    }
    Cloth cloth(world, def);
    runFor(world, 6);
    const double sag = std::cbrt(3.0 / 64 * def.density * kGravity / def.stretch);
    // The middle is between two rows, 1/31² of the sag below either.
    EXPECT_NEAR(-cloth.point(15 * 32 + 16).y, sag * (1 - 1.0 / (31 * 31)), 0.05 * sag);
}

/// A hanging chain swings with ω = j₀₁/2 √(g/L), j₀₁ the first zero of Bessel's J₀.
TEST(Cloth, AHangingStripSwingsWithThePeriodOfAChain) {
    World world(withoutSleep());
    ClothDef def = withoutAir(clothSheet(3, 33, {0.05f, 0, 0}, {0, -1, 0}));
    def.bending = 0;
    for (int i = 0; i < 3; ++i) def.attachments.push_back({i});
    // Turned about its edge by 0.05 rad.
    Cloth cloth(world, def, {{}, rotationAbout({1, 0, 0}, 0.05f)});
    const double period = periodOf(world, 720, [&] { return cloth.point(32 * 3 + 1).z; });
    EXPECT_NEAR(period, 4 * 3.14159265 / 2.404826 * std::sqrt(1 / kGravity), 0.02 * period);
}

/// m g = ½ ρ A C_D v², before a free sheet has had time to fold.
TEST(Cloth, AFlatSheetFallsWithItsTerminalSpeed) {
    World world;
    const ClothDef def = clothSheet(16, 16, {1, 0, 0}, {0, 0, 1});
    Cloth cloth(world, def);
    runFor(world, 1.5);
    const double expected = std::sqrt(2 * def.density * kGravity / (def.airDensity * def.drag));
    EXPECT_NEAR(-cloth.velocity(8 * 16 + 8).y, expected, 0.02 * expected);
}

/// Wind of that speed from below carries it, and what air does to each point is what its mass takes: it stays flat.
TEST(Cloth, WindCarriesASheetThatItWouldFallThroughAt) {
    World world;
    const ClothDef def = clothSheet(8, 8, {1, 0, 0}, {0, 0, 1});
    Cloth cloth(world, def);
    cloth.setWind({0, std::sqrt(2 * def.density * kGravity / (def.airDensity * def.drag)), 0});
    runFor(world, 1);
    for (int p = 0; p < cloth.pointCount(); ++p) EXPECT_NEAR(length(cloth.velocity(p)), 0, 1e-4) << p;
}

TEST(Cloth, HangsByItsEdgeStretchedByLessThanAPercent) {
    World world;
    Cloth cloth(world, hangingSquare());
    double most = 0;
    for (int i = 0; i < 300; ++i) {
        world.step(kDt);
        most = std::max(most, largestStretch(cloth));
    }
    EXPECT_LE(most, 0.01);
}

TEST(Cloth, HangingByTwoCornersComesToRestStretchedByLessThanAPercent) {
    World world;
    ClothDef def = withoutAir(clothSheet(32, 32, {1, 0, 0}, {0, -1, 0}));
    def.attachments = {{0}, {31}};
    Cloth cloth(world, def);
    runFor(world, 10);
    EXPECT_FALSE(cloth.isAwake());
    EXPECT_LE(largestStretch(cloth), 0.01);
}

/// What falls and is caught by lengths loses energy, but for what these store and give back.
TEST(Cloth, SwingsWithoutEverGainingEnergy) {
    World world(withoutSleep());
    Cloth cloth(world, hangingSquare(), {{}, rotationAbout({1, 0, 0}, 1.5f)});
    const double first = mechanicalEnergy(cloth);
    double lowest = first;
    const double weight = weightOf(cloth);
    for (int i = 0; i < 600; ++i) {
        world.step(kDt);
        const double now = mechanicalEnergy(cloth);
        // ½ F² L/K of the weight that lengths hold, and ten times that as it swings.
        EXPECT_LE(now, lowest + 10 * 0.5 * weight * weight / 2e4 + 1e-3 * weight) << i;
        lowest = std::min(lowest, now);
    }
}

TEST(Cloth, HandsABallWhatItTakesFromIt) {
    World world(withoutGravity());
    DynamicBody body;
    body.shape = Sphere{0.15f};
    body.density = 200;
    body.position = {0.5, -0.5, -0.4};
    body.linearVelocity = {0, 0, 5};
    const BodyId ball = world.create(body);
    Cloth cloth(world, withoutAir(clothSheet(32, 32, {1, 0, 0}, {0, -1, 0})));
    const double mass = world.mass(ball).mass, before = 5 * mass;
    bool touched = false;
    for (int i = 0; i < 120; ++i) {
        world.step(kDt);
        touched |= cloth.contactCount() > 0;
        const DVec3 m = momentumOf(cloth);
        const Vec3 v = world.linearVelocity(ball);
        EXPECT_NEAR(m.z + mass * v.z, before, 1e-4 * before) << i;
        EXPECT_NEAR(m.x + mass * v.x, 0, 1e-4 * before) << i;
        EXPECT_NEAR(m.y + mass * v.y, 0, 1e-4 * before) << i;
    }
    EXPECT_TRUE(touched);
    EXPECT_LT(world.linearVelocity(ball).z, 4.8);
}

/// A body that hangs by a rope pulls as much as it weighs, and the sum of momenta is what gravity and the ceiling gave.
TEST(Cloth, HoldsABodyByARope) {
    World world;
    DynamicBody body;
    body.shape = Sphere{0.1f};
    body.position = {0, -1.1, 0};
    const BodyId weight = world.create(body);
    ClothDef def = withoutAir(clothRope(17, {0, -1.1f, 0}));
    def.attachments = {{0}, {16, weight}};
    def.mask = 0;  // it begins within the body
    def.smallSteps = 16;
    Cloth rope(world, def);
    runFor(world, 4);
    EXPECT_NEAR(world.linearVelocity(weight).y, 0, 0.02);
    EXPECT_NEAR(lengthOf(rope, 0, 16), 1.1, 0.011);
}

TEST(Cloth, NothingPassesThroughACapsuleAtTwentyMetresPerSecond) {
    World world;
    BodyDef def = bodyDef(Capsule{0.1f, 0.6f}, {0.5, -0.5, -1}, {}, BodyType::kinematic);
    def.pose.rotation = rotationAbout({0, 0, 1}, 0.5f * kPi);
    def.linearVelocity = {0, 0, 20};
    const BodyId capsule = world.create(def);
    Cloth cloth(world, withoutAir(clothSheet(32, 32, {1, 0, 0}, {0, -1, 0})));
    for (int i = 0; i < 12; ++i) {
        world.step(kDt);
        const double front = world.pose(capsule).position.z;
        for (int p = 0; p < cloth.pointCount(); ++p) {
            const DVec3 at = cloth.point(p);
            EXPECT_GT(std::hypot(at.y + 0.5, at.z - front), 0.1) << "point " << p << " in step " << i;
            // The rows that it hits stay before it; the hems wrap around it.
            if (p / 32 == 15 || p / 32 == 16) {
                EXPECT_GT(at.z, front) << "point " << p << " in step " << i;
            }
        }
    }
}

TEST(Cloth, LiesOnShapesOfAllKindsAtItsThickness) {
    const std::array<Vec3, 8> corners{Vec3{-1, -1, -1}, {1, -1, -1}, {-1, -1, 1}, {1, -1, 1},
                                      {-1, 0, -1},      {1, 0, -1},  {-1, 0, 1},  {1, 0, 1}};
    const std::array<Vec3, 4> ground{Vec3{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
    const std::array<Triangle, 2> triangles{Triangle{0, 2, 1}, {0, 3, 2}};
    const std::vector<float> flat(9, 0.0f);
    const std::vector<std::pair<Shape, Vec3>> shapes{{Box{{1, 1, 1}}, {0, -1, 0}},
                                                     {ConvexHull(corners), {}},
                                                     {TriangleMesh(ground, triangles), {}},
                                                     {HeightField(3, 3, 1.0f, flat), {-1, 0, -1}}};
    for (std::size_t kind = 0; kind < shapes.size(); ++kind) {
        World world;
        world.create(bodyDef(shapes[kind].first, DVec3(shapes[kind].second), {}, BodyType::fixed));
        Cloth cloth(world, clothSheet(9, 9, {0.5f, 0, 0}, {0, 0, 0.5f}), {{-0.25, 0.1, -0.25}, {}});
        runFor(world, 4);
        for (int p = 0; p < cloth.pointCount(); ++p)
            EXPECT_NEAR(cloth.point(p).y, cloth.def().thickness, 0.002) << "shape " << kind << " point " << p;
        EXPECT_FALSE(cloth.isAwake()) << "shape " << kind;
    }
}

TEST(Cloth, StaysWithinReachOfTheAnimation) {
    World world;
    ClothDef def = withoutAir(clothSheet(8, 8, {1, 0, 0}, {0, 0, 1}));
    def.skin.assign(64, ClothSkin{0.05f, 0.02f});
    for (std::size_t i = 0; i < 8; ++i) def.skin[i].maxDistance = 0;
    Cloth cloth(world, def);
    std::vector<DVec3> places(64);
    const std::vector<Vec3> normals(64, Vec3{0, 1, 0});
    for (int step = 0; step < 60; ++step) {
        for (std::size_t i = 0; i < 64; ++i) places[i] = DVec3(def.points[i]) + DVec3{0.05 * step, 0, 0};
        cloth.follow(places, normals);
        world.step(kDt);
    }
    for (int i = 0; i < 64; ++i) {
        const double away = length(relative(cloth.point(i), places[static_cast<std::size_t>(i)]));
        EXPECT_LE(away, i < 8 ? 1e-5 : 0.05 + 1e-5);
        EXPECT_GE(cloth.point(i).y, -0.02 - 1e-5);
    }
}

/// A scene with contacts both ways, attachments and wind.
struct CapeScene {
    explicit CapeScene(const WorldConfig& config = {}) : world({}, config) {
        addFloor(world, surface(0.5f), {0, -2, 0});
        BodyDef def = bodyDef(Capsule{0.2f, 0.3f}, {0.5, -0.3, -0.25}, {}, BodyType::dynamic);
        def.gravityScale = 0;
        def.angularVelocity = {0, 1, 0};
        torso = world.create(def);
        ClothDef cape = clothSheet(16, 20, {1, 0, 0}, {0, -1.2f, 0});
        for (int i = 4; i < 12; ++i) cape.attachments.push_back({i, torso});
        cloth.emplace(world, cape);
        cloth->setWind({0, 0, -6});
    }
    World world;
    BodyId torso;
    std::optional<Cloth> cloth;
};

TEST(Cloth, HasTheSameBitsForAllLanesAndThreads) {
    std::vector<std::uint64_t> hashes;
    for (const int lanes : {4, 8, 16})
        for (const bool shared : {false, true}) {
            WorldConfig config;
            config.lanes = lanes;
            if (shared) config.tasks = threadTasks(2);
            CapeScene scene(config);
            runFor(scene.world, 2);
            hashes.push_back(scene.world.hash());
        }
    for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes.front());
}

TEST(Cloth, GoesOnFromASavedStateWithTheSameBits) {
    CapeScene scene;
    runFor(scene.world, 1);
    std::vector<std::byte> state(scene.world.saveSize());
    scene.world.save(state);
    runFor(scene.world, 1);
    const std::uint64_t expected = scene.world.hash();
    scene.world.restore(state);
    runFor(scene.world, 1);
    EXPECT_EQ(scene.world.hash(), expected);

    CapeScene other;
    other.world.restore(state);
    runFor(other.world, 1);
    EXPECT_EQ(other.world.hash(), expected);
}

TEST(Cloth, AsksForNoMemoryInSteadyState) {
    CapeScene scene;
    runFor(scene.world, 3);
    const long before = heapCalls();
    runFor(scene.world, 1);
    EXPECT_EQ(heapCalls(), before);
}

TEST(Cloth, SleepsAtRestAndWakesWhenItsHolderMoves) {
    World world;
    const BodyId rod = world.create(bodyDef(Sphere{0.1f}, {0, 0.5, 0}, {}, BodyType::kinematic));
    ClothDef def = clothSheet(8, 8, {0.5f, 0, 0}, {0, -0.5f, 0});
    for (int i = 0; i < 8; ++i) def.attachments.push_back({i, rod});
    Cloth cloth(world, def);
    runFor(world, 8);
    ASSERT_FALSE(cloth.isAwake());
    world.setVelocity(rod, {0.5f, 0, 0}, {});
    runFor(world, 0.5);
    EXPECT_TRUE(cloth.isAwake());
    EXPECT_NEAR(cloth.point(0).x, 0.25, 0.02);
}

TEST(Cloth, StaysWhereItsHolderIsNoMore) {
    World world;
    const BodyId holder = world.create(bodyDef(Sphere{0.1f}, {0, 0.5, 0}, {}, BodyType::kinematic));
    ClothDef def = clothSheet(4, 4, {0.5f, 0, 0}, {0, -0.5f, 0});
    def.attachments = {{0, holder}};
    Cloth cloth(world, def);
    runFor(world, 0.5);
    world.destroy(holder);
    runFor(world, 0.5);
    EXPECT_NEAR(length(relative(cloth.point(0), {})), 0, 1e-4);
}

/// A sheet of any kind at any rate, hung by an edge or a corner, or dropped on what stands there.
struct DrawnSheet {
    explicit DrawnSheet(unsigned seed) : random(seed) {
        const int columns = 4 + static_cast<int>(between(0, 12)), rows = 4 + static_cast<int>(between(0, 12));
        const bool hangs = between(0, 2) > 1;
        const float size = between(0.4f, 1.2f);
        ClothDef def = clothSheet(columns, rows, {size, 0, 0}, hangs ? Vec3{0, -size, 0} : Vec3{0, 0, size});
        def.density = std::exp(between(-3, 0.7f));  // 0.05 to 2 kg/m²
        def.stretch = std::exp(between(8.5f, 12));  // 5 to 160 kN/m
        def.shear = std::exp(between(5.5f, 8));     // 0.25 to 3 kN/m
        def.bending = std::exp(between(-14, -5));
        def.damping = 1;
        const int held = between(0, 2) > 1 ? columns : 1;
        for (int i = 0; hangs && i < held; ++i) def.attachments.push_back({i});
        addFloor(world, surface(0.5f), {0, -1.5, 0});
        const Shape shape = between(0, 2) > 1 ? Shape(Sphere{0.3f}) : Shape(Box{{0.3f, 0.2f, 0.25f}});
        world.create(bodyDef(shape, {0.5 * size, -0.8, hangs ? 0.35 : 0.5 * size}, {}, BodyType::fixed));
        cloth.emplace(world, def);
        dt = 1 / std::array{30.0, 60.0, 120.0, 240.0}[static_cast<std::size_t>(between(0, 4))];
    }
    float between(float low, float high) {
        return low + (high - low) * static_cast<float>(random() >> 8) / static_cast<float>(1u << 24);
    }
    std::mt19937 random;
    World world;
    std::optional<Cloth> cloth;
    double dt;
};

/// Lengths store and give back up to a tenth of what is lost when they stop a fall, and never more than there was. At
/// rest nothing is stretched by a percent, and all are slower than a sheet that settles.
TEST(Cloth, DrawnSheetsComeToRestAndGainNoEnergy) {
    for (unsigned seed = 1; seed <= 32; ++seed) {
        DrawnSheet drawn(seed);
        const Cloth& cloth = *drawn.cloth;
        const double weight = weightOf(cloth), first = mechanicalEnergy(cloth);
        double lowest = first, gain = 0, squares = 0;
        for (int i = 0; i < static_cast<int>(12 / drawn.dt); ++i) {
            drawn.world.step(drawn.dt);
            const double now = mechanicalEnergy(cloth);
            ASSERT_LE(now, first + 1e-4 * weight) << "seed " << seed;
            gain = std::max(gain, now - lowest);
            lowest = std::min(lowest, now);
        }
        for (int i = 0; i < cloth.pointCount(); ++i) squares += lengthSquared(cloth.velocity(i));
        EXPECT_LE(gain, 0.1 * (first - lowest) + 1e-3 * weight) << "seed " << seed;
        EXPECT_LE(largestStretch(cloth), 0.01) << "seed " << seed;
        EXPECT_LE(std::sqrt(squares / cloth.pointCount()), 0.05) << "seed " << seed;
    }
}

TEST(Cloth, RefusesDefinitionsWithOneClearError) {
    const ClothDef good = clothSheet(3, 3, {1, 0, 0}, {0, -1, 0});
    const auto why = [&](auto&& change) {
        ClothDef def = good;
        change(def);
        return whyInvalid(def);
    };
    EXPECT_EQ(whyInvalid(good), "");
    EXPECT_EQ(why([](ClothDef& d) { d.points.clear(); }), "points has 0 elements, must have 2 to 65536");
    EXPECT_EQ(why([](ClothDef& d) { d.points[2].y = NAN; }), "points[2].y is nan, must be in [-100000, 100000] m");
    EXPECT_EQ(why([](ClothDef& d) { d.density = 0; }), "density is 0, must be in [0.001, 1000] kg/m²");
    EXPECT_EQ(why([](ClothDef& d) { d.stretch = -1; }), "stretch is -1, must be in [1, 100000000] N/m");
    EXPECT_EQ(why([](ClothDef& d) { d.smallSteps = 0; }), "smallSteps is 0, must be in [1, 32]");
    EXPECT_EQ(why([](ClothDef& d) { d.faces[1].c = 9; }), "faces[1].c is 9, must be in [0, 8]");
    EXPECT_EQ(why([](ClothDef& d) { d.faces[0] = {0, 1, 2}; }), "faces[0] has its corners in a line, must have an area");
    EXPECT_EQ(why([](ClothDef& d) { d.lines.push_back({4, 4}); }),
              "lines[0] joins points 4 and 4, which are 0 m apart, must be more than 0.00001 m");
    EXPECT_EQ(why([](ClothDef& d) { d.points.push_back({2, 0, 0}); }), "points[9] is part of no face or line, must be of one");
    EXPECT_EQ(why([](ClothDef& d) { d.attachments = {{-1}}; }), "attachments[0].point is -1, must be in [0, 8]");
    EXPECT_EQ(why([](ClothDef& d) { d.attachments = {{1}, {1}}; }),
              "attachments[1].point is 1, which is attached already, must be once");
    EXPECT_EQ(why([](ClothDef& d) { d.skin.resize(2); }),
              "skin has 2 elements, must have none or one for each of 9 points");
    EXPECT_EQ(why([](ClothDef& d) {
                  d.skin.resize(9);
                  d.skin[3].backstop = -1;
              }),
              "skin[3].backstop is -1, must be in [0, 1000000] m");
    World world;
    ClothDef bad = good;
    bad.drag = INFINITY;
    EXPECT_THROW(Cloth(world, bad), std::invalid_argument);
    Cloth cloth(world, good);
    EXPECT_THROW(cloth.point(9), std::out_of_range);
    EXPECT_THROW(cloth.setWind({NAN, 0, 0}), std::invalid_argument);
    EXPECT_THROW(cloth.follow({}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace ragtop::test::cloth_laws
