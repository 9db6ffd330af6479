#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ragtop {

/// Where a mesh of a robot is; empty where it is not.
struct RobotMeshFile {
    std::filesystem::path file;
    bool isOutside = false;  ///< the name leads to where descriptions may not read
};

/// As the description names it: in the folder above the description's, or an absolute name in one of the package roots;
/// for package://name/path in a package root or a folder above the description. Names that lead out of these are not
/// followed.
RobotMeshFile findRobotMesh(const std::string& name, const std::filesystem::path& description,
                            const std::vector<std::filesystem::path>& packageRoots);

}  // namespace ragtop
