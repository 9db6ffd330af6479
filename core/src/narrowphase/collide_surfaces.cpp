#include "narrowphase/collide_surfaces.h"

#include "narrowphase/contact_gatherer.h"
#include "narrowphase/edge_contact.h"
#include "narrowphase/surface_sides.h"

/// Contacts are local minima of the distance between features: corners of each surface on the faces, edges and corners
/// of the other, and crossing convex edges. What is inside the other is pushed out through the nearest face that looks
/// against it, so that what has passed the middle of a thin part is not pushed on.
namespace ragtop {
namespace surface {
namespace {

/// Of the size: how far inside a corner is looked for in the first pass. What is deeper asks for the second.
constexpr float kInward = 0.25f;
/// Cosine of the angle between a direction out of one surface and the outside of a corner of the other from which on
/// the corner cannot touch it.
constexpr float kFacing = 0.2f;
/// Of the size: overlap up to which a corner is held by more than one face.
constexpr float kShallow = 0.002f;
/// Of the size: what lies this near to a surface is on it, and the direction between them is noise.
constexpr float kOnSurface = 1e-3f;

/// A corner of one surface, or the centre of a ball.
struct Corner {
    Vec3 at;
    Vec3 outward;  ///< zero: all directions
    float radius = 0;
    std::uint32_t name = 0;
    std::uint32_t source = 0;  ///< triangle of A, where the corner is A's
    bool ofA = false;
};

constexpr std::uint32_t mixed(std::uint32_t a, std::uint32_t b) { return (a ^ (b + 1) * 2654435761u) * 2246822519u; }

template <class Side>
SharpEdge sharpEdge(const Side& side, const Facet& facet, int edge) {
    SharpEdge out;
    out.from = facet.v[edge];
    out.along = facet.edge(edge);
    const Vec3 unit = normalized(out.along);
    out.normals[0] = facet.normal;
    out.outward[0] = cross(unit, facet.normal);
    out.name = 3 * facet.index + static_cast<std::uint32_t>(edge);
    // A border shows the front of its face and its rim.
    if (side.beyond(facet, edge, out.normals[1])) {
        out.outward[1] = cross(out.normals[1], unit);
    } else {
        out.normals[1] = out.outward[0];
        out.outward[1] = facet.normal;
    }
    return out;
}

/// The nearest point of a surface, among all triangles or among those that look against a corner.
struct Nearest {
    bool found = false;
    float square = 0;
    Vec3 point;
    Facet facet;
    Feature feature;

    void offer(const Facet& candidate, const Vec3& near, const Feature& part, float squared) {
        if (found && squared >= square) return;
        *this = {true, squared, near, candidate, part};
    }
};

/// The direction out of a surface at the nearest point that tells inside from outside; false at a border, whose rim
/// encloses nothing.
template <class Side>
bool outwardAt(const Side& side, const Nearest& near, Vec3& outward) {
    outward = near.facet.normal;
    if (near.feature.kind == Feature::vertex) outward = side.vertexNormal(near.facet, near.feature.index);
    if (near.feature.kind != Feature::edge) return true;
    Vec3 other;
    if (!side.beyond(near.facet, near.feature.index, other)) return false;
    outward = normalized(outward + other, outward);
    return true;
}

/// Faces over which a corner is.
struct FacesBelow {
    static constexpr int kMost = 16;  ///< room; more are not looked at
    struct Face {
        Vec3 normal;
        float height;
        std::uint32_t source;
    };
    Face faces[kMost];
    int count = 0;

    void add(const Face& face) {
        if (count < kMost) {
            faces[count++] = face;
            return;
        }
        int farthest = 0;
        for (int i = 1; i < count; ++i) farthest = faces[i].height > faces[farthest].height ? i : farthest;
        if (face.height < faces[farthest].height) faces[farthest] = face;
    }
};

class Contacts {
public:
    Contacts(const ContactReach& reach, const Vec3& apart)
        : reach_(reach), gatherer_(reach.size, normalized(apart, {})) {}

