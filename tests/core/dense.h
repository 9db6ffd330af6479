#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

/// Dense algebra as in textbooks, to compare with. Eigen's products, factors and eigenvalues take the compiler as long
/// as three other files of tests.
namespace ragtop::test {

class DenseMatrix {
public:
    DenseMatrix(std::size_t rows, std::size_t columns) : columns_(columns), numbers_(rows * columns) {}
    double& operator()(std::size_t row, std::size_t column) { return numbers_[row * columns_ + column]; }
    double operator()(std::size_t row, std::size_t column) const { return numbers_[row * columns_ + column]; }
    std::size_t rows() const { return numbers_.size() / columns_; }

private:
    std::size_t columns_;
    std::vector<double> numbers_;
};

/// a x = b by Gauss's elimination with the largest pivot of each column.
inline std::vector<double> solved(DenseMatrix a, std::vector<double> b) {
    const std::size_t n = b.size();
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t r = k + 1; r < n; ++r)
            if (std::abs(a(r, k)) > std::abs(a(pivot, k))) pivot = r;
        for (std::size_t c = k; c < n; ++c) std::swap(a(k, c), a(pivot, c));
        std::swap(b[k], b[pivot]);
        for (std::size_t r = k + 1; r < n; ++r) {
            const double factor = a(r, k) / a(k, k);
            for (std::size_t c = k; c < n; ++c) a(r, c) -= factor * a(k, c);
            b[r] -= factor * b[k];
        }
    }
    for (std::size_t k = n; k-- > 0;) {
        for (std::size_t c = k + 1; c < n; ++c) b[k] -= a(k, c) * b[c];
        b[k] /= a(k, k);
    }
    return b;
}

/// Those of a symmetric matrix, by Jacobi's rotations.
inline std::vector<double> eigenvalues(DenseMatrix a) {
    const std::size_t n = a.rows();
    const auto turn = [&](std::size_t p, std::size_t q) {
        const double theta = (a(q, q) - a(p, p)) / (2 * a(p, q));
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        const auto mix = [c, s](double& x, double& y) { x = c * x - s * std::exchange(y, s * x + c * y); };
        for (std::size_t k = 0; k < n; ++k) mix(a(k, p), a(k, q));
        for (std::size_t k = 0; k < n; ++k) mix(a(p, k), a(q, k));
    };
    // Convergence is quadratic: ten sweeps are more than any takes.
    for (int sweep = 0; sweep < 10; ++sweep)
        for (std::size_t p = 0; p < n; ++p)
            for (std::size_t q = p + 1; q < n; ++q)
                if (a(p, q) != 0) turn(p, q);
    std::vector<double> values;
    for (std::size_t k = 0; k < n; ++k) values.push_back(a(k, k));
    return values;
}

}  // namespace ragtop::test
