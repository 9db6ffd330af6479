#include "narrowphase/mesh_sweep.h"

#include "narrowphase/gjk.h"
#include "narrowphase/surface_sides.h"

namespace ragtop {
namespace {

constexpr int kMaxSteps = 64;  ///< a bound of conservative advancement
constexpr float kMeshTouch = 0.1f;  // of the target: tolerance of the distance met
/// rad. Up to such a turn triangles that look back from the motion are left out.
constexpr float kSmallTurn = 0.3f;

struct Corners {
    Vec3 v[3];
    Bounds bounds() const { return boundsOfTriangle(v[0], v[1], v[2]); }
};

class Advance {
public:
    explicit Advance(const MeshPath& path) : path_(path), turn_(length(path.turn)), axisTurn_(length(path.axisTurn)) {
        const Bounds& box = path.mesh->bounds;
        radius_ = length(max(box.upper - path.center, path.center - box.lower));
        const float speed = length(path.way) + turn_ * radius_;
        const float apart = length(transformPoint(path.start, path.center) - path.axisCenter) + speed + radius_;
        // Of a curve beside its chord: an eighth of the largest acceleration, here with that of the turning frame.
        bulge_ = 0.125f * (turn_ * turn_ * radius_ + 2 * axisTurn_ * speed + axisTurn_ * axisTurn_ * apart);
    }

    const MeshSweepHit& best() const { return best_; }
    Corners cornersAt(std::uint32_t triangle, const Frame& frame) const {
        const Triangle& t = path_.mesh->triangles[triangle];
        const auto at = [&](std::uint32_t i) { return transformPoint(frame, path_.mesh->vertices[i]); };
        return {{at(t.a), at(t.b), at(t.c)}};
    }
    /// Where a box of the mesh comes up to the first meeting so far.
    Bounds swept(const Bounds& box) const {
        const auto around = [&](const Frame& frame) {
            const Mat3 turn = toMat3(frame.rotation);
            const Vec3 half = 0.5f * (box.upper - box.lower);
            const Vec3 center = frame.position + turn * (0.5f * (box.lower + box.upper));
            const Vec3 h = half.x * abs(turn.cx) + half.y * abs(turn.cy) + half.z * abs(turn.cz);
            return Bounds{center - h, center + h};
        };
        return surface::grownBy(merge(around(path_.start), around(path_.at(best_.fraction))),
                                bulge_ + 2 * path_.target);
    }
    Bounds swept(std::uint32_t triangle) const {
        return surface::grownBy(
            merge(cornersAt(triangle, path_.start).bounds(), cornersAt(triangle, path_.at(best_.fraction)).bounds()),
            bulge_ + 2 * path_.target);
    }
    /// Does a triangle look back from the motion all the way?
    bool looksBack(std::uint32_t triangle) const {
        if (turn_ > kSmallTurn || axisTurn_ > 0) return false;
        const Vec3 normal = rotate(path_.start.rotation, path_.mesh->normals[triangle]);
        return dot(normal, path_.way) + turn_ * (length(path_.way) + reachOf(triangle)) < 0;
    }

    /// Advances one triangle against an obstacle, given by its support about a point near it, up to the first meeting
    /// so far. `face` is the normal of its front, zero for round ones; `extent` its radius about what it turns about.
    /// With n fixed no point comes nearer along it faster than −n · way + |turn × n| r of the mesh and the same of the
    /// other.
    template <class Support>
    void meet(std::uint32_t triangle, const Support& obstacle, const Vec3& origin, float radius, const Vec3& face,
              float extent, std::uint32_t name) {
        const float reach = reachOf(triangle), tolerance = kMeshTouch * path_.target;
        if (face != Vec3{} && axisTurn_ == 0 && -dot(face, path_.way) + turn_ * reach <= 0) return;
        float t = 0, safe = 0;
        for (int step = 0; step < kMaxSteps; ++step) {
            Corners b = cornersAt(triangle, t == 0 ? path_.start : path_.at(t));
            for (Vec3& corner : b.v) corner = corner - origin;
            const gjk::Closest near = gjk::closest(obstacle, gjk::PointsSupport{b.v, 3}, -b.v[0]);
            const float distance = near.distance - radius;
            if (step > 0 && (near.overlap || distance < path_.target - tolerance)) {
                t = safe + 0.5f * (t - safe);
                continue;
            }
            safe = t;
            SweepHit hit{true, t, origin + near.pointA + radius * near.normal, near.normal, near.overlap};
            if (step == 0 && (near.overlap || distance <= path_.target + tolerance))
                return meetAtOnce(hit, face, distance, name);
            if (distance <= path_.target + tolerance) return take(hit, name);
            Vec3 n = near.normal;
            if (axisTurn_ > 0) n = rotate(rotationAbout(path_.axisTurn, t * axisTurn_), n);
            const float approach =
                -dot(n, path_.way) + length(cross(path_.turn, n)) * reach + length(cross(path_.axisTurn, n)) * extent;
            if (approach <= 0) return;
            const float next = t + (distance - path_.target) / approach;
            if (!(next < best_.fraction)) return;
            if (next <= t || step == kMaxSteps - 1) return take(hit, name);
            t = next;
        }
    }

private:
    float reachOf(std::uint32_t triangle) const {
        const Triangle& t = path_.mesh->triangles[triangle];
        float most = 0;
        for (const std::uint32_t i : {t.a, t.b, t.c}) {
            const float square = lengthSquared(path_.mesh->vertices[i] - path_.center);
            most = square > most ? square : most;
        }
        return std::sqrt(most);
    }
    void take(const SweepHit& hit, std::uint32_t name) {
        if (best_.hit && hit.fraction >= best_.fraction) return;
        static_cast<SweepHit&>(best_) = hit;
        best_.triangle = name;
    }
    /// Only what goes deeper is met; where triangles cut each other already, against the face.
    void meetAtOnce(SweepHit hit, const Vec3& face, float distance, std::uint32_t name) {
        if (hit.overlap && face == Vec3{}) return;
        if (hit.overlap) hit.normal = face;
        const Vec3 end = transformPoint(path_.at(1), inverseTransformPoint(path_.start, hit.point));
        const float room = hit.overlap || distance < 0 ? 0.0f : distance;
        if (dot(hit.normal, hit.point - end) > room + path_.allowed) take(hit, name);
    }

