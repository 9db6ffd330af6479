#pragma once

#include <span>

#include "contacts/mesh_memory.h"
#include "model/bodies.h"
#include "model/shapes.h"
#include "narrowphase/manifold.h"

namespace ragtop {

/// What the narrow phase of a pair reads, beside what it remembers of pairs with meshes.
struct FindManifolds {
    const Bodies& bodies;
    const Shapes& shapes;
    MeshMemory& meshMemory;
    float dt;  ///< s, of the step
    float h;   ///< s, of a substep
};

/// Does a mesh of a dynamic body take part? Meshes that only others move collide triangle by triangle.
bool meetAsSurfaces(const Bodies& bodies, const Shapes& shapes, const ContactRecord& contact);
/// The narrow phase of a pair, shape B being at `bInA` in the axes of A; returns how many directions it touches in, at
/// most as many as the contact has room for. Points are found up to `margin`, m.
int findManifolds(const FindManifolds& view, ContactRecord& contact, const Frame& bInA, float margin,
                  std::span<Manifold> found);

}  // namespace ragtop
