#include "base/check_tunables.h"
#include "constraints/joint_path.h"
#include "constraints/joint_swing.h"
#include "ragtop/body.h"
#include "ragtop/coupling.h"
#include "ragtop/joint.h"
#include "ragtop/settings.h"
#include "shapes/geometry.h"

namespace ragtop {
namespace {

/// Takes memory for names of what is wrong alone: joints may be defined anew in every step.
std::string whyInvalidFrame(std::string_view name, const Frame& frame) {
    const auto field = [&](const char* part) { return std::string(name) + part; };
    if (!isFinite(frame.position)) return whyNotFinite(field(".position"), frame.position);
    return whyNoRotation({}, frame.rotation).empty() ? std::string()
                                                     : whyNoRotation(field(".rotation"), frame.rotation);
}

/// Symmetric and positive definite, by its leading minors; zero where no rotation can happen.
std::string whyInvalidInertia(const Mat3& inertia, bool turns) {
    const Vec3 columns[3] = {inertia.cx, inertia.cy, inertia.cz};
    for (int i = 0; i < 3; ++i) {
        const std::string name = std::string("mass.inertia.c") + "xyz"[i];
        if (std::string why = whyNotFinite(name, columns[i]); !why.empty()) return why;
    }
    const double xx = columns[0].x, yy = columns[1].y, zz = columns[2].z;
    const double xy = columns[1].x, xz = columns[2].x, yz = columns[2].y;
    const double slack = 1e-3 * (xx + yy + zz);
    if (std::abs(xy - columns[0].y) > slack || std::abs(xz - columns[0].z) > slack ||
        std::abs(yz - columns[1].z) > slack) {
        return "mass.inertia is not symmetric, must be";
    }
    const double minor = xx * yy - xy * xy;
    const double determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    if (turns && !(xx > 0 && minor > 0 && determinant > 0)) {
        return "mass.inertia has the diagonal (" + numberText(columns[0].x) + ", " + numberText(columns[1].y) + ", " +
               numberText(columns[2].z) + ") and is not positive definite, must be";
    }
    return {};
}

std::string whyInvalidMass(const MassProperties& mass, const BodyDef& def) {
    if (def.type != BodyType::dynamic) return {};
    if (!std::isfinite(mass.mass) || !(mass.mass > 0)) {
        return "mass.mass is " + numberText(mass.mass) + ", must be finite and above 0 kg";
    }
    if (std::string why = whyNotFinite("mass.center", mass.center); !why.empty()) return why;
    const AxisLocks& locks = def.locks;
    return whyInvalidInertia(mass.inertia, !(locks.rotationX && locks.rotationY && locks.rotationZ));
}

bool hasHeightField(const Shape& shape) {
    if (const auto* compound = std::get_if<Compound>(&shape)) {
        for (const CompoundPart& part : compound->parts)
            if (hasHeightField(part.shape)) return true;
    }
    return std::holds_alternative<HeightField>(shape);
}

/// Why the first surface in a shape encloses nothing, and so has no mass; empty when all is solid.
std::string whyNotSolid(const Shape& shape) {
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return mesh->data().whyNotSolid;
    if (const auto* compound = std::get_if<Compound>(&shape)) {
        for (const CompoundPart& part : compound->parts) {
            if (std::string why = whyNotSolid(part.shape); !why.empty()) return why;
        }
    }
    return {};
}

std::string whyInvalidShape(const std::string& name, const ShapeDef& shape, BodyType type) {
    if (std::string why = whyInvalid(shape.geometry); !why.empty()) return name + ".geometry." + why;
    if (std::string why = whyInvalidFrame(name + ".frame", shape.frame); !why.empty()) return why;
    if (!std::isfinite(shape.density) || !(shape.density >= 0)) {
        return name + ".density is " + numberText(shape.density) + ", must be finite and at least 0 kg/m³";
    }
    if (std::string why = whyInvalid(shape.material); !why.empty()) return name + ".material." + why;
    if (type == BodyType::dynamic && hasHeightField(shape.geometry))
        return name + ".geometry is a HeightField, which a dynamic body cannot have, must be solid";
    return {};
}

std::string whyInvalidShapes(const BodyDef& def) {
    double mass = 0;
    for (std::size_t i = 0; i < def.shapes.size(); ++i) {
        const std::string name = "shapes[" + std::to_string(i) + "]";
        if (std::string why = whyInvalidShape(name, def.shapes[i], def.type); !why.empty()) return why;
        if (def.type != BodyType::dynamic || def.mass || def.shapes[i].sensor) continue;
        if (const std::string why = whyNotSolid(def.shapes[i].geometry); !why.empty())
            return name + ".geometry has a TriangleMesh that " + why + "; must be solid, or the body's mass given";
        mass += massOf(def.shapes[i].geometry, def.shapes[i].density).mass;
    }
    if (def.type != BodyType::dynamic || def.mass) return {};
    if (!(mass > 0) || !std::isfinite(mass)) {
        return "mass of all shapes is " + numberText(mass) +
               ", must be finite and above 0 kg for a dynamic body (shapes with density, or mass given)";
    }
    return {};
}

std::string whyInvalidBodies(const JointBodies& bodies) {
    if (bodies.a.isNull() && bodies.b.isNull()) {
        return "bodies.a and bodies.b are both null, at least one must name a body";
    }
    if (bodies.a == bodies.b) return "bodies.b is the same body as bodies.a, must be another one or null";
    for (const float limit : {bodies.breakForce, bodies.breakTorque})
        if (!(limit > 0))
            return "bodies.breakForce and bodies.breakTorque are " + numberText(bodies.breakForce) + " N and " +
                   numberText(bodies.breakTorque) + " N m, must be above 0";
    std::string why = whyInvalidFrame("bodies.frameA", bodies.frameA);
    return why.empty() ? whyInvalidFrame("bodies.frameB", bodies.frameB) : why;
}

std::string whyInvalidSwing(const BallDef& ball) {
    const int shapes = ball.swingLimit.has_value() + ball.swingEllipse.has_value() + ball.swingPyramid.has_value() +
                       ball.reach.has_value();
    if (shapes > 1)
        return "swingLimit, swingEllipse, swingPyramid and reach: " + std::to_string(shapes) +
               " are given, must be at most one";
    if (ball.reach && ball.twistLimit) return "twistLimit is given beside reach, whose corners have their own";
    return ball.reach ? whyInvalidReach(*ball.reach) : std::string();
}

}  // namespace

std::string whyInvalid(const BodyDef& def) {
    if (std::string why = whyNotFinite("pose.position", def.pose.position); !why.empty()) return why;
    if (std::string why = whyNoRotation("pose.rotation", def.pose.rotation); !why.empty()) return why;
    if (std::string why = whyOutOfRange(def); !why.empty()) return why;
    if (std::string why = whyInvalidShapes(def); !why.empty()) return why;
    return def.mass ? whyInvalidMass(*def.mass, def) : std::string();
}

std::string whyInvalid(const JointDef& def) {
    return std::visit(
        [](const auto& joint) {
            std::string why = whyInvalidBodies(joint.bodies);
            if (why.empty()) why = whyOutOfRange(joint);
            if constexpr (requires { joint.maxSpringTorque; }) {
                if (why.empty()) why = whyNoRotation("target", joint.target);
                if (why.empty()) why = whyInvalidSwing(joint);
            }
            if constexpr (requires { joint.curve; }) {
                if (why.empty()) why = whyInvalidCurve(joint.curve);
            }
            return why;
        },
        def);
}

std::string whyInvalid(const CouplingDef& def) {
    if (def.count < 1 || def.count > CouplingDef::kMostParts)
        return "count is " + std::to_string(def.count) + ", must be in [1, " + std::to_string(CouplingDef::kMostParts) +
               "]";
    for (int i = 0; i < def.count; ++i) {
        const CoupledCoordinate& part = def.parts[static_cast<std::size_t>(i)];
        const std::string name = "parts[" + std::to_string(i) + "].";
        if (std::string why = whyOutOfRange(part, name); !why.empty()) return why;
        if (part.ratio == 0) return name + "ratio is 0, must be another number";
        for (int k = 0; k < i; ++k) {
            const CoupledCoordinate& other = def.parts[static_cast<std::size_t>(k)];
            if (other.joint == part.joint && other.coordinate == part.coordinate)
                return name + "joint and coordinate are those of parts[" + std::to_string(k) + "], must differ";
        }
    }
    return whyOutOfRange(def.sum, "sum.");
}

std::string whyInvalid(const WorldSettings& settings) { return whyOutOfRange(settings); }

}  // namespace ragtop
