#include "ragtop/cooked.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <new>
#include <random>

#include "field_bytes.h"
#include "layout.h"
#include "ragdolls/human.h"
#include "ragtop/shape_image.h"
#include "ragtop/world.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

/// Bytes where cooked ones may lie.
class AlignedBytes {
public:
    explicit AlignedBytes(std::span<const std::byte> bytes) : size_(bytes.size()) {
        at_ = static_cast<std::byte*>(::operator new(size_ + 1, kAlignment));
        std::copy(bytes.begin(), bytes.end(), at_);
    }
    ~AlignedBytes() { ::operator delete(at_, kAlignment); }
    AlignedBytes(const AlignedBytes&) = delete;
    AlignedBytes& operator=(const AlignedBytes&) = delete;
    std::span<std::byte> bytes() { return {at_, size_}; }

private:
    static constexpr std::align_val_t kAlignment{ShapeImage::kAlignment};
    std::byte* at_;
    std::size_t size_;
};

/// Hills of a grid of cells.
TriangleMesh hills(std::uint32_t cells) {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    const std::uint32_t row = cells + 1;
    for (std::uint32_t i = 0; i < row * row; ++i) {
        const float x = static_cast<float>(i % row), z = static_cast<float>(i / row);
        vertices.push_back({x, 0.3f * std::sin(x) * std::cos(0.7f * z), z});
    }
    for (std::uint32_t i = 0; i < cells; ++i)
        for (std::uint32_t j = 0; j < cells; ++j) {
            const std::uint32_t at = i * row + j;
            triangles.push_back({at, at + row, at + 1});
            triangles.push_back({at + 1, at + row, at + row + 1});
        }
    return TriangleMesh(vertices, triangles);
}

std::vector<Clip> clipsOf(const Skeleton& skeleton, int clips, int keys) {
    std::vector<Clip> all;
    for (int c = 0; c < clips; ++c) {
        Clip clip{"clip " + std::to_string(c), static_cast<float>(keys - 1) / 30, {}};
        for (int b = 0; b < static_cast<int>(skeleton.bones.size()); ++b) {
            ClipTrack track{b, {}, {}};
            for (int k = 0; k < keys; ++k) {
                track.times.push_back(static_cast<float>(k) / 30);
                track.keys.push_back(
                    {{0.1f * static_cast<float>(c), 0.2f, 0}, rotationAbout({0, 0, 1}, 0.01f * static_cast<float>(k))});
            }
            clip.tracks.push_back(std::move(track));
        }
        all.push_back(std::move(clip));
    }
    return all;
}

/// With joints of several kinds, and most of what they may have.
RagdollDef ragdollOf(const Skeleton& skeleton) {
    RagdollDef def = makeRagdoll(skeleton);
    def.note = "made for a test";
    BallDef ball;
    std::visit([&](const auto& kind) { ball.bodies = kind.bodies; }, def.joints[0].joint);
    ball.swingPyramid = SwingPyramid{{-0.5f, 0.7f}, {-0.2f, 0.3f}};
    ball.twistLimit = Range{-0.4f, 0.6f};
    ball.bearing = Bearing{0.1f, 0.2f, 0.3f, 0.01f};
    ball.spring = Spring{.frequency = 3, .dampingRatio = 0.5f};
    ball.friction = 0.25f;
    def.joints[0].joint = ball;
    HingeDef hinge;
    hinge.bodies = ball.bodies;
    std::visit([&](const auto& kind) { hinge.bodies = kind.bodies; }, def.joints[1].joint);
    hinge.limit = Range{-1, 2};
    hinge.motor = Motor{.targetSpeed = 1, .maxForce = 20, .maxReverse = 10.0f};
    def.joints[1].joint = hinge;
    std::vector<Vec3> corners{{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}, {0.1f, 0.1f, 0.1f}};
    def.parts[1].shape = ConvexHull(corners);
    return def;
}

