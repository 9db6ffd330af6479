#pragma once

#include "base/economy.h"

namespace ragtop::test {

/// Switches one saving off while it lives.
class Without {
public:
    explicit Without(bool Economy::*saving) : saving_(saving) { economy.*saving_ = false; }
    ~Without() { economy.*saving_ = true; }
    Without(const Without&) = delete;
    Without& operator=(const Without&) = delete;

private:
    bool Economy::*saving_;
};

}  // namespace ragtop::test
