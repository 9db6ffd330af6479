#pragma once

#include <span>

#include "model/shapes.h"
#include "narrowphase/manifold.h"

namespace ragtop {

/// Is a surface within some bounds without a border, and do all of its faces push along a way? So do edges and corners
/// then, whose directions lie between those of the faces around them.
bool facesAlong(const MeshData& surface, const Bounds& near, const Vec3& way);
bool facesAlong(const HeightFieldData& surface, const Bounds& near, const Vec3& way);

/// Would keepUnyielding drop all that a shape has with a surface of triangles within a margin? Where it can be told
/// from the faces there, nothing has to be collided.
bool yieldsToAll(const Shapes& shapes, const ContactRecord& record, const Frame& bInA, float margin);

/// Drops the manifolds of a contact that push a shape along the way that it gives (ShapeDef::givesWay), and all where a
/// box or hull ends below a twentieth of what the shape reaches along its way; returns how many are left, at the
/// beginning.
int keepUnyielding(const Shapes& shapes, const ContactRecord& record, const Frame& bInA, std::span<Manifold> found);

}  // namespace ragtop
