#include "wheel_course.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr float kSamePlane = 2e-3f;  ///< radii between planes that count as one, and rad between their normals
constexpr float kSameTurn = 0.02f;
constexpr float kFinest = 2.5e-4f;  ///< s, of a piece of the course of a wheel that is thrown
constexpr float kSteepestClimb =
    20;                        ///< m risen per m travelled, as on no edge, beyond which ground comes up by itself
constexpr float kCatchUp = 1;  ///< and is climbed by so many m per m

constexpr float kCreep = 0.5f * kLiftSpeed;  ///< m/s, of a wheel that comes to rest

struct Sample {
    GroundPlane plane;
    DVec3 hub;
    float rise = 0;  ///< m
};

bool isOnePlane(const Sample& a, const Sample& b, const WheelWay& way) {
    if (a.plane.found != b.plane.found) return false;
    if (a.plane.found == 0) return true;
    const float apart = std::abs(dot(relative(b.plane.point, a.plane.point), a.plane.normal));
    return apart < kSamePlane * way.radius && length(b.plane.normal - a.plane.normal) < kSameTurn;
}

/// From a to b in so many seconds, along the way of the hub: it rises from a.rise to b.rise, which is lowered to what
/// it can have climbed.
GroundPlane pieceBetween(const Sample& a, Sample& b, const WheelWay& way, float below, float seconds) {
    if (b.plane.found == 0) return a.plane.found != 0 ? a.plane : b.plane;
    if (a.plane.found == 0 || !way.stands || (below == 0 && isOnePlane(a, b, way))) return b.plane;
    const Vec3 went = relative(b.hub, a.hub);
    const float along = dot(went, way.axis), onward = std::sqrt(std::max(dot(went, went) - along * along, 0.0f));
    const float climbed = b.rise - (a.rise + below);
    const float more = climbed > kSteepestClimb * onward ? 0 : std::max(climbed, 0.0f);
    const float found = b.rise;
    b.rise = std::min(found, a.rise + more + kCatchUp * onward + kLiftSpeed * seconds);
    const float climb = b.rise - a.rise;
    const auto lowered = [&] {
        GroundPlane piece = b.plane;
        piece.point = piece.point + (b.rise - found) * way.axis;
        return piece;
    };
    // Planes are not known to the way of what comes to rest.
    if (climb < -onward || length(went) < kCreep * seconds) return lowered();
    const Vec3 locus = went + climb * way.axis;
    const float squared = dot(locus, locus);
    const Vec3 mean = a.plane.normal + b.plane.normal;
    const Vec3 across = squared > 0 ? mean - (dot(mean, locus) / squared) * locus : mean;
    GroundPlane piece = climb > 0 ? b.plane : a.plane;
    piece.normal = length(across) > 1e-3f ? normalized(across) : b.plane.normal;
    const std::optional<Vec3> down = lowestPoint(piece.normal, way.axle, way.radius);
    if (!down || !(dot(piece.normal, way.axis) > kSteepest)) return lowered();
    piece.point = a.hub + a.rise * way.axis + *down;
    return piece;
}

}  // namespace

/// About the hub's ways from the highest place to the lowest, in single precision, to which far places are rounded.
Bounds boundsOf(const WheelWay& way) {
    constexpr float kRounding = 2.4e-7f;  // of a place, of two roundings
    const float reach = kFaceReach * way.radius + way.halfWidth;
    const auto around = [&](const DVec3& hub, float along) {
        const Vec3 place = toVec3(hub + along * way.axis), most = Vec3{reach, reach, reach} + kRounding * abs(place);
        return Bounds{place - most, place + most};
    };
    return merge(merge(around(way.from, way.above), around(way.from, -way.below)),
                 merge(around(way.to, way.above), around(way.to, -way.below)));
}

/// (hub + down + x a − point)·n = 0
std::optional<float> riseOn(const GroundPlane& plane, const WheelWay& way, const DVec3& hub) {
    const std::optional<Vec3> down = lowestPoint(plane.normal, way.axle, way.radius);
    const float slant = dot(plane.normal, way.axis);
    if (!down || !(slant > kSteepest)) return {};
    return -dot(relative(hub, plane.point) + *down, plane.normal) / slant;
}

