#include "mapped_file.h"

#include "layout.h"
#include "ragtop/cooked.h"

#ifdef __unix__
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#else
#include <fstream>
#include <new>
#endif

namespace ragtop {
#ifdef __unix__

MappedFile mapFile(const std::filesystem::path& path) {
    const auto fail = [&](const char* what) -> CookedError {
        return CookedError(path.string() + ": " + what + ": " + std::strerror(errno));
    };
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) throw fail("cannot be opened");
    struct stat status {};
    const bool known = ::fstat(file, &status) == 0;
    if (!known || !S_ISREG(status.st_mode) || status.st_size <= 0) {
        ::close(file);
        throw CookedError(path.string() + ": is no file with something in it");
    }
    const auto size = static_cast<std::size_t>(status.st_size);
    int flags = MAP_PRIVATE;
#ifdef MAP_POPULATE
    flags |= MAP_POPULATE;  // its checksums read all of it
#endif
    void* at = ::mmap(nullptr, size, PROT_READ, flags, file, 0);
    ::close(file);
    if (at == MAP_FAILED) throw fail("cannot be mapped");
    const std::shared_ptr<const void> owner(at,
                                            [size](const void* mapped) { ::munmap(const_cast<void*>(mapped), size); });
    return {{static_cast<const std::byte*>(at), size}, owner};
}

#else

MappedFile mapFile(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = file ? static_cast<std::streamoff>(file.tellg()) : 0;
    if (size <= 0) throw CookedError(path.string() + ": is no file with something in it");
    const std::align_val_t alignment{kCookedAlignment};
    auto* at = static_cast<std::byte*>(::operator new(static_cast<std::size_t>(size), alignment));
    const std::shared_ptr<const void> owner(
        at, [alignment](const void* held) { ::operator delete(const_cast<void*>(held), alignment); });
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(at), size)) throw CookedError(path.string() + ": cannot be read");
    return {{at, static_cast<std::size_t>(size)}, owner};
}

#endif
}  // namespace ragtop
