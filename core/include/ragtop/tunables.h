#pragma once

#include <limits>
#include <string>
#include <string_view>

/// One declaration of every tunable number. A definition struct `T` has beside it
///
///     template <class Visitor, class Self> void describe(Visitor& visit, Self& self, const T*);
///
/// which calls `visit(Tunable{name, unit, minimum, maximum, meaning}, self.field)` for each field. `Self` is `T` or
/// `const T`; the default is the value in a default-constructed `T`. Validation, files and sliders are visitors, so
/// none of them can disagree.
namespace ragtop {

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Name, unit, closed range and meaning of one field. Fields that are not numbers have neither unit nor range.
struct Tunable {
    std::string_view name;
    std::string_view unit = "";
    double minimum = -kUnbounded;
    double maximum = kUnbounded;
    std::string_view meaning = "";
};

}  // namespace ragtop
