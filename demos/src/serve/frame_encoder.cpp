#include "frame_encoder.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

namespace ragtop {

// Frames are little-endian, and records are copied as they lie in memory.
static_assert(std::endian::native == std::endian::little);

namespace {

enum class FrameType : std::uint32_t { poses = 1, lines = 2, colors = 3, points = 4 };

struct PosesHeader {
    FrameType type = FrameType::poses;
    std::uint32_t sequence, step, count;
    double time, reserved = 0;
};
static_assert(sizeof(PosesHeader) == 32);

struct PoseRecord {
    std::uint32_t node;
    float values[7];
};
static_assert(sizeof(PoseRecord) == 32);

/// Of frames of lines, colours and points.
struct ListHeader {
    FrameType type;
    std::uint32_t step, count, reserved = 0;
};
static_assert(sizeof(ListHeader) == 16);

static_assert(sizeof(LineSegment) == 28 && std::is_trivially_copyable_v<LineSegment>);
static_assert(sizeof(Vec3) == 12);
static_assert(sizeof(NodeColor) == 8 && std::is_trivially_copyable_v<NodeColor>);

template <class Header>
std::byte* start(std::vector<std::byte>& bytes, const Header& header, std::size_t records) {
    bytes.resize(sizeof header + records);
    std::memcpy(bytes.data(), &header, sizeof header);
    return bytes.data() + sizeof header;
}

template <class Record>
FrameBytes listFrame(FrameType type, std::span<const Record> records, std::uint32_t step) {
    auto bytes = std::make_shared<std::vector<std::byte>>();
    const ListHeader header{type, step, static_cast<std::uint32_t>(records.size())};
    std::byte* at = start(*bytes, header, records.size_bytes());
    if (!records.empty()) std::memcpy(at, records.data(), records.size_bytes());
    return bytes;
}

}  // namespace

FrameEncoder::FrameEncoder(const DVec3& origin) : origin_(origin) {}

void FrameEncoder::update(std::span<const NodePose> poses, std::uint32_t step, double time) {
    ++sequence_;
    step_ = step;
    time_ = time;
    made_.clear();
    present_.clear();
    for (const NodePose& entry : poses) {
        if (entry.node >= nodes_.size()) nodes_.resize(entry.node + 1);
        const Vec3 p = relative(entry.pose.position, origin_);
        const Quat& q = entry.pose.rotation;
        const float values[7] = {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
        Node& node = nodes_[entry.node];
        const bool known = node.changed != 0 && node.seen == sequence_ - 1;
        if (!known || std::memcmp(node.values, values, sizeof values) != 0) {
            std::memcpy(node.values, values, sizeof values);
            node.changed = sequence_;
        }
        node.seen = sequence_;
        present_.push_back(entry.node);
    }
}

FrameBytes FrameEncoder::encode(std::uint32_t since) {
    const auto made = std::ranges::find(made_, since, &Made::since);
    if (made != made_.end()) return made->frame;
    made_.push_back({since, make(since)});
    return made_.back().frame;
}

FrameBytes FrameEncoder::make(std::uint32_t since) const {
    const auto changed = [&](std::uint32_t number) { return nodes_[number].changed > since; };
    const auto count = static_cast<std::uint32_t>(std::ranges::count_if(present_, changed));
    auto bytes = std::make_shared<std::vector<std::byte>>();
    const PosesHeader header{.sequence = sequence_, .step = step_, .count = count, .time = time_};
    std::byte* at = start(*bytes, header, count * sizeof(PoseRecord));
    for (const std::uint32_t number : present_) {
        if (!changed(number)) continue;
        PoseRecord record{number, {}};
        std::memcpy(record.values, nodes_[number].values, sizeof record.values);
        std::memcpy(at, &record, sizeof record);
        at += sizeof record;
    }
    assert(at == bytes->data() + bytes->size());
    return bytes;
}

FrameBytes encodeLines(std::span<const LineSegment> segments, std::uint32_t step) {
    return listFrame(FrameType::lines, segments, step);
}

FrameBytes encodeColors(std::span<const NodeColor> colors, std::uint32_t step) {
    return listFrame(FrameType::colors, colors, step);
}

FrameBytes encodePoints(std::span<const Vec3> points, std::uint32_t step) {
    return listFrame(FrameType::points, points, step);
}

}  // namespace ragtop