/// A base that does not move, two arms on hinges, the second of which turns against the first, and a slider.
Robot robotOfTest() {
    Robot robot;
    robot.name = "arms";
    robot.mass = 3;
    const std::vector<Vec3> corners{{-0.1f, 0, 0}, {0.1f, 0, 0}, {0, 0.4f, 0}, {0, 0, 0.2f}, {0.1f, 0.3f, 0.1f}};
    const std::vector<Shape> shapes{Box{{0.2f, 0.1f, 0.2f}}, Capsule{0.05f, 0.2f}, ConvexHull(corners), Sphere{0.1f}};
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        RobotBody body{"body " + std::to_string(i), {{0.3f * static_cast<float>(i), 1, 0}, {}}, {}, {}, i == 0};
        body.mass = {1, {0, 0.1f, 0}, {{0.02f, 0, 0}, {0, 0.03f, 0.001f}, {0, 0.001f, 0.04f}}};
        body.shapes = {{.geometry = shapes[i], .frame = {{0, 0.05f, 0}, {}}, .material = {.friction = 0.3f}}};
        robot.bodies.push_back(std::move(body));
        robot.links.push_back({"link " + std::to_string(i), static_cast<int>(i), {{0, 0.01f, 0}, {}}});
    }
    for (int child = 1; child < 4; ++child) {
        RobotJoint joint{"joint " + std::to_string(child), child - 1, child, HingeDef{}, 5, 2, 0.1f};
        if (child == 3) joint.joint = SliderDef{.limit = Range{-0.2f, 0.3f}};
        if (auto* hinge = std::get_if<HingeDef>(&joint.joint)) hinge->spring = Spring{2, 0.1f};
        std::visit([](auto& kind) { kind.bodies.frameA = {{0.3f, 0, 0}, {}}; }, joint.joint);
        robot.joints.push_back(std::move(joint));
    }
    RobotCoupling follows{"follows", {}, {1, 0}, true};
    follows.coupling.count = 2;
    follows.coupling.parts[1].ratio = 1;
    follows.coupling.sum.limit = Range{0, 0};
    robot.couplings = {follows};
    robot.keyframes = {{"home", {0, 0, 0.1f}}};
    return robot;
}

Cooked everything() {
    Cooked asset;
    asset.sourceHash = 0x0123456789abcdefu;
    asset.mesh = hills(4);
    const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    asset.pieces = {ConvexHull(corners)};
    asset.skeleton = HumanRig().skeleton;
    asset.clips = clipsOf(*asset.skeleton, 2, 3);
    asset.ragdoll = ragdollOf(*asset.skeleton);
    asset.robot = robotOfTest();
    return asset;
}

/// The line that reading fails with; empty when it does not.
std::string complaint(std::span<const std::byte> bytes) {
    try {
        readCooked(bytes, nullptr, "some.ragtop");
    } catch (const CookedError& error) {
        return error.what();
    }
    return "";
}

TEST(Cooked, GivesBackWhatItWasMadeFrom) {
    const Cooked asset = everything();
    const auto path = temporaryPath("asset.ragtop");
    saveCooked(asset, path);
    const Cooked again = loadCooked(path);
    EXPECT_EQ(again.sourceHash, asset.sourceHash);
    ASSERT_TRUE(again.mesh && again.skeleton && again.ragdoll);
    EXPECT_EQ(again.mesh->vertices().size(), asset.mesh->vertices().size());
    EXPECT_EQ(again.skeleton->bones[5].name, "b5");
    EXPECT_EQ(again.skeleton->bones[5].bind, asset.skeleton->bones[5].bind);
    ASSERT_EQ(again.clips.size(), 2u);
    EXPECT_EQ(again.clips[1].tracks[3].keys, asset.clips[1].tracks[3].keys);
    const auto& ball = std::get<BallDef>(again.ragdoll->joints[0].joint);
    EXPECT_EQ(ball.swingPyramid->y.upper, 0.7f);
    EXPECT_EQ(ball.bearing->pinRadius, 0.01f);
    EXPECT_FALSE(ball.swingLimit.has_value());
    EXPECT_EQ(std::get<HingeDef>(again.ragdoll->joints[1].joint).motor->maxReverse, 10.0f);
    EXPECT_EQ(std::get<ConvexHull>(again.ragdoll->parts[1].shape).vertices().size(), 5u);
    EXPECT_EQ(again.ragdoll->note, asset.ragdoll->note);
    EXPECT_EQ(cook(again), cook(asset));  // and all else
}

