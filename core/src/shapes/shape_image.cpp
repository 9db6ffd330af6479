#include "ragtop/shape_image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "base/checksum.h"
#include "shapes/geometry.h"

namespace ragtop {
namespace {

static_assert(std::endian::native == std::endian::little, "images are little-endian, and read in place");

[[noreturn]] void rejectImage(const std::string& why) { throw std::invalid_argument("image of a shape " + why); }

/// Where a table begins in the image, and how many elements it has.
struct TablePlace {
    std::uint64_t offset = 0, count = 0;
};

constexpr std::size_t aligned(std::size_t size) {
    return (size + ShapeImage::kAlignment - 1) / ShapeImage::kAlignment * ShapeImage::kAlignment;
}

struct MeshHead {
    static constexpr std::size_t kTables = 13;  ///< those of MeshData, and its text
    TablePlace table[kTables];
    Bounds bounds;
    std::int32_t degenerateCount = 0;
    float thickness = 0;
};
struct HullHead {
    static constexpr std::size_t kTables = 5;  ///< those of HullData
    TablePlace table[kTables];
    Vec3 center;
    float innerRadius = 0;
    Bounds bounds;
};

/// The tables in the order of the image.
template <class Mesh, class Visit>
void forEachTable(Mesh& mesh, Visit&& visit) {
    visit(mesh.vertices);
    visit(mesh.triangles);
    visit(mesh.sourceIndex);
    visit(mesh.normals);
    visit(mesh.activeEdges);
    visit(mesh.materialOfTriangle);
    visit(mesh.materials);
    visit(mesh.branches);
    visit(mesh.sourceTriangles);
    visit(mesh.neighbours);
    visit(mesh.vertexNormals);
    visit(mesh.owned);
}
template <class Hull, class Visit>
void forEachHullTable(Hull& hull, Visit&& visit) {
    visit(hull.vertices);
    visit(hull.planes);
    visit(hull.faces);
    visit(hull.faceIndices);
    visit(hull.edges);
}

template <class Head>
class Writer {
public:
    Writer() : bytes_(aligned(sizeof(Head))) {}

    template <class T>
    void add(const T* first, std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        head.table[next_++] = {bytes_.size(), count};
        const std::size_t at = bytes_.size();
        bytes_.resize(aligned(at + count * sizeof(T)));
        if (count > 0) std::memcpy(bytes_.data() + at, first, count * sizeof(T));
    }
    std::vector<std::byte> finish() {
        std::memcpy(bytes_.data(), &head, sizeof head);
        return std::move(bytes_);
    }

    Head head{};

private:
    std::vector<std::byte> bytes_;
    std::size_t next_ = 0;
};

template <class Head>
class Reader {
public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {
        if (reinterpret_cast<std::uintptr_t>(bytes.data()) % ShapeImage::kAlignment != 0)
            rejectImage("is not aligned to " + std::to_string(ShapeImage::kAlignment) + " bytes");
        if (bytes.size() < sizeof(Head))
            rejectImage("has " + std::to_string(bytes.size()) + " bytes, too few for its head");
        std::memcpy(&head, bytes.data(), sizeof head);
    }

    /// Lets a table be where it lies.
    template <class T>
    void read(std::span<const T>& table) {
        table = next<T>();
    }
    template <class T>
    void read(std::vector<T>& table) {
        const std::span<const T> found = next<T>();
        table.assign(found.begin(), found.end());
    }
    template <class T>
    std::span<const T> next() {
        const TablePlace& place = head.table[next_++];
        if (place.offset % ShapeImage::kAlignment != 0 || place.offset > bytes_.size() ||
            place.count > (bytes_.size() - place.offset) / sizeof(T))
            rejectImage("has table " + std::to_string(next_ - 1) + " beyond its end");
        return {reinterpret_cast<const T*>(bytes_.data() + place.offset), place.count};
    }

