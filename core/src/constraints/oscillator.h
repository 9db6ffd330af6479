#pragma once

/// What damped oscillations are made of, the same bits everywhere.
namespace ragtop::oscillator {

/// 1 − e^{−x} for x ≥ 0, the same bits everywhere: halved until its series is short, then doubled again.
inline double fading(double x) {
    if (x > 60) return 1;
    int halvings = 0;
    while (x > 0.125) {
        x *= 0.5;
        ++halvings;
    }
    double term = x, sum = x;
    for (int k = 2; k <= 8; ++k) {
        term *= -x / k;
        sum += term;
    }
    // 1 − y² = (1 − y)(1 + y)
    for (; halvings > 0; --halvings) sum *= 2 - sum;
    return sum;
}

/// Of at most half a radian; the first omitted term is below 3e-11 of the result.
inline double shortSine(double x) {
    const double s = x * x;
    return x - x * s * (1.0 / 6 - s * (1.0 / 120 - s * (1.0 / 5040 - s * (1.0 / 362880))));
}

}  // namespace ragtop::oscillator
