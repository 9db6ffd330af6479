#include "file_kind.h"

#include <algorithm>
#include <array>

namespace ragtop {
namespace {

struct Signature {
    std::string_view bytes, format;
};

constexpr std::string_view kUsd =
    "USD, which is not read, nor is its UsdPhysics; glTF with KHR_physics_rigid_bodies is";

/// Of formats that people try, whether or not they are read.
constexpr std::array kBinary{
    Signature{"glTF", "binary glTF"},
    Signature{"Kaydara FBX Binary", "FBX"},
    Signature{"BLENDER", "Blender's own format"},
    Signature{"PK\x03\x04", "a ZIP archive"},
    Signature{"\x1f\x8b", "a gzip archive"},
    Signature{"\x89PNG", "a PNG picture"},
    Signature{"\xff\xd8\xff", "a JPEG picture"},
    Signature{"%PDF", "a PDF document"},
    Signature{"\x7f"
              "ELF",
              "a program"},
    Signature{"#VRML", "VRML"},
    Signature{"#usda", kUsd},
    Signature{"PXR-USDC", kUsd},
    Signature{"HIERARCHY", "BVH"},
    Signature{"ply", "PLY"},
    Signature{"solid ", "STL"},
    Signature{"xof ", "DirectX's X"},
};

/// By the first element of XML.
constexpr std::array kElements{
    Signature{"robot", "URDF"},
    Signature{"mujoco", "MJCF, MuJoCo's format"},
    Signature{"mujocoinclude", "MJCF, MuJoCo's format"},
    Signature{"sdf", "SDFormat"},
    Signature{"COLLADA", "Collada"},
    Signature{"X3D", "X3D"},
    Signature{"html", "HTML"},
    Signature{"svg", "SVG"},
};

std::string_view firstElement(std::string_view text) {
    for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at + 1)) {
        const std::string_view name = text.substr(at + 1);
        if (name.starts_with("!--")) {
            at = std::min(text.find("-->", at), text.size());
        } else if (!name.starts_with('?') && !name.starts_with('!')) {
            return name.substr(0, name.find_first_of(" \t\r\n/>"));
        }
    }
    return {};
}

}  // namespace

std::string looksLike(std::string_view file) {
    const auto is = [](std::string_view format) { return "; it looks like " + std::string(format); };
    // The first file of a USD package has its name after the 30 bytes of the archive's header.
    if (file.starts_with("PK\x03\x04") && file.substr(0, 512).find(".usd") != std::string_view::npos) return is(kUsd);
    for (const Signature& one : kBinary)
        if (file.starts_with(one.bytes)) return is(one.format);
    const std::size_t first = file.find_first_not_of("\xef\xbb\xbf \t\r\n");
    if (first == std::string_view::npos) return file.empty() ? "; it is empty" : "";
    if (file[first] == '<') {
        const std::string_view element = firstElement(file);
        for (const Signature& one : kElements)
            if (element == one.bytes) return is(one.format);
        return "; it looks like XML with <" + std::string(element) + ">";
    }
    return file[first] == '{' || file[first] == '[' ? is("JSON") : "";
}

}  // namespace ragtop
