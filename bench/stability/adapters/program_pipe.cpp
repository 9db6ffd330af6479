#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "program.h"

namespace ragtop::stability {
namespace {

constexpr std::size_t kLongest = 64u << 20;  // bytes of an answer

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error("the program " + what); }

}  // namespace

ProgramPipe::ProgramPipe(const std::string& command, double patience) : patience_(patience) {
    int in[2], out[2];
    if (::pipe2(in, O_CLOEXEC) != 0) fail("cannot be asked: " + std::string(std::strerror(errno)));
    if (::pipe2(out, O_CLOEXEC) != 0) fail("cannot be asked: " + std::string(std::strerror(errno)));
    // Writing to one that has ended is an error to be told, not the end of this process.
    std::signal(SIGPIPE, SIG_IGN);
    process_ = ::fork();
    if (process_ < 0) fail("cannot be started: " + std::string(std::strerror(errno)));
    if (process_ == 0) {
        ::setpgid(0, 0);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        ::dup2(in[0], 0);
        ::dup2(out[1], 1);
        const std::string replaced = "exec " + command;  // so that no shell stands between
        ::execl("/bin/sh", "sh", "-c", replaced.c_str(), nullptr);
        std::_Exit(127);
    }
    ::close(in[0]);
    ::close(out[1]);
    in_ = in[1];
    out_ = out[0];
}

ProgramPipe::~ProgramPipe() {
    ::close(in_);
    ::close(out_);
    ::kill(-process_, SIGKILL);
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
}

void ProgramPipe::tell(const std::string& line) {
    const std::string text = line + "\n";
    for (std::size_t at = 0; at < text.size();) {
        const ssize_t count = ::write(in_, text.data() + at, text.size() - at);
        if (count < 0 && errno != EINTR) fail("has ended");
        if (count > 0) at += static_cast<std::size_t>(count);
    }
}

std::string ProgramPipe::answer() {
    using Clock = std::chrono::steady_clock;
    const auto until = Clock::now() + std::chrono::duration<double>(patience_);
    while (true) {
        if (const std::size_t end = rest_.find('\n'); end != std::string::npos) {
            std::string line = rest_.substr(0, end);
            rest_.erase(0, end + 1);
            return line;
        }
        if (rest_.size() > kLongest) fail("answers without end");
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
        if (left <= 0) fail("does not answer within " + std::to_string(static_cast<int>(patience_)) + " s");
        pollfd ready{out_, POLLIN, 0};
        if (::poll(&ready, 1, static_cast<int>(left)) <= 0) continue;
        char buffer[65536];
        const ssize_t count = ::read(out_, buffer, sizeof buffer);
        if (count == 0 || (count < 0 && errno != EINTR)) fail("has ended");
        if (count > 0) rest_.append(buffer, static_cast<std::size_t>(count));
    }
}

}  // namespace ragtop::stability