namespace {

/// Of one step of a wheel.
struct Search {
    const World& world;
    const QueryFilter& query;
    const WheelWay& way;
    bool byRays = false;

    void take(Sample& sample) const {
        const std::optional<float> rise =
            sample.plane.found != 0 ? riseOn(sample.plane, way, sample.hub) : std::nullopt;
        sample.plane.found = rise ? 1 : 0;
        sample.rise = rise.value_or(0);
    }

    Sample on(const GroundPlane& plane, float share) const {
        Sample sample{plane, way.from + share * relative(way.to, way.from), 0};
        take(sample);
        return sample;
    }

    Sample look(float share) const {
        Sample sample{{}, way.from + share * relative(way.to, way.from), 0};
        const float reach = way.above + way.below + (byRays ? way.radius : 0);
        const WheelPath path{
            sample.hub + way.above * way.axis, -reach * way.axis, way.axis, way.axle, way.radius, way.halfWidth};
        byRays ? findPoint(world, query, path, sample.plane) : findGround(world, query, path, sample.plane);
        take(sample);
        return sample;
    }

    /// What was found at the end of the way before, where it is now.
    Sample again(const GroundPlane& last) const {
        if (last.found == 0 || !world.isValid(last.body)) return look(0);
        Sample sample{last, way.from, 0};
        if (const Pose now = world.pose(last.body); now != last.pose) {
            movePlane(last, now, sample.plane.point, sample.plane.normal);
            sample.plane.pose = now;
        }
        take(sample);
        return sample;
    }

    /// At the ends of so many equal parts; the first is known.
    void lookAlong(std::span<Sample> samples, const Sample& end) const {
        samples.back() = end;
        lookBetween(samples, 0, samples.size() - 1);
    }

    /// Between two that are known. Where these are on one plane, no more than a radius apart, all are.
    void lookBetween(std::span<Sample> samples, std::size_t from, std::size_t to) const {
        if (to - from < 2) return;
        const std::size_t middle = (from + to) / 2;
        const float part = 1 / static_cast<float>(samples.size() - 1), share = static_cast<float>(middle) * part;
        const bool isNear = static_cast<float>(to - from) * part * length(relative(way.to, way.from)) <= way.radius;
        samples[middle] =
            isNear && isOnePlane(samples[from], samples[to], way) ? on(samples[to].plane, share) : look(share);
        lookBetween(samples, from, middle);
        lookBetween(samples, middle, to);
    }

    /// Is all of the way over one plane?
    bool isEven(const Sample& first, const Sample& end) const {
        if (!isOnePlane(first, end, way)) return false;
        if (!(length(relative(way.to, way.from)) > way.radius)) return true;
        const Sample middle = look(0.5f);
        return isOnePlane(first, middle, way) && isOnePlane(middle, end, way);
    }
};

/// What ends the way of a wheel: what was looked for there, or, of one that hardly moves between two planes on which it
/// lies as high, the one that it stands on: from step to step the other one would throw a car that has come to rest.
Sample endOf(const Search& search, const Sample& first, float below) {
    const WheelWay& way = search.way;
    const Sample end = search.look(1);
    constexpr float kSameRise = 0.5f;  // of the standing tire's squash: it bears half of its load then
    const GroundPlane &on = first.plane, &found = end.plane;
    if (!way.stands || below != 0 || on.found == 0 || found.found == 0 || !(on.body == found.body)) return end;
    if (on.moves != 0 || on.surface != found.surface || on.friction != found.friction) return end;
    if (length(relative(way.to, way.from)) > kCreep * way.seconds) return end;
    const Sample stays = search.on(on, 1);
    return stays.plane.found != 0 && std::abs(stays.rise - end.rise) < kSameRise * way.tireSquash ? stays : end;
}

/// By how much more the hub of a wheel that stands goes up in one part of the way than in the one before, over what it
/// may.
float thrownBy(std::span<const Sample> samples, int count, const WheelWay& way) {
    float before = 0, most = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
        const Sample &from = samples[k], &to = samples[k + 1];
        if (from.plane.found == 0 || to.plane.found == 0) continue;
        const float rise = to.rise - from.rise;
        most = std::max(most, rise - before);
        before = rise;
    }
    return most / (kThrown * way.tireSquash);
}

}  // namespace