TEST(Cooked, AMeshLiesInTheFileAndOutlivesItsName) {
    Cooked asset;
    asset.mesh = hills(20);
    AlignedBytes file(cook(asset));
    const Cooked again = readCooked(file.bytes(), nullptr, "hills");
    const auto* first = reinterpret_cast<const std::byte*>(again.mesh->vertices().data());
    EXPECT_GE(first, file.bytes().data());
    EXPECT_LT(first, file.bytes().data() + file.bytes().size());

    const auto path = temporaryPath("hills.ragtop");
    saveCooked(asset, path);
    std::optional<Cooked> loaded = loadCooked(path);
    const TriangleMesh kept = *loaded->mesh;
    loaded.reset();
    std::filesystem::remove(path);
    for (std::size_t i = 0; i < kept.vertices().size(); ++i) ASSERT_EQ(kept.vertices()[i], asset.mesh->vertices()[i]);
}

TEST(Cooked, BodiesMoveOnItToTheBit) {
    const TriangleMesh built = hills(8);
    Cooked asset;
    asset.mesh = built;
    const auto path = temporaryPath("ground.ragtop");
    saveCooked(asset, path);
    const auto run = [](const TriangleMesh& mesh) {
        World world;
        BodyDef ground;
        ground.type = BodyType::fixed;
        ground.shapes = {{.geometry = mesh}};
        world.create(ground);
        std::vector<DVec3> places;
        std::vector<BodyId> bodies;
        for (int i = 0; i < 5; ++i) {
            BodyDef body;
            body.shapes = {{.geometry = i % 2 ? Shape(Box{{0.3f, 0.2f, 0.3f}}) : Shape(Sphere{0.3f})}};
            body.pose.position = {2.0 + 0.7 * i, 1.5, 3.1 + 0.2 * i};
            bodies.push_back(world.create(body));
        }
        for (int i = 0; i < 120; ++i) world.step(1.0f / 60);
        for (const BodyId body : bodies) places.push_back(world.pose(body).position);
        return places;
    };
    EXPECT_EQ(run(*loadCooked(path).mesh), run(built));
}

TEST(Cooked, RobotsMoveToTheBit) {
    Cooked asset;
    asset.robot = robotOfTest();
    AlignedBytes file(cook(asset));
    const Cooked again = readCooked(file.bytes(), nullptr, "arms");
    ASSERT_TRUE(again.robot);
    EXPECT_EQ(again.robot->findJoint("joint 3"), 2);
    EXPECT_EQ(again.robot->keyframes[0].coordinates, asset.robot->keyframes[0].coordinates);
    const auto run = [](const Robot& robot) {
        World world;
        makeRobot(world, robot, {{0, 2, 0}, {}}, {.holding = true});
        makeRobot(world, robot, {{5, 2, 0}, {}});
        for (int i = 0; i < 90; ++i) world.step(1.0f / 60);
        return world.hash();
    };
    EXPECT_EQ(run(*again.robot), run(*asset.robot));
}

