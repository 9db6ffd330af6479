#include <cmath>
#include <stdexcept>

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

/// Casts through both trees; `test` returns the hit of one shape that is nearer than `closer`.
template <class Test>
Hit castThroughTrees(const WorldImpl& impl, const Bounds& start, const Vec3& translation, const QueryFilter& filter,
                     const Test& test) {
    Hit best;
    const Vec3 center = 0.5f * (start.lower + start.upper);
    const Vec3 extents = 0.5f * (start.upper - start.lower);
    for (const BoundsTree* tree : {&impl.collision.broadphase.fixedTree, &impl.collision.broadphase.movingTree}) {
        tree->cast(center, translation, extents, [&](std::uint32_t index, float closer) {
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
            return hit.fraction;
        });
    }
    return best;
}

Bounds pointBounds(const DVec3& point) {
    const Vec3 p = toVec3(point), e = roundingExtents(point);
    return {p - e, p + e};
}

Hit castRayIn(const WorldImpl& impl, const Ray& ray, const QueryFilter& filter) {
    return castThroughTrees(impl, pointBounds(ray.origin), ray.translation, filter,
                            [&](const Shape& shape, const Pose& pose, float closer, std::uint32_t& triangle) {
                                return castRayAtShape(shape, pose, ray, closer, triangle);
                            });
}

}  // namespace

Hit World::castRay(const Ray& ray, const QueryFilter& filter) const { return castRayIn(*impl_, ray, filter); }

Hit World::castShape(const Shape& shape, const Quat& rotation, const Ray& path, const QueryFilter& filter) const {
    const Bounds start = boundsOf(shape, Pose{path.origin, rotation});
    return castThroughTrees(*impl_, start, path.translation, filter,
                            [&](const Shape& target, const Pose& pose, float closer, std::uint32_t& triangle) {
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
