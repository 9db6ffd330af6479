#include "free_rotation.h"

#include <cmath>
#include <utility>

namespace ragtop::stability {

double flipTime(const Principal& moments, const Principal& spin) {
    double i1 = moments.least, i3 = moments.greatest;
    const double i2 = moments.middle;
    const double energy2 =
        i1 * spin.least * spin.least + i2 * spin.middle * spin.middle + i3 * spin.greatest * spin.greatest;
    const double momentum2 = i1 * i1 * spin.least * spin.least + i2 * i2 * spin.middle * spin.middle +
                             i3 * i3 * spin.greatest * spin.greatest;
    // The formulas are for motion about the greatest axis; about the least one the two change places.
    if (momentum2 < energy2 * i2) std::swap(i1, i3);
    const double rate = std::sqrt((i3 - i2) * (momentum2 - energy2 * i1) / (i1 * i2 * i3));
    const double k2 = (i2 - i1) * (energy2 * i3 - momentum2) / ((i3 - i2) * (momentum2 - energy2 * i1));
    return 2 * std::comp_ellint_1(std::sqrt(k2)) / rate;
}

}  // namespace ragtop::stability