    Head head;

private:
    std::span<const std::byte> bytes_;
    std::size_t next_ = 0;
};

void require(bool holds, const char* what) {
    if (!holds) rejectImage(std::string("has ") + what);
}

/// Are numbers, each with `plus` added, all below `limit`, which is at most 2³¹? With 1, kNoTriangle counts as 0. Signs
/// tell, without branches and on every target: a game waits for it.
bool areBelow(std::size_t limit, const std::uint32_t* first, std::size_t count, std::uint32_t plus = 0) {
    const auto last = static_cast<std::uint32_t>(limit - 1);
    std::uint32_t signs = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t number = first[i] + plus;
        signs |= number | (last - number);
    }
    return signs >> 31 == 0;
}
bool areBelow(std::size_t limit, std::span<const Triangle> triangles) {
    static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
    return areBelow(limit, &triangles[0].a, 3 * triangles.size());
}

/// A tree: each branch but the first is a child once, of one before it, so that walks end; not deeper than their
/// stacks; and its leaves have as many triangles as there are.
void checkTree(const MeshData& mesh) {
    const std::size_t triangles = mesh.triangles.size(), branches = mesh.branches.size();
    require(branches > 0, "no tree");
    std::vector<std::uint8_t> depth(branches, 0);  // 0: no child yet
    depth[0] = 1;
    std::size_t inLeaves = 0;
    bool holds = true;
    for (std::size_t i = 0; i < branches && holds; ++i) {
        const MeshBranch& branch = mesh.branches[i];
        const auto below = static_cast<std::uint8_t>(depth[i] + 1);
        holds = depth[i] > 0 && depth[i] <= kMeshTreeDepth;
        for (int k = 0, children = branch.children(); k < children && holds; ++k) {
            const std::size_t first = branch.first[k], count = branch.count[k];
            inLeaves += count;
            if (count > 0) {
                holds = first <= triangles && count <= triangles - first;
            } else {
                holds = first > i && first < branches && depth[first] == 0;
                if (holds) depth[first] = below;
            }
        }
    }
    require(holds && inLeaves == triangles, "a branch of the tree out of range");
}

/// What a wrong value of would be read beyond the tables; a checksum of the file tells all else.
void check(const MeshData& mesh) {
    const std::size_t triangles = mesh.triangles.size(), given = mesh.sourceTriangles.size();
    require(triangles > 0 && given >= triangles && !mesh.vertices.empty(), "no triangles");
    require(mesh.sourceIndex.size() == triangles && mesh.normals.size() == triangles &&
                mesh.activeEdges.size() == triangles && mesh.neighbours.size() == triangles &&
                mesh.owned.size() == triangles && mesh.vertexNormals.size() == mesh.vertices.size() &&
                (mesh.materialOfTriangle.empty() || mesh.materialOfTriangle.size() == given),
            "tables of different lengths");
    constexpr std::size_t kMost = 0x7fffffff;  // as TriangleMesh allows
    require(triangles <= kMost && given <= kMost && mesh.vertices.size() <= kMost, "too many triangles");
    require(areBelow(mesh.vertices.size(), mesh.triangles) && areBelow(mesh.vertices.size(), mesh.sourceTriangles),
            "a triangle of a vertex that it does not have");
    require(areBelow(given, mesh.sourceIndex.data(), triangles), "a source index out of range");
    require(areBelow(triangles + 1, mesh.neighbours[0].data(), 3 * triangles, 1), "a neighbour out of range");
    bool holds = true;
    for (const std::uint8_t i : mesh.materialOfTriangle) holds = holds && i < mesh.materials.size();
    require(holds, "a material out of range");
    checkTree(mesh);
}

void check(const HullData& hull) {
    const std::size_t vertices = hull.vertices.size(), faces = hull.faces.size();
    require(vertices >= 4 && vertices <= 128 && faces >= 4 && hull.planes.size() == faces, "no volume");
    bool holds = true;
    for (const HullData::Face& face : hull.faces)
        holds = holds && face.count >= 3 && face.firstIndex + face.count <= static_cast<int>(hull.faceIndices.size());
    for (const std::uint8_t i : hull.faceIndices) holds = holds && i < vertices;
    for (const HullData::Edge& e : hull.edges)
        holds = holds && e.from < vertices && e.to < vertices && e.leftFace < faces && e.rightFace < faces;
    require(holds, "an index out of range");
    for (const Vec3& v : hull.vertices) holds = holds && isFinite(v);
    require(holds && hull.innerRadius > 0, "a number that is not finite");
}

}  // namespace

std::vector<std::byte> ShapeImage::of(const TriangleMesh& shape) {
    const MeshData& mesh = shape.data();
    Writer<MeshHead> writer;
    writer.head.bounds = mesh.bounds;
    writer.head.degenerateCount = mesh.degenerateCount;
    writer.head.thickness = mesh.thickness;
    forEachTable(mesh, [&](const auto& table) { writer.add(table.data(), table.size()); });
    writer.add(mesh.whyNotSolid.data(), mesh.whyNotSolid.size());
    return writer.finish();
}

std::vector<std::byte> ShapeImage::of(const ConvexHull& shape) {
    const HullData& hull = shape.data();
    Writer<HullHead> writer;
    writer.head.center = hull.center;
    writer.head.innerRadius = hull.innerRadius;
    writer.head.bounds = hull.bounds;
    forEachHullTable(hull, [&](const auto& table) { writer.add(table.data(), table.size()); });
    return writer.finish();
}

TriangleMesh ShapeImage::mesh(std::span<const std::byte> image, std::shared_ptr<const void> owner) {
    Reader<MeshHead> reader(image);
    MeshData mesh;
    forEachTable(mesh, [&](auto& table) { reader.read(table); });
    const std::span<const char> why = reader.next<char>();
    mesh.whyNotSolid.assign(why.begin(), why.end());
    mesh.bounds = reader.head.bounds;
    mesh.degenerateCount = reader.head.degenerateCount;
    mesh.thickness = reader.head.thickness;
    mesh.owner = std::move(owner);
    check(mesh);
    return TriangleMesh(std::make_shared<const MeshData>(std::move(mesh)));
}

ConvexHull ShapeImage::hull(std::span<const std::byte> image) {
    Reader<HullHead> reader(image);
    HullData hull;
    forEachHullTable(hull, [&](auto& table) { reader.read(table); });
    hull.center = reader.head.center;
    hull.innerRadius = reader.head.innerRadius;
    hull.bounds = reader.head.bounds;
    check(hull);
    return ConvexHull(std::make_shared<const HullData>(std::move(hull)));
}

std::uint64_t ShapeImage::checksum(std::span<const std::byte> bytes) { return ragtop::checksum(bytes); }

}  // namespace ragtop