TEST(Cooked, RefusesRobotsThatCannotBe) {
    const auto refused = [](auto spoil) {
        Cooked asset;
        asset.robot = robotOfTest();
        spoil(*asset.robot);
        try {
            cook(asset);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    using testing::HasSubstr;
    EXPECT_THAT(refused([](Robot& robot) { robot.joints[1].child = 9; }),
                HasSubstr("joint 'joint 2': child is 9, must be at least 0 and below 4"));
    EXPECT_THAT(refused([](Robot& robot) { robot.links[2].body = -1; }), HasSubstr("link 'link 2': body is -1"));
    EXPECT_THAT(refused([](Robot& robot) { robot.couplings[0].joints = {1}; }), HasSubstr("coupling 'follows'"));
    EXPECT_THAT(refused([](Robot& robot) { robot.keyframes[0].coordinates = {}; }),
                HasSubstr("keyframe 'home': has 0 coordinates, must have 3, one per joint"));
    EXPECT_THAT(refused([](Robot& robot) { robot.bodies[1].mass.mass = -1; }), HasSubstr("body 'body 1'"));
    EXPECT_THAT(refused([](Robot& robot) { robot.bodies.clear(); }), HasSubstr("must have one or more"));
}

TEST(Cooked, RefusesEveryFlippedByteAndEveryCutInOneLine) {
    AlignedBytes file(cook(everything()));
    const std::span<std::byte> bytes = file.bytes();
    ASSERT_EQ(complaint(bytes), "");
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const std::byte before = bytes[i];
        bytes[i] ^= static_cast<std::byte>(1u << i % 8);
        const std::string line = complaint(bytes);
        EXPECT_TRUE(line.starts_with("some.ragtop: ") && line.find('\n') == std::string::npos) << i << ": " << line;
        bytes[i] = before;
    }
    for (std::size_t size = 0; size < bytes.size(); size += size < 200 ? 1 : 37)
        EXPECT_NE(complaint(bytes.first(size)), "") << size;
    EXPECT_THAT(complaint(bytes.first(bytes.size() - 64)), testing::HasSubstr("is cut short: has "));
    EXPECT_THAT(complaint(bytes.first(40)), testing::HasSubstr("is cut short: has 40 bytes of 64"));
}

TEST(Cooked, RefusesOtherVersionsAndOtherFiles) {
    AlignedBytes file(cook(everything()));
    const std::uint32_t other = kCookedVersion + 1;
    std::memcpy(file.bytes().data() + offsetof(CookedHead, version), &other, sizeof other);
    EXPECT_EQ(complaint(file.bytes()), "some.ragtop: has version " + std::to_string(other) + ", must have " + std::to_string(kCookedVersion) + "; cook it again");
    const std::string scene(80, '{');
    AlignedBytes text(std::as_bytes(std::span(scene)));
    EXPECT_EQ(complaint(text.bytes()), "some.ragtop: is no cooked file: it does not begin with RAGTOP");
    EXPECT_THROW(loadCooked(temporaryPath("none.ragtop")), CookedError);
    EXPECT_THROW(loadCooked(std::filesystem::temp_directory_path()), CookedError);
    EXPECT_THROW(cook(Cooked{}), std::invalid_argument);
    Cooked orphan;
    orphan.clips = clipsOf(HumanRig().skeleton, 1, 2);
    EXPECT_THROW(cook(orphan), std::invalid_argument);
}

/// Files with right checksums that nobody cooked: any word may be any number.
TEST(Cooked, WordsByChanceNeverEndTheProgram) {
    std::mt19937 random(11);
    const std::vector<std::byte> mesh = ShapeImage::of(hills(6));
    AlignedBytes image(mesh);
    int refused = 0;
    constexpr int kTries = 4000;
    for (int i = 0; i < kTries; ++i) {
        std::copy(mesh.begin(), mesh.end(), image.bytes().begin());
        const std::size_t reach = i % 2 ? mesh.size() : 320;  // half of them in the head
        const std::uint32_t word = i % 3 ? random() : random() % 64;
        std::memcpy(image.bytes().data() + random() % (reach / 4) * 4, &word, sizeof word);
        try {
            ShapeImage::mesh(image.bytes(), nullptr);
        } catch (const std::invalid_argument&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, kTries / 4);
    Cooked figure;
    figure.skeleton = HumanRig().skeleton;
    figure.ragdoll = ragdollOf(*figure.skeleton);
    figure.robot = robotOfTest();
    const std::vector<std::byte> cookedBytes = cook(figure);
    AlignedBytes file(cookedBytes);
    for (int i = 0; i < kTries; ++i) {
        std::copy(cookedBytes.begin(), cookedBytes.end(), file.bytes().begin());
        CookedHead head;
        std::memcpy(&head, file.bytes().data(), sizeof head);
        CookedSection section;
        std::byte* listed = file.bytes().data() + sizeof head + random() % head.sections * sizeof section;
        std::memcpy(&section, listed, sizeof section);
        file.bytes()[section.offset + random() % section.size] = static_cast<std::byte>(random());
        section.checksum = ShapeImage::checksum(file.bytes().subspan(section.offset, section.size));
        std::memcpy(listed, &section, sizeof section);
        head.checksum = 0;
        std::memcpy(file.bytes().data(), &head, sizeof head);
        head.checksum = ShapeImage::checksum(file.bytes().first(sizeof head + padded(head.sections * sizeof section)));
        std::memcpy(file.bytes().data(), &head, sizeof head);
        complaint(file.bytes());
    }
}

}  // namespace
}  // namespace ragtop
