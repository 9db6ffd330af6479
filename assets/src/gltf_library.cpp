#define TINYGLTF_IMPLEMENTATION
#include "gltf_library.h"