    /// `out` is the direction from the other surface to the corner's.
    void offerCorner(const Corner& corner, const Vec3& out, float separation, std::uint32_t source) {
        const Vec3 surface = corner.at - corner.radius * out;
        const Vec3 middle = surface - 0.5f * separation * out;
        offer(corner.ofA ? -out : out, middle, separation, mixed(corner.name, corner.ofA ? 1u : 2u),
              corner.ofA ? corner.source : source);
    }
    void offer(const Vec3& normal, const Vec3& position, float separation, std::uint32_t feature,
               std::uint32_t triangle) {
        const float closing = -dot(normal, reach_.way);
        if (separation > reach_.margin + (closing > 0 ? closing : 0.0f)) return;
        gatherer_.add({normal, {position, separation, feature}, triangle});
    }
    /// Where a place of A, or of B, may come to be as the other sees it.
    Bounds reached(const Bounds& b, bool ofA) const {
        const Vec3 way = ofA ? -reach_.way : reach_.way;
        const float inward = kInward * reach_.size;
        return grownBy({min(b.lower, b.lower + way), max(b.upper, b.upper + way)},
                       reach_.margin > inward ? reach_.margin : inward);
    }
    float size() const { return reach_.size; }
    ContactGatherer& gatherer() { return gatherer_; }

private:
    const ContactReach& reach_;
    ContactGatherer gatherer_;
};

template <class Side>
class CornerContact {
public:
    CornerContact(const Side& side, const Corner& corner, Contacts& contacts)
        : side_(side), corner_(corner), contacts_(contacts) {}

    /// Among the facets within reach; of a solid that has none there, the nearest.
    void run() {
        const Bounds place = grownBy({corner_.at, corner_.at}, corner_.radius);
        side_.forEachFacet(contacts_.reached(place, corner_.ofA), [&](const Facet& facet) {
            look(facet);
            return true;
        });
        if constexpr (requires { side_.nearestFacet(corner_.at); }) {
            // What is inside and out of reach of the surface is as far inside the bounds.
            const Bounds inner = grownBy(side_.bounds(), -kInward * contacts_.size());
            if (!all_.found && side_.encloses() && overlaps(inner, place)) look(side_.nearestFacet(corner_.at));
        }
        if (!all_.found) return;
        Vec3 outward;
        const bool borders = !outwardAt(side_, all_, outward);
        const Vec3 way = corner_.at - all_.point;
        const float ahead = dot(way, outward);
        if (borders ? dot(way, all_.facet.normal) >= 0 : ahead >= 0)
            outside(outward);
        else if (!borders && (side_.encloses() || all_.square <= square(contacts_.size())))
            inside();
    }

private:
    static float square(float v) { return v * v; }
    bool faces(const Vec3& out) const { return dot(out, corner_.outward) < kFacing; }

    void look(const Facet& facet) {
        Feature feature;
        const Vec3 near = nearestOnTriangle(facet.v, facet.normal, corner_.at, feature);
        const float squared = lengthSquared(corner_.at - near);
        all_.offer(facet, near, feature, squared);
        if (!faces(facet.normal)) return;
        facing_.offer(facet, near, feature, squared);
        if (feature.kind == Feature::face)
            below_.add({facet.normal, dot(facet.normal, corner_.at - facet.v[0]), facet.source});
    }

    void outside(const Vec3& outward) {
        const float distance = std::sqrt(all_.square);
        for (int i = 0; i < below_.count; ++i)
            if (below_.faces[i].height >= 0) offerFace(below_.faces[i]);
        if (all_.feature.kind == Feature::face) {
            // All but on the surface, where rounding tells on which side.
            if (below_.count == 0 && faces(outward))
                contacts_.offerCorner(corner_, outward, distance - corner_.radius, all_.facet.source);
            return;
        }
        const bool touches = distance <= kOnSurface * contacts_.size();
        const Vec3 out = touches ? outward : (1 / distance) * (corner_.at - all_.point);
        if (faces(out)) contacts_.offerCorner(corner_, out, distance - corner_.radius, all_.facet.source);
    }