    const MeshPath& path_;
    float turn_, axisTurn_;
    float radius_ = 0;  ///< m, of the mesh about its centre
    float bulge_ = 0;   ///< m, by which its points leave their chords
    MeshSweepHit best_;
};

/// The triangles of the mesh whose way comes near: isNear(bounds) tells of boxes.
template <class IsNear, class Visit>
void forEachOnTheWay(const MeshPath& path, const Advance& advance, IsNear&& isNear, Visit&& visit) {
    surface::walk(
        *path.mesh, [&](const Bounds& node) { return isNear(advance.swept(node)); },
        [&](std::uint32_t triangle) {
            if (!advance.looksBack(triangle)) visit(triangle, advance.swept(triangle));
            return advance.best().fraction > 0;
        });
}

template <class Obstacle>
MeshSweepHit firstTriangle(const Obstacle& obstacle, const MeshPath& path) {
    Advance advance(path);
    const auto isNear = [&](const Bounds& box) {
        bool any = false;
        forEachTriangle(obstacle, box, [&](const TriangleView&) { return !(any = true); });
        return any;
    };
    forEachOnTheWay(path, advance, isNear, [&](std::uint32_t triangle, const Bounds& box) {
        forEachTriangle(obstacle, box, [&](const TriangleView& view) {
            const Vec3 corners[3] = {{}, view.b - view.a, view.c - view.a};
            float extent = 0;
            for (const Vec3& corner : {view.a, view.b, view.c}) {
                const float from = length(corner - path.axisCenter);
                extent = from > extent ? from : extent;
            }
            advance.meet(triangle, gjk::PointsSupport{corners, 3}, view.a, 0, view.normal, extent, view.index);
            return advance.best().fraction > 0;
        });
    });
    return advance.best();
}

}  // namespace

Frame MeshPath::at(float share) const {
    Frame frame = start;
    if (const float angle = length(turn); angle > 0)
        frame.rotation = rotationAbout(turn, share * angle) * start.rotation;
    frame.position = transformPoint(start, center) + share * way - rotate(frame.rotation, center);
    if (const float angle = length(axisTurn); angle > 0) {
        const Quat back = conjugate(rotationAbout(axisTurn, share * angle));
        frame = {axisCenter + rotate(back, frame.position - axisCenter), back * frame.rotation};
    }
    frame.rotation = normalized(frame.rotation);
    return frame;
}

MeshSweepHit timeOfImpact(const MeshData& obstacle, const MeshPath& path) { return firstTriangle(obstacle, path); }

MeshSweepHit timeOfImpact(const HeightFieldData& obstacle, const MeshPath& path) {
    return firstTriangle(obstacle, path);
}

MeshSweepHit timeOfImpact(const ConvexView& obstacle, const MeshPath& path) {
    Advance advance(path);
    const Vec3 reach = obstacle.halfExtents + Vec3{obstacle.radius, obstacle.radius, obstacle.radius};
    const Bounds bounds{-reach, reach};
    const float extent = length(path.axisCenter) + length(reach);
    const auto isNear = [&](const Bounds& box) { return overlaps(box, bounds); };
    forEachOnTheWay(path, advance, isNear, [&](std::uint32_t triangle, const Bounds& box) {
        if (isNear(box)) advance.meet(triangle, gjk::CoreSupport{&obstacle}, {}, obstacle.radius, {}, extent, 0);
    });
    return advance.best();
}

}  // namespace ragtop
