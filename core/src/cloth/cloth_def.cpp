#include <cmath>
#include <set>
#include <utility>

#include "base/check_tunables.h"
#include "ragtop/cloth.h"

namespace ragtop {
namespace {

constexpr int kMostPoints = 65536;  ///< of a cloth

std::string element(const char* list, std::size_t i) { return std::string(list) + "[" + std::to_string(i) + "]"; }

/// Empty when `index` is one of the points.
std::string whyNoPoint(const ClothDef& def, const std::string& name, int index) {
    if (index >= 0 && index < static_cast<int>(def.points.size())) return {};
    return name + " is " + std::to_string(index) + ", must be in [0, " + std::to_string(def.points.size() - 1) + "]";
}

std::string whyNoLength(const ClothDef& def, const std::string& name, int a, int b) {
    const float rest = length(def.points[static_cast<std::size_t>(a)] - def.points[static_cast<std::size_t>(b)]);
    if (rest > 1e-5f) return {};
    return name + " joins points " + std::to_string(a) + " and " + std::to_string(b) + ", which are " + numberText(rest) +
           " m apart, must be more than 0.00001 m";
}

std::string whyInvalidFace(const ClothDef& def, std::size_t i) {
    const ClothFace& face = def.faces[i];
    const std::string name = element("faces", i);
    const std::pair<const char*, int> corners[] = {{".a", face.a}, {".b", face.b}, {".c", face.c}, {".d", face.d}};
    const std::size_t count = face.d == -1 ? 3 : 4;
    for (std::size_t k = 0; k < count; ++k)
        if (std::string why = whyNoPoint(def, name + corners[k].first, corners[k].second); !why.empty()) return why;
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t l = 0; l < k; ++l)
            if (std::string why = whyNoLength(def, name, corners[l].second, corners[k].second); !why.empty()) return why;
    const auto at = [&](int corner) { return def.points[static_cast<std::size_t>(corner)]; };
    const Vec3 across = face.d == -1 ? at(face.b) - at(face.a) : at(face.c) - at(face.a);
    const Vec3 other = face.d == -1 ? at(face.c) - at(face.a) : at(face.d) - at(face.b);
    if (!(length(cross(across, other)) > 1e-5f * length(across) * length(other)))
        return name + " has its corners in a line, must have an area";
    return {};
}

std::string whyInvalidLine(const ClothDef& def, std::size_t i) {
    const ClothLine& line = def.lines[i];
    const std::string name = element("lines", i);
    if (std::string why = whyNoPoint(def, name + ".a", line.a); !why.empty()) return why;
    if (std::string why = whyNoPoint(def, name + ".b", line.b); !why.empty()) return why;
    return whyNoLength(def, name, line.a, line.b);
}

std::string whyInvalidAttachments(const ClothDef& def) {
    std::set<int> attached;
    for (std::size_t i = 0; i < def.attachments.size(); ++i) {
        const ClothAttachment& attachment = def.attachments[i];
        const std::string name = element("attachments", i);
        if (std::string why = whyNoPoint(def, name + ".point", attachment.point); !why.empty()) return why;
        if (!attached.insert(attachment.point).second)
            return name + ".point is " + std::to_string(attachment.point) + ", which is attached already, must be once";
        if (attachment.place) {
            if (std::string why = whyNotFinite(name + ".place", *attachment.place); !why.empty()) return why;
            if (attachment.body.isNull()) return name + ".place needs " + name + ".body, which is null";
        }
    }
    return {};
}

std::string whyInvalidSkin(const ClothDef& def) {
    if (def.skin.empty()) return {};
    if (def.skin.size() != def.points.size())
        return "skin has " + std::to_string(def.skin.size()) + " elements, must have none or one for each of " +
               std::to_string(def.points.size()) + " points";
    for (std::size_t i = 0; i < def.skin.size(); ++i)
        if (std::string why = whyOutOfRange(def.skin[i], element("skin", i) + "."); !why.empty()) return why;
    return {};
}

/// A point without mass would go anywhere.
std::string whyLoose(const ClothDef& def) {
    std::vector<char> held(def.points.size(), 0);
    const auto hold = [&](int i) { held[static_cast<std::size_t>(i)] = 1; };
    for (const ClothFace& face : def.faces) {
        for (const int corner : {face.a, face.b, face.c}) hold(corner);
        if (face.d >= 0) hold(face.d);
    }
    for (const ClothLine& line : def.lines)
        for (const int end : {line.a, line.b}) hold(end);
    for (std::size_t i = 0; i < held.size(); ++i)
        if (!held[i]) return element("points", i) + " is part of no face or line, must be of one";
    return {};
}

}  // namespace

std::string whyInvalid(const ClothDef& def) {
    if (def.points.size() < 2 || def.points.size() > kMostPoints)
        return "points has " + std::to_string(def.points.size()) + " elements, must have 2 to " + std::to_string(kMostPoints);
    for (std::size_t i = 0; i < def.points.size(); ++i) {
        TunableCheck check;
        check(Tunable{element("points", i), "m", -1e5, 1e5, ""}, def.points[i]);
        if (!check.why().empty()) return check.why();
    }
    if (std::string why = whyOutOfRange(def); !why.empty()) return why;
    for (std::size_t i = 0; i < def.faces.size(); ++i)
        if (std::string why = whyInvalidFace(def, i); !why.empty()) return why;
    for (std::size_t i = 0; i < def.lines.size(); ++i)
        if (std::string why = whyInvalidLine(def, i); !why.empty()) return why;
    if (std::string why = whyInvalidAttachments(def); !why.empty()) return why;
    if (std::string why = whyInvalidSkin(def); !why.empty()) return why;
    return whyLoose(def);
}

ClothDef clothSheet(int columns, int rows, const Vec3& across, const Vec3& down) {
    ClothDef def;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
            def.points.push_back((static_cast<float>(column) / static_cast<float>(columns - 1)) * across +
                                 (static_cast<float>(row) / static_cast<float>(rows - 1)) * down);
    for (int row = 0; row + 1 < rows; ++row)
        for (int column = 0; column + 1 < columns; ++column) {
            const int first = row * columns + column;
            def.faces.push_back({first, first + columns, first + columns + 1, first + 1});
        }
    return def;
}

ClothDef clothRope(int points, const Vec3& along) {
    ClothDef def;
    for (int i = 0; i < points; ++i)
        def.points.push_back((static_cast<float>(i) / static_cast<float>(points - 1)) * along);
    for (int i = 0; i + 1 < points; ++i) def.lines.push_back({i, i + 1});
    return def;
}

}  // namespace ragtop