    void inside() {
        const Nearest& nearest = facing_.found ? facing_ : all_;
        const float depth = std::sqrt(nearest.square);
        Vec3 out = nearest.facet.normal;
        if (nearest.feature.kind != Feature::face && depth > kOnSurface * contacts_.size())
            out = (1 / depth) * (nearest.point - corner_.at);
        contacts_.offerCorner(corner_, out, -depth - corner_.radius, nearest.facet.source);
        const float shallow = 2 * depth + kShallow * contacts_.size();
        for (int i = 0; i < below_.count; ++i)
            if (below_.faces[i].height >= -shallow) offerFace(below_.faces[i]);
    }

    void offerFace(const FacesBelow::Face& face) {
        contacts_.offerCorner(corner_, face.normal, face.height - corner_.radius, face.source);
    }

    const Side& side_;
    const Corner& corner_;
    Contacts& contacts_;
    Nearest all_, facing_;
    FacesBelow below_;
};

template <class Side>
void collideCorner(const Corner& corner, const Side& side, Contacts& contacts) {
    CornerContact<Side>(side, corner, contacts).run();
}

void collideCorner(const Corner& corner, const RoundSide& side, Contacts& contacts) {
    const Vec3 core = side.q - side.p;
    const float square = lengthSquared(core);
    const float along = square > 0 ? dot(corner.at - side.p, core) / square : 0.0f;
    const Vec3 near = side.p + (along < 0 ? 0.0f : along > 1 ? 1.0f : along) * core;
    const float distance = length(corner.at - near);
    if (!(distance > 0)) return;
    const Vec3 out = (1 / distance) * (corner.at - near);
    if (dot(out, corner.outward) < kFacing) contacts.offerCorner(corner, out, distance - side.radius, corner.source);
}

template <class Side>
void collideCorners(const Side& side, const Facet& facet, const auto& other, Contacts& contacts, bool ofA) {
    for (int k = 0; k < 3; ++k)
        if (facet.ownsVertex(k))
            collideCorner({facet.v[k], side.vertexNormal(facet, k), 0, side.vertexName(facet, k), facet.source, ofA},
                          other, contacts);
}

/// The sharp edges of a facet against another surface.
class EdgeContacts {
public:
    EdgeContacts(Contacts& contacts) : contacts_(contacts) {}

    template <class Side>
    void take(const Side& side, const Facet& facet, bool ofA) {
        count_ = 0;
        source_ = facet.source;
        ofA_ = ofA;
        for (int e = 0; e < 3; ++e)
            if (facet.owns(e)) edges_[count_++] = {sharpEdge(side, facet, e)};
    }
    bool empty() const { return count_ == 0; }

