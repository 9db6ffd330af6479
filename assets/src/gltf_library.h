#pragma once

// tinygltf under a name of its own. Debian's libdraco, which comes with assimp, carries another version of the same
// symbols; whichever the linker meets first would answer calls made for the other.
#define tinygltf ragtop_tinygltf
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_JSON
#include <nlohmann/json.hpp>

#include <tiny_gltf.h>
