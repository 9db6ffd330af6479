#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"
#include "base/paged_array.h"
#include "model/records.h"

namespace ragtop {

/// Pairs of shapes whose enlarged bounds overlap. A contact hangs in a list of each of its bodies, and is awake when
/// one of them is. Its manifolds are in Manifolds while it has points.
///
/// Between two calls `awake` holds each contact that is awake once, at its awakeIndex.
class Contacts {
public:
    explicit Contacts(std::pmr::memory_resource* memory)
        : slots(memory), links(memory), awake(memory), records_(memory) {}

    std::uint32_t acquire() {
        const std::uint32_t contact = slots.acquire();
        ++made;
        if (contact >= records_.size()) records_.resize(contact + 1, {}), links.resize(contact + 1, {});
        records_[contact] = {};
        return contact;
    }
    /// Of a contact that hangs on no body, is asleep and has no manifolds.
    void release(std::uint32_t contact) {
        assert(records_[contact].awakeIndex == kNone && records_[contact].firstManifold == kNone);
        slots.release(contact);
    }

    std::size_t size() const { return records_.size(); }
    std::size_t bytes() const { return records_.bytes() + links.bytes(); }
    ContactRecord& operator[](std::size_t contact) { return records_[contact]; }
    const ContactRecord& operator[](std::size_t contact) const { return records_[contact]; }
    PagedArray<ContactRecord>& records() { return records_; }
    const PagedArray<ContactRecord>& records() const { return records_; }
    /// The next edge key of a body's list of contacts.
    std::uint32_t next(std::uint32_t key) const { return links[key >> 1].edges[key & 1].next; }

    void addAwake(std::uint32_t contact) {
        assert(records_[contact].awakeIndex == kNone);
        records_[contact].awakeIndex = static_cast<std::uint32_t>(awake.size());
        awake.push(contact);
    }
    void removeAwake(std::uint32_t contact) {
        const std::uint32_t place = records_[contact].awakeIndex, last = awake.back();
        assert(place < awake.size() && awake[place] == contact);
        awake[place] = last;
        records_[last].awakeIndex = place;
        awake.pop();
        records_[contact].awakeIndex = kNone;
    }

    template <class Archive>
    void archive(Archive& archive) {
        slots.archive(archive);
        archive(records_);
        archive(links);
        archive(awake);
        archive.value(made);
    }

    Slots slots;
    PagedArray<ContactLinks> links;
    AlignedArray<std::uint32_t> awake;
    std::uint32_t made = 0;  ///< since contacts were put in the order of space

private:
    PagedArray<ContactRecord> records_;
};

}  // namespace ragtop
