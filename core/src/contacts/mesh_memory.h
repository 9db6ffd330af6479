#pragma once

#include "base/aligned_array.h"
#include "narrowphase/near_triangles.h"

namespace ragtop {

/// What pairs with meshes remember of the triangles around them.
class MeshMemory {
public:
    explicit MeshMemory(std::pmr::memory_resource* memory) : slots_(memory), all_(memory) {}

    std::uint32_t acquire() {
        const std::uint32_t index = slots_.acquire();
        if (index >= all_.size()) all_.resize(index + 1, {});
        all_[index] = {};
        return index;
    }
    void release(std::uint32_t index) { slots_.release(index); }
    NearTriangles& operator[](std::uint32_t index) { return all_[index]; }
    const NearTriangles& operator[](std::uint32_t index) const { return all_[index]; }
    std::size_t bytes() const { return all_.bytes(); }

    template <class Archive>
    void archive(Archive& archive) {
        slots_.archive(archive);
        archive(all_);
    }

private:
    Slots slots_;
    AlignedArray<NearTriangles> all_;
};

}  // namespace ragtop