    /// With another edge, of B.
    void collide(const SharpEdge& other, float radius) {
        for (int i = 0; i < count_; ++i) {
            const EdgeMeeting met = meet(edges_[i].edge, other, contacts_.size());
            if (!met.found) continue;
            const Vec3 onB = met.onB - radius * met.normal;
            contacts_.offer(met.normal, 0.5f * (met.onA + onB), met.separation - radius,
                            mixed(edges_[i].edge.name, other.name), source_);
        }
    }
    /// With a facet and, of A's edges, with its edges: those of B have met them already.
    template <class Side>
    void collide(const Side& side, const Facet& facet) {
        for (int e = 0; ofA_ && e < 3; ++e)
            if (facet.owns(e) && passesAny(facet.v[e], facet.edge(e))) collide(sharpEdge(side, facet, e), 0);
        for (int i = 0; i < count_; ++i) edges_[i].pierce(facet);
    }
    /// Edges that go in at one face of the other and out at another, where no edge of it is met: the middle of what is
    /// inside is pushed out as a corner is.
    template <class Other>
    void collideInsides(const Other& other) {
        for (int i = 0; i < count_; ++i) {
            const PiercingEdge& piercing = edges_[i];
            for (int k = 0; k < piercing.ins; ++k) {
                const float in = piercing.in[k], out = piercing.endOf(in);
                if (!(out > in) || meetsAnyEdge(piercing.edge, in, out, other)) continue;
                const Vec3 middle = piercing.edge.from + 0.5f * (in + out) * piercing.edge.along;
                collideCorner(
                    {middle, normalized(piercing.edge.middle()), 0, mixed(piercing.edge.name, 7), source_, ofA_}, other,
                    contacts_);
            }
        }
    }

private:
    struct PiercingEdge {
        static constexpr int kMost = 4;  ///< room; more are not looked at
        SharpEdge edge{};
        float in[kMost] = {}, out[kMost] = {};  ///< shares of the edge at which it goes in and comes out
        int ins = 0, outs = 0;

        void pierce(const Facet& facet) {
            const float start = dot(facet.normal, edge.from - facet.v[0]);
            const float end = start + dot(facet.normal, edge.along);
            if ((start > 0) == (end > 0)) return;
            const float share = start / (start - end);
            const Vec3 at = edge.from + share * edge.along;
            for (int i = 0; i < 3; ++i)
                if (dot(cross(facet.normal, facet.edge(i)), at - facet.v[i]) < 0) return;
            if (start > 0 && ins < kMost) in[ins++] = share;
            if (start <= 0 && outs < kMost) out[outs++] = share;
        }
        float endOf(float from) const {
            float first = -1;
            for (int i = 0; i < outs; ++i)
                if (out[i] > from && (first < 0 || out[i] < first)) first = out[i];
            return first;
        }
    };

    bool passesAny(const Vec3& from, const Vec3& along) const {
        for (int i = 0; i < count_; ++i)
            if (passEachOther(edges_[i].edge.from, edges_[i].edge.along, from, along)) return true;
        return false;
    }
    template <class Other>
    bool meetsAnyEdge(const SharpEdge& edge, float in, float out, const Other& other) const {
        const Vec3 p = edge.from + in * edge.along, q = edge.from + out * edge.along;
        bool any = false;
        other.forEachFacet(contacts_.reached({min(p, q), max(p, q)}, ofA_), [&](const Facet& facet) {
            for (int e = 0; e < 3 && !any; ++e) {
                if (!facet.owns(e)) continue;
                const EdgeMeeting met = meet(edge, sharpEdge(other, facet, e), contacts_.size());
                any = met.found && met.separation <= 0 && dot(met.onA - p, edge.along) >= 0 &&
                      dot(met.onA - q, edge.along) <= 0;
            }
            return !any;
        });
        return any;
    }