int finePieces(float seconds, int substeps) {
    const float each = seconds / static_cast<float>(substeps);
    return std::clamp(static_cast<int>(std::ceil(each / kFinest)), 1, std::max(kMostPieces / substeps, 1));
}

namespace {

/// One piece from a, which the wheel has come to, to b: what it stands on there, or the plane that leads to it.
GroundPlane takeOnce(const Search& search, Sample a, Sample b, const CourseEnd& last) {
    last.plane = b.plane;
    a.rise -= last.below;
    const float found = b.rise;
    const GroundPlane piece = pieceBetween(a, b, search.way, last.below, search.way.seconds);
    last.below = found - b.rise;
    return piece;
}

/// Samples at the ends of the pieces of a course, the first of which the wheel has come to.
void takeCourse(const Search& search, std::span<Sample> samples, const CourseEnd& last, WheelCourse& course) {
    const std::size_t count = samples.size() - 1;
    course.count = static_cast<int>(count);
    // What moves is solved with the car as one body for the step, where it will be in its middle.
    const auto moves = [](const Sample& sample) { return sample.plane.found != 0 && sample.plane.moves != 0; };
    if (std::ranges::any_of(samples, moves)) {
        course.count = 1;
        course.pieces[0] = takeOnce(search, samples[0], samples.back(), last);
        if (last.below == 0 && isOnePlane(samples[0], samples.back(), search.way))
            course.pieces[0] = search.look(0.5f).plane;
        return;
    }
    last.plane = samples.back().plane;
    samples[0].rise -= last.below;
    const float seconds = search.way.seconds / static_cast<float>(count);
    for (std::size_t k = 0; k < count; ++k) {
        Sample& next = samples[k + 1];
        const float found = next.rise;
        course.pieces[k] = pieceBetween(samples[k], next, search.way, last.below, seconds);
        last.below = found - next.rise;
    }
}

void takeFineCourse(const Search& search, int count, const Sample& first, const Sample& end, const CourseEnd& last,
                    WheelCourse& course) {
    std::array<Sample, kMostPieces + 1> samples;
    samples[0] = first;
    const std::span<Sample> used = std::span(samples).first(static_cast<std::size_t>(count) + 1);
    search.lookAlong(used, end);
    takeCourse(search, used, last, course);
}

}  // namespace

void findPlane(const World& world, const QueryFilter& query, const WheelWay& way, const CourseEnd& last,
               GroundPlane& plane) {
    const Search search{world, query, way, true};
    const Sample first = search.again(last.plane);
    plane = takeOnce(search, first, endOf(search, first, last.below), last);
}

int pieceAt(const WheelCourse& course, float share, const DVec3& hub) {
    constexpr float kLag = 0.5f;  // of a piece, which is nothing
    const auto count = static_cast<float>(course.count);
    const int byTime = std::min(static_cast<int>(share * count + 1e-3f), course.count - 1);
    const float squared = dot(course.went, course.went);
    if (course.count == 1 || !(squared > 0)) return byTime;
    const float come = dot(relative(hub, course.from), course.went) / squared;
    return std::clamp(static_cast<int>(std::clamp(come, 0.0f, 1.0f) * count + kLag), 0, byTime);
}

void findCourse(const World& world, const QueryFilter& query, const WheelWay& way, int substeps, const CourseEnd& last,
                WheelCourse& course) {
    constexpr int kMostCoarse = 8;
    const Search search{world, query, way};
    std::array<Sample, kMostCoarse + 1> samples;
    samples[0] = search.again(last.plane);
    const Sample end = endOf(search, samples[0], last.below);
    course.taken = -1;
    course.from = way.from;
    course.went = relative(way.to, way.from);
    const int count = search.isEven(samples[0], end) ? 1 : std::clamp(substeps, 1, kMostCoarse);
    const std::span<Sample> used = std::span(samples).first(static_cast<std::size_t>(count) + 1);
    search.lookAlong(used, end);
    const int finest = finePieces(way.seconds, count);
    if (const float thrown = count > 1 ? thrownBy(samples, count, way) : 0; finest > 1 && thrown > 1) {
        const int fine = thrown < static_cast<float>(finest) ? static_cast<int>(std::ceil(thrown)) : finest;
        return takeFineCourse(search, count * fine, samples[0], end, last, course);
    }
    takeCourse(search, used, last, course);
}

}  // namespace ragtop
