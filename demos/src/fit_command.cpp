#include "fit_command.h"

#include <fmt/format.h>

#include <fstream>
#include <stdexcept>

#include "json_text.h"
#include "ragtop/find_asset.h"
#include "ragtop/mesh_file.h"
#include "ragtop/simplification.h"
#include "ragtop/surface_mesh.h"

namespace ragtop::demos {
namespace {

struct Fitted {
    Decomposition pieces;
    std::size_t triangles = 0, taken = 0;  ///< of the file, and of what was taken apart
    float simplified = 0;                  ///< m, measured
};

Fitted fitted(const FitCommand& command) {
    const std::filesystem::path path = findAsset(command.asset);
    const Shape shape = loadMesh(path);
    const auto& mesh = std::get<TriangleMesh>(shape);
    Fitted result;
    result.triangles = result.taken = mesh.triangles().size();
    const TaskRunner tasks = command.threads > 1 ? tbbTasks(command.threads) : serialTasks();
    try {
        if (command.simplify > 0) {
            const SimplerSurface less = simplify(mesh.vertices(), mesh.triangles(), command.simplify);
            result.taken = less.triangles.size();
            result.simplified = less.error;
            result.pieces = decompose(TriangleMesh(less.vertices, less.triangles), command.limits, tasks);
        } else {
            result.pieces = decompose(mesh, command.limits, tasks);
        }
    } catch (const std::invalid_argument& error) {
        throw AssetError(path.string(), "", error.what());
    }
    return result;
}

std::string vertexList(const ConvexHull& piece) {
    std::string text;
    for (const Vec3& v : piece.vertices())
        text +=
            fmt::format("{}[{}, {}, {}]", text.empty() ? "" : ", ", jsonNumber(v.x), jsonNumber(v.y), jsonNumber(v.z));
    return "[" + text + "]";
}

std::string asJson(const FitCommand& command, const Fitted& result) {
    return fmt::format(
        "{{\n    \"asset\": {},\n    \"triangles\": {},\n    \"taken\": {},\n    \"simplified\": {},\n    \"error\": "
        "{},\n"
        "    \"volume\": {},\n    \"solidVolume\": {},\n    \"within\": {},\n    \"fewestPieces\": {},\n{}\n}}\n",
        jsonString(command.asset), result.triangles, result.taken, jsonNumber(result.simplified),
        jsonNumber(result.pieces.error), jsonNumber(result.pieces.volume), jsonNumber(result.pieces.solidVolume),
        result.pieces.isWithin(command.limits), result.pieces.fewestPieces,
        jsonList("pieces", result.pieces.pieces, vertexList));
}

std::string asText(const FitCommand& command, const Fitted& result) {
    const Decomposition& d = result.pieces;
    std::size_t most = 0;
    for (const ConvexHull& piece : d.pieces) most = std::max(most, piece.vertices().size());
    std::string text = fmt::format("{}: {} pieces of up to {} vertices\n", command.asset, d.pieces.size(), most);
    if (command.simplify > 0)
        text += fmt::format("  {} of {} triangles, {:.3g} m off\n", result.taken, result.triangles, result.simplified);
    text += fmt::format(
        "  farthest air {:.3g} m (at most {:.3g}), volume {:.4f} times the solid's {:.4g} m3 (at most {:g})\n", d.error,
        command.limits.maxError, d.volume / d.solidVolume, d.solidVolume, command.limits.maxVolume);
    if (d.fewestPieces > command.limits.maxPieces)
        text += fmt::format("  no {} pieces keep to the error\n", command.limits.maxPieces);
    else if (!d.isWithin(command.limits))
        text += fmt::format("  {} pieces do not suffice, {} do not in any way\n", command.limits.maxPieces,
                            d.fewestPieces - 1);
    return text;
}

void write(const Decomposition& decomposition, const std::string& out) {
    std::ofstream file(out);
    std::size_t first = 1;
    for (std::size_t i = 0; i < decomposition.pieces.size(); ++i) {
        const auto vertices = decomposition.pieces[i].vertices();
        file << fmt::format("o piece{}\n", i);
        for (const Vec3& v : vertices) file << fmt::format("v {} {} {}\n", v.x, v.y, v.z);
        const std::vector<std::uint32_t> faces = hullTriangles(vertices);
        for (std::size_t k = 0; k + 2 < faces.size(); k += 3)
            file << fmt::format("f {} {} {}\n", first + faces[k], first + faces[k + 1], first + faces[k + 2]);
        first += vertices.size();
    }
    if (!file.flush()) throw AssetError(out + ": cannot be written");
}

}  // namespace

bool fit(const FitCommand& command) {
    const Fitted result = fitted(command);
    fmt::print("{}", command.json ? asJson(command, result) : asText(command, result));
    if (command.out) write(result.pieces, *command.out);
    return result.pieces.isWithin(command.limits);
}

}  // namespace ragtop::demos
