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
    bool nudged = false;  ///< each second some body gets a speed of 0.1 m/s more
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

// What lies exactly and never moves measures what is skipped; these do not.
/// The first window of a course over 300 steps, with all that moves up to 1 mm aside along x and z.
Course withOffsets(Course course, const std::string& name);
/// The same with nothing aside, but with a nudge each second.
Course withNudges(Course course, const std::string& name);

/// Boxes fallen into a pit as deep as any other's of the series.
Course makeScaling(int bodies);

}  // namespace ragtop::speed
