#pragma once

#include <sys/types.h>

#include <string>

#include "../engine.h"

namespace ragtop::stability {

/// A child process that is asked and answers in lines. It ends with this.
class ProgramPipe {
public:
    /// Throws std::runtime_error where it cannot be started.
    ProgramPipe(const std::string& command, double patience);
    ~ProgramPipe();
    ProgramPipe(const ProgramPipe&) = delete;
    ProgramPipe& operator=(const ProgramPipe&) = delete;

    /// Throw std::runtime_error: it has ended, or took too long to answer.
    void tell(const std::string& line);
    std::string answer();

private:
    double patience_;
    pid_t process_ = -1;
    int in_ = -1, out_ = -1;
    std::string rest_;
};

/// The scene in the protocol's words, a line of JSON without its end. Throws Unsupported for what has no word there.
std::string sceneMessage(const Scene& scene, const ProgramOptions& options);

}  // namespace ragtop::stability
