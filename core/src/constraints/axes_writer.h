#pragma once

#include "constraints/joint_types.h"

namespace ragtop {

/// Errors and coordinates of an AxesBlock at another place.
struct AxesPlace {
    float error[AxesBlock::kMostRigid] = {};
    double coordinate[AxesBlock::kMostFree] = {};
    std::uint32_t vague = 0;
};

/// Fills the rows of an AxesBlock in turn, or only tells how far they would be off elsewhere.
struct AxesWriter {
    AxesBlock& block;
    AxesPlace* elsewhere = nullptr;  ///< where given, the block stays as it is
    std::uint32_t rigidRows = 0, freeRows = 0;

    void rigid(const PairVector& row, float error) {
        const std::uint32_t i = rigidRows++;
        (elsewhere ? elsewhere->error : block.error)[i] = error;
        if (!elsewhere) block.rigid[i] = row;
    }
    void free(const PairVector& row, double coordinate) {
        const std::uint32_t f = freeRows++;
        if (elsewhere) {
            elsewhere->coordinate[f] = coordinate;
        } else {
            block.free[f] = row;
            block.value[f] = static_cast<float>(coordinate);
            block.rounded[f] = static_cast<float>(coordinate - static_cast<double>(block.value[f]));
        }
        if (block.locked & 1u << f)
            rigid(row, static_cast<float>(coordinate - static_cast<double>(block.axis[f].lower)));
        else if (!elsewhere)
            setMargins(block.axis[f], coordinate);
    }
    void setVague(std::uint32_t coordinates) { (elsewhere ? elsewhere->vague : block.vague) = coordinates; }
    /// The angle of the next free row with its turns.
    double turn(float angle) {
        AxisRows& axis = block.axis[freeRows];
        if (!elsewhere) track(axis, angle);
        return unwrapped(axis, angle);
    }
};

void writePath(AxesWriter& write, PathRows& path, const JointPlace& place);
void writeSixDof(AxesWriter& write, const JointPlace& place);

inline AxisSettings settingsOf(const AxisDef& axis, bool turns) {
    return {axis.limit, axis.stop, axis.motor, axis.spring, axis.target, axis.friction, axis.bearing, turns};
}

}  // namespace ragtop
