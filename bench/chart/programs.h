#pragma once

#include <string>

#include "variants.h"

namespace ragtop::chart {

/// Anyone's engine: a program that speaks the protocol of docs/chart.md. Starts it and asks for its name, version and
/// settings. Throws std::runtime_error, "--engine-command COMMAND: what is wrong".
/// An answer may take `patience` seconds.
Variant programVariant(const std::string& command, double patience);

}  // namespace ragtop::chart
