#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "json_document.h"
#include "ragtop/asset_error.h"

namespace ragtop {

/// All that is wrong with a document, a line each. Readers pass over the values that are wrong and go on, so that the
/// others are looked at too; what cannot be said because of a value that is wrong is a Consequence, and not told.
class Faults {
public:
    explicit Faults(const JsonDocument& document) : document_(&document) {}

    /// Notes that the value at `pointer` is wrong.
    void add(const std::string& pointer, const std::string& message);
    /// The same of a member that its object does not have.
    void addUnknown(const std::string& pointer, const std::string& message);
    /// Throws AssetError with all lines in the order of their places; only the first twenty are shown.
    void throwIfAny() const;

    bool any() const { return !wrong_.empty(); }
    bool at(const std::string& pointer) const { return wrong_.contains(pointer); }
    bool within(const std::string& pointer) const;
    /// Whether the object at `pointer` has members that it should not have, which may be others misspelled.
    bool unknownIn(const std::string& pointer) const { return ofUnknown_.contains(pointer); }

    /// Thrown where what is wrong may follow from what is noted already.
    struct Consequence {};
    /// Calls `read` for the value at `pointer`, which is wrong when that complains.
    template <class Read>
    void attempt(const std::string& pointer, Read read) {
        try {
            read();
        } catch (const AssetError& error) {
            addLines(pointer, error.what());
        } catch (const Consequence&) {
            wrong_.insert(pointer);
        }
    }

private:
    struct Line {
        JsonPlace place;
        std::size_t number;  ///< in which they were noted
        std::string text;
    };
    void addLines(const std::string& pointer, std::string_view lines);

    const JsonDocument* document_;
    std::vector<Line> lines_;
    std::set<std::string> wrong_;      ///< pointers
    std::set<std::string> ofUnknown_;  ///< pointers of objects
};

}  // namespace ragtop
