#include "import_support.h"
#include "ragtop/mesh_file.h"

namespace ragtop {
namespace {

const char* kCube =
    "v 0 0 0\nv 2 0 0\nv 2 4 0\nv 0 4 0\nv 0 0 6\nv 2 0 6\nv 2 4 6\nv 0 4 6\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

Bounds boundsOfPoints(std::span<const Vec3> points) {
    Bounds bounds{points[0], points[0]};
    for (const Vec3& point : points) bounds = {min(bounds.lower, point), max(bounds.upper, point)};
    return bounds;
}

TEST(LoadMesh, ReadsTheTrianglesOfABox) {
    const TemporaryFile file("box.obj", kCube);
    const Shape shape = loadMesh(file.path());
    const auto& mesh = std::get<TriangleMesh>(shape);
    EXPECT_EQ(mesh.triangles().size(), 12u);
    EXPECT_EQ(mesh.vertices().size(), 8u);
    const Bounds bounds = boundsOfPoints(mesh.vertices());
    EXPECT_EQ(bounds.upper, (Vec3{2, 4, 6}));
}

TEST(LoadMesh, ZUpTurnsAndScales) {
    const TemporaryFile file("box.obj", kCube);
    const Shape shape = loadMesh(file.path(), {.scale = 0.5f, .upAxis = UpAxis::z});
    const Bounds bounds = boundsOfPoints(std::get<TriangleMesh>(shape).vertices());
    EXPECT_EQ(bounds.lower, (Vec3{0, 0, -2}));
    EXPECT_EQ(bounds.upper, (Vec3{1, 3, 0}));
    // Turning must not turn triangles inside out: the volume stays positive.
    const auto& mesh = std::get<TriangleMesh>(shape);
    float volume = 0;
    for (const Triangle& t : mesh.triangles())
        volume += dot(mesh.vertices()[t.a], cross(mesh.vertices()[t.b], mesh.vertices()[t.c])) / 6;
    EXPECT_NEAR(volume, 6.0f, 1e-5f);
}

TEST(LoadMesh, ConvexGivesTheHull) {
    const TemporaryFile file("box.obj", kCube);
    const Shape shape = loadMesh(file.path(), {.convex = true});
    EXPECT_EQ(std::get<ConvexHull>(shape).vertices().size(), 8u);
    EXPECT_NEAR(massOf(shape, 1.0f).mass, 48.0f, 1e-3f);
}

TEST(LoadMesh, ReadsATruck) {
    RAGTOP_SAMPLE(file, "vehicles/truck_red.glb");
    const Shape shape = loadMesh(file, {.convex = true});
    const Bounds bounds = boundsOfPoints(std::get<ConvexHull>(shape).vertices());
    const Vec3 size = bounds.upper - bounds.lower;
    EXPECT_NEAR(std::max({size.x, size.y, size.z}), 2.8f, 0.1f);
}

TEST(LoadMesh, RefusesWhatIsNoMesh) {
    const auto failure = [](const std::filesystem::path& path, const MeshOptions& options = {}) {
        return importError(path, [&] { loadMesh(path, options); });
    };
    EXPECT_NE(failure("nothing.obj").find("no such file"), std::string::npos);
    const TemporaryFile empty("empty.obj", "");
    EXPECT_NE(failure(empty.path()), "");
    const TemporaryFile points("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    EXPECT_NE(failure(points.path()), "");
    const TemporaryFile flat("flat.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
    EXPECT_NE(failure(flat.path(), {.convex = true}), "");
    EXPECT_NE(failure(flat.path(), {.scale = -1}).find("scale is -1"), std::string::npos);
    const TemporaryFile wrong("wrong.obj", "v 0 0 0\nv 1 0 0\nf 1 2 77\n");
    EXPECT_NE(failure(wrong.path()), "");
}

TEST(LoadMesh, TellsWhichFormatsAreReadAndWhatAFileLooksLike) {
    const TemporaryFile vrml("scene.wrl", "#VRML V2.0 utf8\nShape { }\n");
    const std::string text = importError(vrml.path(), [&] { loadMesh(vrml.path()); });
    EXPECT_NE(text.find("is in no format that is read, which are FBX, glTF"), std::string::npos) << text;
    EXPECT_NE(text.find("; it looks like VRML"), std::string::npos) << text;
    const TemporaryFile wrong("picture.obj", "\x89PNG\r\n\x1a\n");
    EXPECT_NE(importError(wrong.path(), [&] { loadMesh(wrong.path()); }), "");
}

}  // namespace
}  // namespace ragtop
