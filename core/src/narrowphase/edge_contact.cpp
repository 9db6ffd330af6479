#include "narrowphase/edge_contact.h"

#include "narrowphase/clip.h"

namespace ragtop::surface {
namespace {

constexpr float kSlack = 0.02f;          // sine of the angle by which a direction may leave the faces beside an edge
constexpr float kParallelLines = 1e-4f;  // sin² below which corners and faces tell more
constexpr float kShown = 0.5f;           // of the overlap of two edges: what must be seen behind the faces

/// Does an edge, where it crosses another one or farther along, lie behind both faces beside that one by a good part of
/// the overlap? If not, the two only pass each other beside a corner.
bool goesBehind(const SharpEdge& edge, float at, const SharpEdge& other, float overlap) {
    if (other.round) return true;
    const Vec3 start = edge.from - other.from;
    const auto height = [&](int face, float t) { return dot(other.normals[face], start + t * edge.along); };
    const int higher = height(0, at) >= height(1, at) ? 0 : 1;
    const float rate = dot(other.normals[higher], edge.along);
    float t = at;
    if (rate != 0) {
        t -= (height(higher, at) + overlap) / rate;
        t = t < 0 ? 0.0f : t > 1 ? 1.0f : t;
    }
    return height(0, t) <= -kShown * overlap && height(1, t) <= -kShown * overlap;
}

}  // namespace

bool SharpEdge::isOutermost(const Vec3& direction) const {
    return round || (dot(direction, outward[0]) >= -kSlack && dot(direction, outward[1]) >= -kSlack &&
                     dot(direction, normals[0] + normals[1]) >= -kSlack);
}

Vec3 SharpEdge::middle() const { return normals[0] + normals[1] + outward[0] + outward[1]; }

EdgeMeeting meet(const SharpEdge& a, const SharpEdge& b, float deepest) {
    EdgeMeeting out;
    const Vec3 axis = cross(a.along, b.along);
    const float square = lengthSquared(axis), aa = lengthSquared(a.along), bb = lengthSquared(b.along);
    if (square <= kParallelLines * aa * bb) return out;
    // Of the infinite lines; beyond the ends corners are nearer.
    const Vec3 r = a.from - b.from;
    const float ab = dot(a.along, b.along), ar = dot(a.along, r), br = dot(b.along, r);
    const float s = (ab * br - ar * bb) / square, t = (aa * br - ab * ar) / square;
    if (!(s >= 0 && s <= 1 && t >= 0 && t <= 1)) return out;
    Vec3 normal = (1 / std::sqrt(square)) * axis;
    const float facing = a.round ? -dot(normal, b.middle()) : dot(normal, a.middle());
    if (facing < 0) normal = -normal;
    if (!a.isOutermost(normal) || !b.isOutermost(-normal)) return out;
    out.onA = a.from + s * a.along;
    out.onB = b.from + t * b.along;
    out.normal = normal;
    out.separation = dot(normal, out.onB - out.onA);
    const float overlap = -out.separation;
    out.found = overlap <= 0 || (overlap <= deepest && goesBehind(a, s, b, overlap) && goesBehind(b, t, a, overlap));
    return out;
}

}  // namespace ragtop::surface
