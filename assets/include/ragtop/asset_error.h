#pragma once

#include <stdexcept>
#include <string>

namespace ragtop {

/// A file that cannot be used. what() is a line per mistake: file, place in it, value found and what is allowed.
class AssetError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
    /// "file:place: message", or "file: message" where no place is known.
    AssetError(const std::string& file, const std::string& place, const std::string& message)
        : std::runtime_error(place.empty() ? file + ": " + message : file + ":" + place + ": " + message) {}
};

}  // namespace ragtop
