#pragma once

#include <cstddef>
#include <vector>

#include "assimp_scene.h"
#include "ragtop/character.h"

namespace ragtop {

/// A mesh of a character in its rest pose.
struct CharacterPiece {
    std::size_t mesh = 0;  ///< of the scene
    Affine place;          ///< of the mesh in the scene
    int bone = -1;         ///< of the skeleton, that it hangs on; −1: its own weights say
};

/// A character and the file it was made from.
struct ImportedCharacter {
    Character character;
    ImportedScene scene;
    std::vector<CharacterPiece> pieces;
    std::vector<int> boneOf;  ///< bone of the skeleton that each node of the scene is; −1: none
    Affine toModel;           ///< from the scene to metres with Y up
};

/// As loadCharacter, with all that `detail` asks for.
ImportedCharacter importCharacter(const std::filesystem::path& path, const CharacterOptions& options,
                                  ImportedDetail detail);

}  // namespace ragtop
