#pragma once

#include "constraints/joint_types.h"

namespace ragtop {

/// Fills the rows of an AxesBlock in turn.
struct AxesWriter {
    AxesBlock& block;
    double coordinates[AxesBlock::kMostFree] = {};

    void rigid(const PairVector& row, float error) {
        block.rigid[block.rigidRows] = row;
        block.error[block.rigidRows++] = error;
    }
    void free(const PairVector& row, double coordinate) {
        const std::uint32_t f = block.freeRows++;
        coordinates[f] = coordinate;
        block.free[f] = row;
        block.value[f] = static_cast<float>(coordinate);
        if (block.locked & 1u << f)
            rigid(row, static_cast<float>(coordinate - static_cast<double>(block.axis[f].lower)));
        else
            setMargins(block.axis[f], coordinate);
    }
    /// The angle of the next free row with its turns.
    double turn(float angle) {
        AxisRows& axis = block.axis[block.freeRows];
        track(axis, angle);
        return unwrapped(axis, angle);
    }
};

void writePath(AxesWriter& write, PathRows& path, const JointPlace& place);
void writeSixDof(AxesWriter& write, const JointPlace& place);

inline AxisSettings settingsOf(const AxisDef& axis, bool turns) {
    return {axis.limit, axis.stop, axis.motor, axis.spring, axis.target, axis.friction, axis.bearing, turns};
}

}  // namespace ragtop
