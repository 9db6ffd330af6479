#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "page_server.h"
#include "ragtop/debug_draw.h"
#include "ragtop/math.h"

namespace ragtop {

/// A thing the page draws, and where it is in the world.
struct NodePose {
    std::uint32_t node = 0;  ///< numbered densely from 0, for the encoder keeps a table of them
    Pose pose;
};

/// Turns poses into binary frames (type 1 of docs/serve.md) that hold only what has changed. For each node it keeps the
/// pose last sent off and when that last changed; so a page that skipped frames gets every later change with its next.
class FrameEncoder {
public:
    /// Positions in frames are single precision relative to `origin`, m.
    explicit FrameEncoder(const DVec3& origin = {});

    /// The poses of all nodes there are, after a step or a jump in time. A node that is not among them is gone; when it
    /// comes back it counts as changed.
    void update(std::span<const NodePose> poses, std::uint32_t step, double time);
    /// Number of the latest update, from 1; a page that has got the latest frame is at this number.
    std::uint32_t sequence() const { return sequence_; }
    /// The nodes that changed after update `since`; 0 for all. The bytes are made once per `since` and update.
    FrameBytes encode(std::uint32_t since);

private:
    struct Node {
        float values[7] = {};        // position relative to the origin; x, y, z, w of the rotation
        std::uint32_t changed = 0;   // update of the last change
        std::uint32_t seen = 0;      // last update it was part of
    };
    struct Made {
        std::uint32_t since;
        FrameBytes frame;
    };

    FrameBytes make(std::uint32_t since) const;

    DVec3 origin_;
    std::vector<Node> nodes_;             // by number
    std::vector<std::uint32_t> present_;  // numbers of the latest update, in its order
    std::vector<Made> made_;              // frames of the latest update
    std::uint32_t sequence_ = 0, step_ = 0;
    double time_ = 0;
};

struct LineSegment {
    Vec3 from, to;  ///< m, relative to the scene's origin
    Color color = 0;
};
/// Debug drawing: a frame of type 2.
FrameBytes encodeLines(std::span<const LineSegment> segments, std::uint32_t step);

/// A node drawn in another colour than its own.
struct NodeColor {
    static constexpr Color kOwn = 0xFFFFFFFF;  ///< back to the node's own
    std::uint32_t node = 0;
    Color color = kOwn;
};
/// Colours by island and sleep: a frame of type 3.
FrameBytes encodeColors(std::span<const NodeColor> colors, std::uint32_t step);

/// The points of cloths, m, relative to the scene's origin: a frame of type 4.
FrameBytes encodePoints(std::span<const Vec3> points, std::uint32_t step);

}  // namespace ragtop
