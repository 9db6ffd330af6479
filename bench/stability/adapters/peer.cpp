#include "peer.h"

#include <Eigen/Eigenvalues>

#include "../scenery.h"
#include "ragtop/eigen.h"

namespace ragtop::stability {

Inertial inertialOf(const BodyDef& def) {
    if (def.type != BodyType::dynamic) return {};
    const MassProperties mass = massOf(def);
    Inertial result;
    result.mass = static_cast<double>(mass.mass);
    result.frame.position = mass.center;
    const Eigen::Matrix3d inertia = toEigen(mass.inertia).cast<double>();
    const Eigen::Matrix3d crossed = inertia - Eigen::Matrix3d(inertia.diagonal().asDiagonal());
    if (crossed.norm() < 1e-6 * inertia.norm()) {
        result.moments = {mass.inertia.cx.x, mass.inertia.cy.y, mass.inertia.cz.z};
        return result;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
    Eigen::Matrix3d axes = solver.eigenvectors();
    if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
    result.frame.rotation = fromEigen(Eigen::Quaternionf(axes.cast<float>()));
    result.moments = fromEigen(Eigen::Vector3f(solver.eigenvalues().cast<float>()));
    return result;
}

PeerBodies::PeerBodies(const Scene& scene) {
    for (const SceneBody& body : scene.bodies) add(body.def);
}

void PeerBodies::add(const BodyDef& def) {
    defs_.push_back(def);
    inertials_.push_back(inertialOf(def));
}

Frame PeerBodies::local(int body, const Frame& frame) const {
    return body == kWorld ? frame : inverse(inertial(body).frame) * frame;
}

const JointBodies& bodiesOf(const JointDef& def) {
    return std::visit([](const auto& joint) -> const JointBodies& { return joint.bodies; }, def);
}

bool isPlain(const HingeDef& hinge) {
    return !hinge.bearing && !(hinge.stop.restitution > 0) && !(hinge.stop.stiffness > 0) &&
           (!hinge.spring || !(hinge.spring->frequency > 0));
}

}  // namespace ragtop::stability
