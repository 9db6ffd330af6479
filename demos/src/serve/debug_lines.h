#pragma once

#include <map>
#include <string>
#include <vector>

#include "cast.h"
#include "frame_encoder.h"
#include "nodes.h"
#include "ragtop/debug_draw.h"

namespace ragtop::live {

/// Which debug drawing is on, by showNames().
using ShowOptions = std::map<std::string, bool>;

/// Lines of what World::draw shows, m, relative to `origin`.
class LineCollector : public DebugDraw {
public:
    explicit LineCollector(const DVec3& origin) : origin_(origin) {}

    void line(const DVec3& from, const DVec3& to, Color color) override;
    void arrow(const DVec3& from, const Vec3& along, Color color) override;
    /// A cross.
    void sphere(const Pose& pose, float radius, Color color) override;
    void frame(const Pose& pose, float size) override;

    const std::vector<LineSegment>& segments() const { return segments_; }

private:
    DVec3 origin_;
    std::vector<LineSegment> segments_;
};

/// Contacts, joints, bounds, centres, wheels and skeletons, as far as they are shown.
std::vector<LineSegment> debugLines(const Cast& cast, const ShowOptions& show, const DVec3& origin);
/// Whether anything of that is shown.
bool showsLines(const ShowOptions& show);

/// Every body in the colour of its island, or in its own where islands are not shown.
std::vector<NodeColor> islandColors(const Cast& cast, const Nodes& nodes, bool shown);

}  // namespace ragtop::live
