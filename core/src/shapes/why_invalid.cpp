#include "base/check_tunables.h"
#include "ragtop/body.h"

namespace ragtop {
namespace {

struct WhyInvalid {
    std::string operator()(const Compound& compound) const {
        if (compound.parts.empty()) return "parts is empty, must have at least 1";
        for (std::size_t i = 0; i < compound.parts.size(); ++i) {
            const CompoundPart& part = compound.parts[i];
            const std::string prefix = "parts[" + std::to_string(i) + "].";
            if (std::string why = whyInvalid(part.shape); !why.empty()) return prefix + "shape." + why;
            if (std::string why = whyNotFinite(prefix + "frame.position", part.frame.position); !why.empty()) {
                return why;
            }
            if (std::string why = whyNoRotation(prefix + "frame.rotation", part.frame.rotation); !why.empty()) {
                return why;
            }
        }
        return {};
    }
    /// Hulls, meshes and height fields were checked when they were made.
    template <class Other>
    std::string operator()(const Other& shape) const {
        if constexpr (Described<Other>) {
            return whyOutOfRange(shape);
        } else {
            return {};
        }
    }
};

}  // namespace

std::string whyInvalid(const Shape& shape) { return std::visit(WhyInvalid{}, shape); }

std::string whyInvalid(const Material& material) { return whyOutOfRange(material); }

}  // namespace ragtop
