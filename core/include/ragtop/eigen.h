#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "ragtop/math.h"

/// To and from Eigen's types. Nothing else in Ragtop's public headers needs Eigen.
namespace ragtop {

inline Eigen::Vector3f toEigen(const Vec3& v) { return {v.x, v.y, v.z}; }
inline Eigen::Vector3d toEigen(const DVec3& v) { return {v.x, v.y, v.z}; }
inline Eigen::Quaternionf toEigen(const Quat& q) { return {q.w, q.x, q.y, q.z}; }
inline Eigen::Matrix3f toEigen(const Mat3& m) {
    Eigen::Matrix3f result;
    result.col(0) = toEigen(m.cx);
    result.col(1) = toEigen(m.cy);
    result.col(2) = toEigen(m.cz);
    return result;
}
inline Eigen::Isometry3f toEigen(const Frame& f) {
    Eigen::Isometry3f result = Eigen::Isometry3f::Identity();
    result.linear() = toEigen(f.rotation).toRotationMatrix();
    result.translation() = toEigen(f.position);
    return result;
}
inline Eigen::Isometry3d toEigen(const Pose& p) {
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    result.linear() = toEigen(p.rotation).cast<double>().toRotationMatrix();
    result.translation() = toEigen(p.position);
    return result;
}

inline Vec3 fromEigen(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }
inline DVec3 fromEigen(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline Quat fromEigen(const Eigen::Quaternionf& q) { return {q.x(), q.y(), q.z(), q.w()}; }
inline Mat3 fromEigen(const Eigen::Matrix3f& m) {
    return {{m(0, 0), m(1, 0), m(2, 0)}, {m(0, 1), m(1, 1), m(2, 1)}, {m(0, 2), m(1, 2), m(2, 2)}};
}

}  // namespace ragtop
