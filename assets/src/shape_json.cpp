#include "shape_json.h"

#include <fmt/format.h>

#include <stdexcept>
#include <vector>

#include "asset_reference.h"
#include "describe_json.h"
#include "height_grid.h"

namespace ragtop {
namespace {

struct MeshInFile {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const MeshInFile*) {
    visit(Tunable{"vertices", "m", -1e5, 1e5, "corners of the triangles"}, self.vertices);
    visit(Tunable{"triangles", "", 0, 4294967295.0, "three indices of vertices each, counter-clockwise from outside"},
          self.triangles);
}

/// Lets a reference to a file stand instead of the value.
Json orFile(Json schema, const char* hint) {
    schema["type"] = {schema["type"], "string"};
    schema["hint"] = hint;
    return schema;
}

Json compoundSchema() {
    Json part{{"type", "object"}, {"additionalProperties", false}, {"required", {"shape"}}};
    part["properties"] = {{"shape", shapeSchema(false)}, {"frame", frameSchema()}};
    return {{"type", "array"}, {"items", part}, {"minItems", 1}};
}

/// Makes a shape and gives what its constructor or check has against it the place in the file.
template <class Make>
Shape checked(const JsonValue& value, Make make) {
    std::string wrong;
    try {
        Shape shape = make();
        wrong = whyInvalid(shape);
        if (wrong.empty()) return shape;
    } catch (const std::invalid_argument& error) {
        wrong = error.what();
    }
    value.fail("makes no shape: " + wrong);
}

template <class T>
T read(const JsonValue& value) {
    T whole{};
    readValue(value, whole);
    return whole;
}

Shape readHull(const JsonValue& value) {
    if (value.json().is_string()) return loadMeshReference(value, true);
    return ConvexHull(read<std::vector<Vec3>>(value));
}

Shape readMesh(const JsonValue& value) {
    if (value.json().is_string()) return loadMeshReference(value, false);
    const auto mesh = read<MeshInFile>(value);
    std::vector<Triangle> triangles;
    for (const auto& t : mesh.triangles) triangles.push_back({t[0], t[1], t[2]});
    return TriangleMesh(mesh.vertices, triangles);
}

Shape readCompound(const JsonValue& value) {
    Compound compound;
    for (std::size_t i = 0; i < value.size(); ++i) {
        CompoundPart part;
        readValue(value.at(i).at("shape"), part.shape);
        if (value.at(i).has("frame")) readValue(value.at(i).at("frame"), part.frame);
        compound.parts.push_back(std::move(part));
    }
    if (value.holdsWrong()) throw Faults::Consequence();
    return compound;
}

struct Writer {
    Json operator()(const Sphere& s) const { return {{"sphere", writeValue(s)}}; }
    Json operator()(const Capsule& s) const { return {{"capsule", writeValue(s)}}; }
    Json operator()(const Box& s) const { return {{"box", writeValue(s)}}; }
    Json operator()(const ConvexHull& s) const {
        const auto points = s.vertices();
        return {{"hull", writeValue(std::vector<Vec3>(points.begin(), points.end()))}};
    }
    Json operator()(const TriangleMesh& s) const {
        MeshInFile mesh{{s.vertices().begin(), s.vertices().end()}, {}};
        for (const Triangle& t : s.triangles()) mesh.triangles.push_back({t.a, t.b, t.c});
        return {{"mesh", writeValue(mesh)}};
    }
    Json operator()(const HeightField& s) const { return {{"heightField", writeValue(gridOf(s))}}; }
    Json operator()(const Compound& s) const {
        Json parts = Json::array();
        for (const CompoundPart& part : s.parts) {
            parts.push_back({{"shape", writeShape(part.shape)}, {"frame", writeValue(part.frame)}});
        }
        return {{"compound", std::move(parts)}};
    }
};

}  // namespace

Json shapeSchema(bool compounds) {
    const Tunable point{.name = "", .unit = "m", .minimum = -1e5, .maximum = 1e5};
    Json schema{{"type", "object"}, {"additionalProperties", false}, {"minProperties", 1}, {"maxProperties", 1}};
    schema["properties"] = {
        {"box", objectSchema(Box{})},
        {"sphere", objectSchema(Sphere{})},
        {"capsule", objectSchema(Capsule{})},
        {"hull", orFile(schemaOf(point, std::vector<Vec3>{}), "at least four points [[x, y, z], ...] or a mesh file")},
        {"mesh", orFile(objectSchema(MeshInFile{}), "{\"vertices\", \"triangles\"} or a mesh file")},
        {"heightField", objectSchema(HeightGrid{})}};
    if (compounds) schema["properties"]["compound"] = compoundSchema();
    schema["hint"] = "an object with one of box, sphere, capsule, hull, mesh, heightField, compound";
    return schema;
}

Shape readShape(const JsonValue& value) {
    const std::string kind = value.json().begin().key();
    const JsonValue inner = value.at(kind);
    if (kind != "compound" && inner.holdsWrong()) throw Faults::Consequence();
    return checked(inner, [&]() -> Shape {
        if (kind == "box") return read<Box>(inner);
        if (kind == "sphere") return read<Sphere>(inner);
        if (kind == "capsule") return read<Capsule>(inner);
        if (kind == "hull") return readHull(inner);
        if (kind == "mesh") return readMesh(inner);
        if (kind == "heightField") return heightFieldOf(read<HeightGrid>(inner));
        return readCompound(inner);
    });
}

Json writeShape(const Shape& shape) { return std::visit(Writer{}, shape); }

}  // namespace ragtop
