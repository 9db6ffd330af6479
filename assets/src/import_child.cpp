#include "import_child.h"

#include <string>
#include <system_error>
#include <utility>

#include "child_process.h"
#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

// What the bytes begin with.
constexpr char kImported = 's', kRefused = 'e';

std::vector<char> writeHere(const std::function<void(ByteWriter&)>& write) {
    ByteWriter imported;
    imported(kImported);
    try {
        write(imported);
        return std::move(imported).taken();
    } catch (const AssetError& error) {
        ByteWriter refused;
        refused(kRefused);
        refused(std::string(error.what()));
        return std::move(refused).taken();
    }
}

}  // namespace

void importInChild(const std::filesystem::path& path, const std::function<void(ByteWriter&)>& write,
                   const std::function<void(ByteReader&)>& read, std::chrono::milliseconds timeout) {
    const std::string file = path.string();
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) throw AssetError(file, "", "no such file");
    if (!std::filesystem::is_regular_file(path, ignored)) throw AssetError(file, "", "is not a file");
    ChildResult result;
    try {
        result = runInChild([&] { return writeHere(write); }, timeout);
    } catch (const std::system_error& error) {
        throw AssetError(file, "", std::string("no process to import it in: ") + error.what());
    }
    if (!result.failure.empty()) throw AssetError(file, "", "the file " + result.failure);
    try {
        ByteReader reader(result.bytes);
        char kind = 0;
        reader(kind);
        if (kind == kRefused) {
            std::string message;
            reader(message);
            throw AssetError(message);
        }
        read(reader);
        if (kind != kImported || !reader.atEnd()) throw std::length_error("import");
    } catch (const std::length_error&) {
        throw AssetError(file, "", "the file makes the importer fail");
    }
}

}  // namespace ragtop
