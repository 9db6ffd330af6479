#pragma once

#include <span>
#include <string>
#include <vector>

#include "ragtop/scene.h"

namespace ragtop::speed {

/// A row of steps of a course that is measured, or that leads up to one that is.
struct Window {
    std::string name;  ///< of its row; empty: not measured
    int steps = 0;
    std::vector<BodyDef> arrivals{};  ///< put into the world before it
};

/// What every engine plays, 60 steps a second.
struct Course {
    Scene scene;
    std::vector<Window> windows;
    bool gapPeaks = false;  ///< a swing is over at its end: the largest gap of joints on the way counts
};

struct CourseKind {
    std::string name;
    std::vector<std::string> rows;  ///< names of its measured windows
    Course (*make)();
};
/// In the order of docs/speed.md.
std::span<const CourseKind> courseKinds();

// Those that were measured in other engines too; their numbers stay as they are.
Course makePyramid();
Course makeBrickHouse();
Course makeRagdollPile();
Course makeBoxPile();
Course makeHullPile();
Course makeMeshDrive();
Course makeWreckingChain();
Course makeChain100to1();

Course makeManyPyramids();
Course makeJointGrid();
Course makeJunkyard();
Course makeRain();
Course makeSleepers();
/// Boxes fallen into a pit as deep as any other's of the series.
Course makeScaling(int bodies);

}  // namespace ragtop::speed
