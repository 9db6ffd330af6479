#pragma once

#include <span>

#include "model/bodies.h"
#include "model/shapes.h"

namespace ragtop {

/// Drops the manifolds of a contact that push a shape along the way that it gives (ShapeDef::givesWay); returns how
/// many are left, at the beginning. What is farther than `near` (m) counts with the direction in which it will touch
/// within a step of dt: from afar, a wheel sees the edge of a kerb as the face of a wall.
int keepUnyielding(const Bodies& bodies, const Shapes& shapes, const ContactRecord& record, const Frame& bInA,
                   float near, float dt, std::span<Manifold> found);

}  // namespace ragtop
