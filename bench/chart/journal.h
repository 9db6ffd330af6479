#pragma once

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "point.h"

namespace ragtop::chart {

/// The points of a sweep as they come, each written out at once; a line that is cut off counts for nothing.
class Journal {
public:
    /// `plan` tells sweeps apart. Begins anew, or goes on with what the file has, `again` without the points that other
    /// processes disturbed. Throws std::runtime_error for a journal of another sweep or one that cannot be written.
    Journal(const std::filesystem::path& file, const std::string& plan, bool resume, bool again);

    /// Null where it has none of that key.
    const Point* find(const std::string& key) const;
    void add(const Point& point);

private:
    void load(const std::string& text, const std::string& head);
    void write(const std::string& text);

    std::filesystem::path path_;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{nullptr, std::fclose};
    std::map<std::string, Point> known_;
};

}  // namespace ragtop::chart
