#pragma once

#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"
#include "base/stage_memory.h"
#include "contacts/tables.h"
#include "direct/choice.h"
#include "islands/load_paths.h"

namespace ragtop {

/// Moving bodies that hang together, as sets with a root, found anew whenever a stage asks for them: those that touch
/// or are joined (who may sleep), that are within reach (who is solved together), or those of the direct list.
class Islands {
public:
    explicit Islands(std::pmr::memory_resource* memory)
        : parent(memory),
          quiet(memory),
          stack(memory),
          directBodies(memory),
          directContacts(memory),
          directJoints(memory) {}

    /// Each awake body by itself.
    void begin(const Bodies& bodies);
    std::uint32_t root(std::uint32_t body);
    /// The lower of both roots becomes the root, so that roots depend on the scene alone. What does not move holds
    /// nothing together.
    void unite(const Bodies& bodies, std::uint32_t a, std::uint32_t b);
    /// Those of bodies that touch, or that are within reach, or joined or coupled.
    void uniteConstraints(const ConstTables& tables, bool touchingOnly);
    /// Those that touch, and how long each has been quiet.
    void findQuiet(const ConstTables& tables);
    direct::IslandFeatures& featuresOf(std::uint32_t body) { return features[number[root(body)]]; }

    /// Where in the graph a constraint came, went or moved.
    void graphChangedAt(bool inDirectList) {
        graphChanged = true;
        directChanged |= inDirectList;
    }
    /// Bodies or joints were made, moved or woken.
    void structureChangedAt() { structureChanged = graphChanged = true; }

    template <class Archive>
    void archive(Archive& archive) {
        archive.value(graphChanged);
        archive.value(directChanged);
        archive.value(choiceStep);
        archive.value(structureChanged);
    }

    /// The islands of bodies that are solved directly, or were until now, where nothing is coupled. The lists hold
    /// until the next call.
    IslandLists findDirect(const ConstTables& tables);

    AlignedArray<std::uint32_t> parent;  ///< union-find over bodies
    AlignedArray<float> quiet;           ///< s, of the least quiet body of a root
    AlignedArray<std::uint32_t> stack;   ///< bodies to be visited, or in the order of a visit
    AlignedArray<std::uint32_t> directBodies, directContacts, directJoints;  ///< of findDirect
    /// What measuring finds, for the choice of solvers: in memory of that stage, until another one takes some.
    LoadPaths paths;
    StageArray<std::uint32_t> number;  ///< per body that is a root: place of its island in `features`
    StageArray<direct::IslandFeatures> features;
    StageArray<float> stiffness;  ///< per body, h² Σ k/m of its springs along ways

    // Since solvers were chosen:
    bool graphChanged = true;      ///< support edges
    bool directChanged = true;     ///< the same where a direct island has part in it
    bool structureChanged = true;  ///< the same by bodies and joints that were made, moved or woken
    std::uint64_t choiceStep = 0;  ///< in which they were chosen
};

}  // namespace ragtop
