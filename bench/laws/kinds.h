#pragma once

#include "grammar.h"

namespace ragtop::laws {

/// Planks that hang by one or two balls at each end between two banks, slack or nearly taut; boxes fall on them.
Drawn drawBridge(Dice& dice);
/// Planks of 1 to 100 kg on balls or hinges between two banks; cars of boxes and wheels, driven or not, balls, rollers
/// and boxes of up to a hundred planks roll over them and fall on them.
Drawn drawCrossing(Dice& dice);
/// Suspension bridges, drawbridges, wrecking balls, trains, catapults, seesaws, wagons that strike each other, and
/// presses.
Drawn drawMachine(Dice& dice);
/// Balls joined to their neighbours half way, held at the corners; a heavier ball falls in.
Drawn drawNet(Dice& dice);
/// Bodies hung to each other where their surfaces meet, by balls, cones with friction and hinges with limits, with
/// loops; they fall on the floor, boxes after them.
Drawn drawContraption(Dice& dice);
/// A structure that stands, on what is at rest, moves evenly, drifts, lifts, or speeds up and brakes as statics lets
/// it.
Drawn drawCarried(Dice& dice);
/// A rope of capsules over a fixed drum, with a weight at each end.
Drawn drawDrum(Dice& dice);
/// A jointed human of capsules, hung by a hand, shaken by it, or thrown.
Drawn drawFigure(Dice& dice);
/// Chains of boxes laid over a beam.
Drawn drawBeam(Dice& dice);
/// Bodies that hang by slack ropes at their corners, and ladders of them, thrown until the ropes catch them.
Drawn drawHung(Dice& dice);
/// Balls on distance springs to their neighbours, of any stiffness and damping, which fall, swing and are hit.
Drawn drawLattice(Dice& dice);
/// Figures of 5 cm to 2 m, each link up to a thousandth of its trunk, which a ball of 0.1 to 100 kg strikes at 1 to 40
/// m/s, in empty space and over a floor.
Drawn drawStruck(Dice& dice);
/// Vehicles of three to eight wheels at any level, some with a trailer, driven, braked and let roll, upright and not,
/// on roads, hills, steps, ramps, litter, bridges, plates on ice and platforms.
Drawn drawDrive(Dice& dice);
/// Bodies of all convex shapes poured on the floor.
Drawn drawHeap(Dice& dice);
/// Groups of compounds on joints of all kinds, with limits, motors and springs, on a floor and a plate that moves.
Drawn drawMixture(Dice& dice);
/// Light bodies in a pit under a heavy slab that falls on them, or between two walls that close and may leave too
/// little room.
Drawn drawPressed(Dice& dice);
/// Walls, cairns, portals, arches, corbels and leaning plates of any sizes and weights, on the level and on slopes; of
/// some limit analysis says that they stand.
Drawn drawMasonry(Dice& dice);
/// Chains and rods with heavy ends, swung in and out of their plane.
Drawn drawPendulum(Dice& dice);

}  // namespace ragtop::laws
