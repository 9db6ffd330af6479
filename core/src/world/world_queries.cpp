#include <cmath>
#include <stdexcept>

#include "broadphase/swept_box.h"
#include "world/shape_queries.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

bool sees(const QueryFilter& filter, const ShapeRecord& shape, BodyId body) {
    return (shape.filter.category & filter.mask) != 0 && (filter.category & shape.filter.mask) != 0 &&
           (filter.sensors || !shape.sensor) && body != filter.ignore;
}

/// Half extents that make up for the rounding of a far origin to single precision.
Vec3 roundingExtents(const DVec3& origin) {
    constexpr float kUlp = 2.4e-7f;  // two roundings of a float
    const Vec3 o = abs(toVec3(origin));
    return kUlp * o;
}

/// A box that moves, and what it is asked for.
struct Cast {
    const WorldImpl& impl;
    const QueryFilter& filter;
    SweptBox box;

    Cast(const WorldImpl& world, const Bounds& start, const Vec3& translation, const QueryFilter& asked)
        : impl(world),
          filter(asked),
          box(0.5f * (start.lower + start.upper), translation, 0.5f * (start.upper - start.lower)) {}

    /// Offers a shape to `test`, which returns its hit if that is nearer than `closer`; what is of interest from then
    /// on.
    template <class Test>
    float meet(std::uint32_t index, float closer, Hit& best, const Test& test) const {
        if (best && best.fraction < closer) closer = best.fraction;
        const ShapeRecord& shape = impl.tables.shapes[index];
        if (!sees(filter, shape, impl.tables.bodies.id(shape.body))) return closer;
        const Pose pose = shapePose(impl.tables.bodies[shape.body], shape);
        std::uint32_t triangle = 0;
        const SweepHit hit =
            test(impl.tables.shapes.geometries[shape.geometry].shape, pose, best ? best.fraction : 1.0f, triangle);
        if (!hit.hit || (best && hit.fraction >= best.fraction)) return closer;
        best.shape = impl.tables.shapes.id(index);
        best.body = impl.tables.bodies.id(shape.body);
        best.fraction = hit.fraction;
        best.point = transformPoint(pose, hit.point);
        best.normal = rotate(pose.rotation, hit.normal);
        best.triangle = triangle;
        best.surface = impl.tables.shapes.materialAt(shape, triangle).surface;
        best.onFace = hit.onFace;
        return hit.fraction;
    }

    template <class Test>
    Hit throughTrees(const Test& test) const {
        Hit best;
        const Broadphase& all = impl.collision.broadphase;
        for (const BoundsTree* tree : {&all.fixedTree, &all.movingTree})
            tree->cast(box, [&](std::uint32_t index, float closer) { return meet(index, closer, best, test); });
        return best;
    }

    template <class Test>
    Hit amongThose(const Test& test) const {
        Hit best;
        for (const ShapeId id : *filter.among) {
            const std::uint32_t index = indexOf(impl.tables.shapes, id);
            const ShapeRecord& shape = impl.tables.shapes[index];
            if (shape.proxy == kNone) continue;
            const Bounds& bounds = impl.collision.broadphase.tree(shape.isStaticTree).bounds(shape.proxy);
            const float closer = best ? best.fraction : 1.0f;
            if (box.enter(bounds, closer) != SweptBox::kMiss) meet(index, closer, best, test);
        }
        return best;
    }

    template <class Test>
    Hit nearest(const Test& test) const {
        return filter.among ? amongThose(test) : throughTrees(test);
    }
};

Bounds pointBounds(const DVec3& point) {
    const Vec3 p = toVec3(point), e = roundingExtents(point);
    return {p - e, p + e};
}

Hit castRayIn(const WorldImpl& impl, const Ray& ray, const QueryFilter& filter) {
    return Cast(impl, pointBounds(ray.origin), ray.translation, filter)
        .nearest([&](const Shape& shape, const Pose& pose, float closer, std::uint32_t& triangle) {
            return castRayAtShape(shape, pose, ray, closer, triangle);
        });
}

}  // namespace

Hit World::castRay(const Ray& ray, const QueryFilter& filter) const { return castRayIn(*impl_, ray, filter); }

Hit World::castShape(const Shape& shape, const Quat& rotation, const Ray& path, const QueryFilter& filter) const {
    const Bounds start = boundsOf(shape, Pose{path.origin, rotation});
    return Cast(*impl_, start, path.translation, filter)
        .nearest([&](const Shape& target, const Pose& pose, float closer, std::uint32_t& triangle) {
            return sweepShapeAtShape(shape, rotation, path, target, pose, closer, triangle);
        });
}

void World::castRays(std::span<const Ray> rays, std::span<Hit> results, const QueryFilter& filter) const {
    if (results.size() < rays.size()) throw std::invalid_argument("results has fewer elements than rays");
    // One batch at a time has the world's threads; others that come at once run where they are.
    impl_->machine.runner.parallelFor(static_cast<int>(rays.size()), 64, [&](int begin, int end, int) {
        for (int i = begin; i < end; ++i) {
            const auto place = static_cast<std::size_t>(i);
            results[place] = castRayIn(*impl_, rays[place], filter);
        }
    });
}

void World::overlap(const Shape& shape, const Pose& pose, const std::function<bool(ShapeId)>& visit,
                    const QueryFilter& filter) const {
    overlap(
        boundsOf(shape, pose),
        [&](ShapeId id) {
            const ShapeRecord& target = impl_->tables.shapes[id.index];
            if (!overlapsShape(shape, pose, impl_->tables.shapes.geometries[target.geometry].shape,
                               shapePose(impl_->tables.bodies[target.body], target)))
                return true;
            return visit(id);
        },
        filter);
}

void World::overlap(const Bounds& bounds, const std::function<bool(ShapeId)>& visit, const QueryFilter& filter) const {
    bool goOn = true;
    for (const BoundsTree* tree : {&impl_->collision.broadphase.fixedTree, &impl_->collision.broadphase.movingTree}) {
        if (!goOn) return;
        tree->query(bounds, [&](std::uint32_t index) {
            const ShapeRecord& shape = impl_->tables.shapes[index];
            if (!sees(filter, shape, impl_->tables.bodies.id(shape.body))) return true;
            // Tree bounds are enlarged; the answer is about the shape's own.
            if (!overlaps(bounds, boundsOf(impl_->tables.shapes.geometries[shape.geometry].shape,
                                           shapePose(impl_->tables.bodies[shape.body], shape))))
                return true;
            goOn = visit(impl_->tables.shapes.id(index));
            return goOn;
        });
    }
}

}  // namespace ragtop
