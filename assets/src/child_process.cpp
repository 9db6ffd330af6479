#include "child_process.h"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>

namespace ragtop {
namespace {

using Clock = std::chrono::steady_clock;

constexpr rlim_t kMemory = rlim_t{4} << 30;                ///< bytes of address space for the child
constexpr std::size_t kStack = std::size_t{64} << 20;      ///< bytes, that the child may recurse in
constexpr std::size_t kGuard = std::size_t{1} << 20;       ///< bytes below it, larger than any function's own
constexpr int kOutOfMemory = 3, kThrew = 4, kTooDeep = 5;  ///< exit codes

// Sanitizers reserve terabytes of address space for their own maps, and watch stacks themselves.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimited = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
constexpr bool kLimited = false;
#else
constexpr bool kLimited = true;
#endif
#else
constexpr bool kLimited = true;
#endif

void writeAll(int file, const char* bytes, std::size_t size) {
    std::size_t done = 0;
    while (done < size) {
        const ssize_t count = write(file, bytes + done, size - done);
        if (count < 0 && errno != EINTR) _exit(kThrew);
        if (count > 0) done += static_cast<std::size_t>(count);
    }
}

[[noreturn]] void runAndExit(const std::function<std::vector<char>()>& work, int out) {
    try {
        const std::vector<char> bytes = work();
        const std::uint64_t size = bytes.size();
        writeAll(out, reinterpret_cast<const char*>(&size), sizeof size);
        writeAll(out, bytes.data(), bytes.size());
    } catch (const std::bad_alloc&) {
        _exit(kOutOfMemory);
    } catch (...) {
        _exit(kThrew);
    }
    _exit(0);
}

std::uintptr_t stackBottom = 0;  ///< of the child's one thread

void onBadAccess(int number, siginfo_t* what, void*) {
    const auto at = reinterpret_cast<std::uintptr_t>(what->si_addr);
    if (at + kGuard >= stackBottom && at < stackBottom + kGuard) _exit(kTooDeep);
    signal(number, SIG_DFL);
    raise(number);
}

struct ChildTask {
    const std::function<std::vector<char>()>& work;
    int out;
};

void* runOnStack(void* given) {
    static std::array<std::byte, 65536> forHandler;
    stack_t other{};
    other.ss_sp = forHandler.data();
    other.ss_size = forHandler.size();
    sigaltstack(&other, nullptr);
    struct sigaction action {};
    action.sa_sigaction = onBadAccess;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
    sigaction(SIGSEGV, &action, nullptr);
    const auto& task = *static_cast<const ChildTask*>(given);
    runAndExit(task.work, task.out);
}

/// On a stack of known size, whose end is told apart from other faults: libraries recurse on what they read.
void runDeep(const ChildTask& task) {
    mallopt(M_ARENA_MAX, 1);
    void* memory = std::aligned_alloc(kGuard, kStack + kGuard);
    pthread_attr_t attributes;
    pthread_t thread{};
    if (!memory || mprotect(memory, kGuard, PROT_NONE) != 0 || pthread_attr_init(&attributes) != 0) return;
    auto* stack = static_cast<std::byte*>(memory) + kGuard;
    stackBottom = reinterpret_cast<std::uintptr_t>(stack);
    if (pthread_attr_setstack(&attributes, stack, kStack) != 0) return;
    if (pthread_create(&thread, &attributes, runOnStack, const_cast<ChildTask*>(&task)) == 0)
        pthread_join(thread, nullptr);
}

[[noreturn]] void runChild(const std::function<std::vector<char>()>& work, int out) {
    for (const int number : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGPIPE}) signal(number, SIG_DFL);
    const rlimit noCore{0, 0}, memory{kMemory, kMemory};
    setrlimit(RLIMIT_CORE, &noCore);
    if (kLimited) setrlimit(RLIMIT_AS, &memory);
    const int nowhere = open("/dev/null", O_RDWR);
    if (nowhere >= 0)
        for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, standard);
    if (kLimited) runDeep({work, out});
    runAndExit(work, out);
}

/// Up to so many bytes. False when time ran out.
bool readAll(int file, Clock::time_point deadline, char* into, std::size_t size, std::size_t& done) {
    while (done < size) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
        if (left <= 0) return false;
        pollfd waiting{file, POLLIN, 0};
        const int ready = poll(&waiting, 1, static_cast<int>(left));
        if (ready == 0) return false;
        if (ready < 0) {
            if (errno == EINTR) continue;
            return true;
        }
        const ssize_t count = read(file, into + done, size - done);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return true;
        done += static_cast<std::size_t>(count);
    }
    return true;
}

/// The number of bytes, and then these: none where the child ended before. Reading them into their place saves copies
/// as they become more.
bool readMessage(int file, Clock::time_point deadline, std::vector<char>& bytes) {
    std::uint64_t size = 0;
    std::size_t done = 0;
    if (!readAll(file, deadline, reinterpret_cast<char*>(&size), sizeof size, done)) return false;
    if (done < sizeof size || size > kMemory) return true;
    bytes.resize(size);
    done = 0;
    const bool inTime = readAll(file, deadline, bytes.data(), bytes.size(), done);
    bytes.resize(done);
    return inTime;
}

std::string failureOf(pid_t child) {
    int status = 0;
    pid_t ended = 0;
    do ended = waitpid(child, &status, 0);
    while (ended < 0 && errno == EINTR);
    // A caller that ignores SIGCHLD leaves no status behind; the bytes then speak for themselves.
    if (ended < 0) return {};
    if (WIFSIGNALED(status)) return std::string("crashes the importer (") + strsignal(WTERMSIG(status)) + ")";
    if (WEXITSTATUS(status) == kOutOfMemory) return "needs more than 4 GiB of memory to import";
    if (WEXITSTATUS(status) == kTooDeep)
        return "nests deeper than the " + std::to_string(kStack >> 20) + " MiB of the importer's stack hold";
    if (WEXITSTATUS(status) != 0) return "makes the importer fail";
    return {};
}

}  // namespace

ChildResult runInChild(const std::function<std::vector<char>()>& work, std::chrono::milliseconds timeout) {
    const Clock::time_point deadline = Clock::now() + timeout;
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    const pid_t child = fork();
    if (child < 0) {
        const int error = errno;
        close(ends[0]);
        close(ends[1]);
        throw std::system_error(error, std::generic_category(), "fork");
    }
    if (child == 0) {
        close(ends[0]);
        runChild(work, ends[1]);
    }
    close(ends[1]);
    ChildResult result;
    bool inTime = false;
    try {
        inTime = readMessage(ends[0], deadline, result.bytes);
    } catch (...) {
        close(ends[0]);
        kill(child, SIGKILL);
        failureOf(child);
        throw;
    }
    close(ends[0]);
    if (!inTime) kill(child, SIGKILL);
    result.failure = failureOf(child);
    if (!inTime) result.failure = "takes the importer longer than " + std::to_string(timeout.count() / 1000) + " s";
    return result;
}

}  // namespace ragtop
