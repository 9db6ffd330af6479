#include "isolation.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <system_error>

namespace ragtop::stability {
namespace {

struct Child {
    std::size_t work;
    pid_t process;
    int pipe;
    std::string text;
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
    bool late = false;  ///< ended for taking too long by the clock
};

/// Nobody waits for a child whose parent is gone, and its limit is the system's task.
void bindChild(double limit) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (!std::isfinite(limit)) return;
    const auto seconds = static_cast<rlim_t>(std::ceil(limit));
    const rlimit cpu{seconds, seconds + 1};
    ::setrlimit(RLIMIT_CPU, &cpu);
}

[[noreturn]] void runChild(const std::function<std::string()>& job, int pipe) noexcept {
    const std::string text = job();
    for (std::size_t at = 0; at < text.size();) {
        const ssize_t count = ::write(pipe, text.data() + at, text.size() - at);
        if (count < 0) std::_Exit(1);
        at += static_cast<std::size_t>(count);
    }
    std::_Exit(0);
}

Child start(std::size_t index, const std::function<std::string()>& job, double limit) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    std::fflush(nullptr);
    const pid_t process = ::fork();
    if (process < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (process == 0) {
        ::close(ends[0]);
        bindChild(limit);
        runChild(job, ends[1]);
    }
    ::close(ends[1]);
    Child child{};
    child.work = index;
    child.process = process;
    child.pipe = ends[0];
    return child;
}

Outcome finish(Child& child, double limit) {
    ::close(child.pipe);
    int status = 0;
    rusage usage{};
    ::wait4(child.process, &status, 0, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    const double took = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    if (child.late || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU))
        return {{}, "took longer than its " + std::to_string(std::lround(std::ceil(limit))) + " s", took};
    if (WIFSIGNALED(status)) return {{}, ::strsignal(WTERMSIG(status)), took};
    if (WEXITSTATUS(status) != 0) return {{}, "exit code " + std::to_string(WEXITSTATUS(status)), took};
    return {std::move(child.text), {}, took};
}

/// Reads what the children have to say; true when the child is at its end.
bool readSome(Child& child) {
    char buffer[4096];
    const ssize_t count = ::read(child.pipe, buffer, sizeof buffer);
    if (count > 0) child.text.append(buffer, static_cast<std::size_t>(count));
    return count == 0 || (count < 0 && errno != EINTR);
}

/// Ends children that sleep, so that the processor's limit never comes.
void endLate(std::vector<Child>& running, double limit, double patience) {
    for (Child& child : running) {
        const std::chrono::duration<double> age = std::chrono::steady_clock::now() - child.since;
        if (child.late || !(age.count() > 4 * limit + patience)) continue;
        child.late = true;
        ::kill(child.process, SIGKILL);
    }
}

}  // namespace

void runIsolated(const std::vector<std::function<std::string()>>& works, int processes,
                 const std::function<void(std::size_t work, const Outcome&)>& done, double limit, double patience) {
    std::vector<Child> running;
    std::vector<std::optional<Outcome>> outcomes(works.size());
    std::size_t next = 0, reported = 0;
    while (reported < works.size()) {
        while (next < works.size() && running.size() < static_cast<std::size_t>(processes)) {
            running.push_back(start(next, works[next], limit));
            ++next;
        }
        std::vector<pollfd> pipes;
        for (const Child& child : running) pipes.push_back({child.pipe, POLLIN, 0});
        ::poll(pipes.data(), pipes.size(), std::isfinite(limit) ? 250 : -1);
        endLate(running, limit, patience);
        for (std::size_t i = running.size(); i-- > 0;) {
            if (pipes[i].revents == 0 || !readSome(running[i])) continue;
            outcomes[running[i].work] = finish(running[i], limit);
            running.erase(running.begin() + static_cast<std::ptrdiff_t>(i));
        }
        for (; reported < works.size() && outcomes[reported]; ++reported) done(reported, *outcomes[reported]);
    }
}

}  // namespace ragtop::stability
