#pragma once

namespace ragtop::bench {

/// The whole program: what it ends with.
int run(int argc, char** argv);

}  // namespace ragtop::bench
