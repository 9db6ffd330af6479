#pragma once

#include <string>

struct aiNode;

namespace ragtop {

/// assimp tells by name which node a bone is and which one a track of a clip moves, but names are no identity in glTF.
bool haveEqualNames(const aiNode& root);

/// A glTF file, text or binary, whose nodes have their number before their name.
std::string withNumberedNodes(const std::string& file);

/// The name that a node has in the file, without such a number.
std::string nameInFile(const std::string& name);

}  // namespace ragtop
