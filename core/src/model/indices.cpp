#include "model/indices.h"

#include <stdexcept>
#include <string>

namespace ragtop {

template <class Table, class Id>
static std::uint32_t used(const Table& table, Id id, const char* name, std::uint32_t first = 0) {
    if (id.index < first || !table.slots.isValid(id.index, id.generation))
        throw std::out_of_range(std::string("no such ") + name + ": id names nothing");
    return id.index;
}

std::uint32_t indexOf(const Bodies& bodies, BodyId id) { return used(bodies, id, "body", 1); }
std::uint32_t indexOf(const Shapes& shapes, ShapeId id) { return used(shapes, id, "shape"); }
std::uint32_t indexOf(const Joints& joints, JointId id) { return used(joints, id, "joint"); }
std::uint32_t indexOf(const Couplings& couplings, CouplingId id) { return used(couplings, id, "coupling"); }

}  // namespace ragtop
