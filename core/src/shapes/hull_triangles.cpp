#include <algorithm>
#include <stdexcept>
#include <string>

#include "shapes/hull_build.h"

#ifdef RAGTOP_WITH_QHULL
#include <cstdlib>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}
#endif

namespace ragtop {
#ifdef RAGTOP_WITH_QHULL
namespace {

/// Qhull writes its complaints to a FILE.
class Complaints {
public:
    Complaints() : file_(open_memstream(&text_, &size_)) {
        if (!file_) throw std::bad_alloc();
    }
    ~Complaints() {
        std::fclose(file_);
        std::free(text_);
    }
    Complaints(const Complaints&) = delete;
    Complaints& operator=(const Complaints&) = delete;

    std::FILE* file() { return file_; }
    std::string firstLine() {
        std::fflush(file_);
        const std::string all(text_, size_);
        return all.substr(0, all.find('\n'));
    }

private:
    char* text_ = nullptr;
    std::size_t size_ = 0;
    std::FILE* file_;
};

/// One run of the Quickhull algorithm [Barber, Dobkin, Huhdanpaa, The Quickhull Algorithm for Convex Hulls, 1996].
class Quickhull {
public:
    Quickhull(std::vector<double> coordinates, const char* options) : coordinates_(std::move(coordinates)) {
        qh_zero(&state_, complaints_.file());
        std::string command = options;
        failed_ = qh_new_qhull(&state_, 3, static_cast<int>(coordinates_.size() / 3), coordinates_.data(), False,
                               command.data(), nullptr, complaints_.file()) != 0;
    }
    ~Quickhull() {
        state_.NOerrexit = True;
        qh_freeqhull(&state_, !qh_ALL);
        int still = 0, total = 0;
        qh_memfreeshort(&state_, &still, &total);
    }
    Quickhull(const Quickhull&) = delete;
    Quickhull& operator=(const Quickhull&) = delete;

    bool failed() const { return failed_; }
    std::string complaint() { return complaints_.firstLine(); }

    std::vector<HullTriangle> triangles() {
        std::vector<HullTriangle> result;
        for (facetT* facet = state_.facet_list; facet && facet->next; facet = facet->next) {
            HullTriangle triangle{};
            std::size_t count = 0;
            for (int i = 0; i < qh_setsize(&state_, facet->vertices); ++i) {
                auto* vertex = static_cast<vertexT*>(facet->vertices->e[i].p);
                if (count < 3) triangle[count] = qh_pointid(&state_, vertex->point);
                ++count;
            }
            if (count != 3) return {};
            if (facet->toporient ^ qh_ORIENTclock) std::swap(triangle[0], triangle[1]);
            std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
            result.push_back(triangle);
        }
        std::sort(result.begin(), result.end());
        return result;
    }

private:
    std::vector<double> coordinates_;
    Complaints complaints_;
    qhT state_;
    bool failed_ = false;
};

double volume(const std::vector<DVec3>& points, const std::vector<HullTriangle>& triangles) {
    double sum = 0;
    for (const HullTriangle& t : triangles) {
        const DVec3 &a = points[static_cast<std::size_t>(t[0])], &b = points[static_cast<std::size_t>(t[1])],
                    &c = points[static_cast<std::size_t>(t[2])];
        sum += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
    }
    return sum;
}

/// Every side of a triangle has exactly one partner that runs the other way.
bool isClosed(const std::vector<HullTriangle>& triangles) {
    std::vector<std::array<int, 2>> sides, partners;
    for (const HullTriangle& t : triangles) {
        for (std::size_t e = 0; e < 3; ++e) {
            sides.push_back({t[e], t[(e + 1) % 3]});
            partners.push_back({t[(e + 1) % 3], t[e]});
        }
    }
    std::sort(sides.begin(), sides.end());
    std::sort(partners.begin(), partners.end());
    return triangles.size() >= 4 && sides == partners && std::adjacent_find(sides.begin(), sides.end()) == sides.end();
}

}  // namespace

std::vector<HullTriangle> convexTriangles(const std::vector<DVec3>& points) {
    std::vector<double> coordinates;
    coordinates.reserve(3 * points.size());
    for (const DVec3& p : points) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});

    std::string complaint = "Qhull's facets do not close";
    // Exact facets cut into triangles; where rounding spoils those, points moved by rounding errors (a fixed seed).
    for (const char* options : {"qhull Qt Pp", "qhull QJ Pp"}) {
        Quickhull run(coordinates, options);
        if (run.failed()) {
            complaint = run.complaint();
            continue;
        }
        std::vector<HullTriangle> triangles = run.triangles();
        if (volume(points, triangles) < 0) {
            for (HullTriangle& t : triangles) std::swap(t[1], t[2]);
            std::sort(triangles.begin(), triangles.end());
        }
        if (isClosed(triangles)) return triangles;
    }
    throw std::invalid_argument("ConvexHull: points have no hull: " + complaint);
}
#else
std::vector<HullTriangle> convexTriangles(const std::vector<DVec3>&) {
    throw std::invalid_argument("ConvexHull: this build of Ragtop has no Qhull (RAGTOP_WITH_QHULL is off)");
}
#endif

}  // namespace ragtop