    Contacts& contacts_;
    PiercingEdge edges_[3];
    std::uint32_t source_ = 0;
    int count_ = 0;
    bool ofA_ = true;
};

/// The corners and edges of a facet that may touch another surface.
template <class Side, class Other>
void collideFacet(const Side& side, const Facet& facet, const Other& other, Contacts& contacts, bool ofA) {
    const Bounds b = contacts.reached(facet.bounds(), ofA);
    if (!overlaps(b, other.bounds())) return;
    EdgeContacts edges(contacts);
    edges.take(side, facet, ofA);
    bool any = false;
    other.forEachFacet(b, [&](const Facet& near) {
        any = true;
        edges.collide(other, near);
        return !edges.empty();
    });
    if (!any) return;
    edges.collideInsides(other);
    collideCorners(side, facet, other, contacts, ofA);
}

template <class Other>
void collideMesh(const MeshSide& mesh, const Other& other, Contacts& contacts, bool ofA) {
    const auto isNear = [&](const Bounds& node) {
        const Bounds b = contacts.reached(node, ofA);
        return overlaps(b, other.bounds()) && other.anyNear(b);
    };
    mesh.descend(isNear, [&](const Facet& facet) { collideFacet(mesh, facet, other, contacts, ofA); });
}

void collideField(const FieldSide& field, const MeshSide& mesh, Contacts& contacts) {
    field.forEachFacet(contacts.reached(mesh.bounds(), false), [&](const Facet& facet) {
        collideFacet(field, facet, mesh, contacts, true);
        return true;
    });
}

/// All corners of a mesh within the bounds of a solid, however deep.
template <class Other>
void collideDeep(const MeshSide& mesh, const Other& other, Contacts& contacts, bool ofA) {
    mesh.descend([&](const Bounds& node) { return overlaps(node, other.bounds()); },
                 [&](const Facet& facet) { collideCorners(mesh, facet, other, contacts, ofA); });
}

Vec3 middle(const Bounds& b) { return 0.5f * (b.lower + b.upper); }

bool asksForDepth(Contacts& contacts) { return contacts.gatherer().deepest() < -0.5f * kInward * contacts.size(); }

}  // namespace
}  // namespace surface

using namespace surface;

int collideSurfaces(const MeshData& a, const MeshData& b, const Frame& bInA, const ContactReach& reach,
                    std::span<Manifold> out) {
    const MeshSide sideA(a, bInA.position), sideB(b, bInA.rotation);
    Contacts contacts(reach, middle(sideB.bounds()) - middle(sideA.bounds()));
    collideMesh(sideA, sideB, contacts, true);
    collideMesh(sideB, sideA, contacts, false);
    const bool contained = contacts.gatherer().empty() &&
                           (contains(sideA.bounds(), sideB.bounds()) || contains(sideB.bounds(), sideA.bounds()));
    if (contained || asksForDepth(contacts)) {
        if (sideB.encloses()) collideDeep(sideA, sideB, contacts, true);
        if (sideA.encloses()) collideDeep(sideB, sideA, contacts, false);
    }
    return contacts.gatherer().write(bInA.position, out);
}

int collideSurfaces(const HeightFieldData& a, const MeshData& b, const Frame& bInA, const ContactReach& reach,
                    std::span<Manifold> out) {
    const FieldSide sideA(a, bInA.position);
    const MeshSide sideB(b, bInA.rotation);
    Contacts contacts(reach, middle(sideB.bounds()) - middle(sideA.bounds()));
    collideField(sideA, sideB, contacts);
    collideMesh(sideB, sideA, contacts, false);
    return contacts.gatherer().write(bInA.position, out);
}

int collideSurfaces(const MeshData& a, const ConvexView& round, const Frame& bInA, const ContactReach& reach,
                    std::span<Manifold> out) {
    const MeshSide mesh(a, bInA.position);
    const RoundSide side(round, bInA.rotation);
    Contacts contacts(reach, middle(side.bounds()) - middle(mesh.bounds()));
    EdgeContacts edges(contacts);
    SharpEdge core;
    core.from = side.p;
    core.along = side.q - side.p;
    core.round = true;
    const bool hasEdge = core.along != Vec3{};
    const auto isNear = [&](const Bounds& node) { return overlaps(contacts.reached(node, true), side.bounds()); };
    mesh.descend(isNear, [&](const Facet& facet) {
        if (!isNear(facet.bounds())) return;
        collideCorners(mesh, facet, side, contacts, true);
        if (!hasEdge) return;
        edges.take(mesh, facet, true);
        edges.collide(core, side.radius);
    });
    collideCorner({side.p, {}, side.radius, 0, 0, false}, mesh, contacts);
    if (hasEdge) collideCorner({side.q, {}, side.radius, 1, 0, false}, mesh, contacts);
    return contacts.gatherer().write(bInA.position, out);
}

}  // namespace ragtop
