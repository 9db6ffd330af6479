#include "ragtop/world.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ragtop/command_buffer.h"
#include "world/world_impl.h"

namespace ragtop {

namespace {

std::pmr::memory_resource* orDefault(std::pmr::memory_resource* memory) {
    return memory ? memory : std::pmr::get_default_resource();
}

/// By their keys; those of one key stay in the order given.
std::vector<CommandBuffer*> inOrder(std::span<CommandBuffer* const> buffers) {
    std::vector<std::pair<std::uint64_t, std::size_t>> order;
    for (std::size_t i = 0; i < buffers.size(); ++i) order.emplace_back(buffers[i]->key(), i);
    std::sort(order.begin(), order.end());
    std::vector<CommandBuffer*> ordered;
    for (const auto& [key, place] : order) ordered.push_back(buffers[place]);
    return ordered;
}

int checkedLanes(int lanes) {
    if (lanes != 0 && lanes != 4 && lanes != 8 && lanes != 16)
        throw std::invalid_argument("lanes is " + std::to_string(lanes) + ", must be 0, 4, 8 or 16");
    return lanes;
}

}  // namespace

WorldImpl::WorldImpl(const WorldSettings& worldSettings, const WorldConfig& config)
    : settings(worldSettings),
      memory(orDefault(config.memory)),
      runner(config.tasks),
      workerChoice(runner.workers()),
      kernels(&selectKernels(checkedLanes(config.lanes))),
      jointKernels(&selectJointKernels(kernels->lanes)),
      bodySlots(memory),
      shapeSlots(memory),
      contactSlots(memory),
      jointSlots(memory),
      couplingSlots(memory),
      bodies(memory),
      states(memory),
      inertias(memory),
      dynamics(memory),
      histories(memory),
      bodyUserData(memory),
      shapes(memory),
      contacts(memory),
      contactLinks(memory),
      manifolds(memory),
      meshMemory(memory),
      freeManifolds(memory),
      freeMeshManifolds(memory),
      freeStored(memory),
      storedImpulses(memory),
      joints(memory),
      jointSims(memory),
      newVelocityBodies(memory),
      newJoints(memory),
      violatedJoints(memory),
      couplings(memory),
      couplingSims(memory),
      awakeBodies(memory),
      awakeContacts(memory),
      moveBuffer(memory),
      multirate(memory),
      graph(kernels->lanes, memory),
      stageMemory(memory),
      staticTree(memory, stageMemory),
      movingTree(memory, stageMemory),
      pairs(memory),
      geometries(memory),
      moduleWork(memory),
      regions(memory),
      jointBundles(jointKernels->lanes, memory),
      springs(memory),
      manifoldTouches(memory),
      laneTouches(memory),
      freezing(memory),
      contactChanged(memory),
      dirtyContacts(memory),
      changedContacts(memory),
      shiftedBodies(memory),
      closingContacts(memory),
      islandParent(memory),
      islandQuiet(memory),
      bodyStack(memory),
      movedConstraints(memory),
      iteratedCouplings(memory),
      articulations(memory),
      energyGuard(memory),
      jointClosing(memory),
      boundsLeft(memory),
      freshManifolds(memory),
      directIslands(memory),
      directBodies(memory),
      directManifolds(memory),
      directJoints(memory),
      directLanes(memory),
      directSims(memory),
      directIndex(memory),
      systemOwner(memory),
      systemOfBody(memory),
      chains(memory),
      treeMark(memory),
      treeBodies(memory),
      directSeen(memory),
      directOwner(memory),
      ledger(memory),
      bodyFlags(memory),
      pairSearch(memory),
      sweptImpacts(memory),
      begins(memory),
      ends(memory),
      sensorBegins(memory),
      sensorEnds(memory),
      endsBetweenSteps(memory),
      sensorEndsBetweenSteps(memory),
      surfaceEvents(memory),
      sleepEvents(memory),
      sleepEventsBetweenSteps(memory),
      jointBreaks(memory),
      brokenJoints(memory),
      stages(memory) {
    if (const std::string wrong = whyInvalid(settings); !wrong.empty()) throw std::invalid_argument(wrong);
    for (int worker = 0; worker < runner.workers(); ++worker) heldManifolds.emplace_back(memory);
    // Body 0 is the world: static, without shapes, the other end of joints to nowhere.
    bodySlots.acquire();
    bodies.resize(1, {});
    bodies[0].type = BodyType::fixed;
    states.resize(1, {});
    inertias.resize(1, {});
    dynamics.resize(1, {});
    histories.resize(1, {});
    bodyUserData.resize(1, 0);
    const auto expected = static_cast<std::size_t>(std::max(config.expectedBodies, 0)) + 1;
    bodies.reserve(expected);
    states.reserve(expected);
    inertias.reserve(expected);
    dynamics.reserve(expected);
    histories.reserve(expected);
    bodyUserData.reserve(expected);
    shapes.reserve(expected);
    awakeBodies.reserve(expected);
}

World::World(const WorldSettings& settings, const WorldConfig& config)
    : impl_(std::make_unique<WorldImpl>(settings, config)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

const WorldSettings& World::settings() const { return impl_->settings; }
void World::setSettings(const WorldSettings& settings) {
    if (const std::string wrong = whyInvalid(settings); !wrong.empty()) throw std::invalid_argument(wrong);
    const bool wake = settings.gravity != impl_->settings.gravity || !settings.sleeping;
    if (settings.solver != impl_->settings.solver) impl_->graphChanged = impl_->directChanged = true;
    impl_->directSeen.clear();
    impl_->settings = settings;
    if (!wake) return;
    for (std::uint32_t i = 1; i < impl_->bodySlots.count(); ++i)
        if (impl_->bodySlots.isUsed(i) && impl_->moves(i)) impl_->wakeBody(i);
}
void World::setCallbacks(WorldCallbacks callbacks) { impl_->callbacks = std::move(callbacks); }
int World::lanes() const { return impl_->graph.lanes(); }
void World::step(double dt) { impl_->step(*this, dt); }
std::uint64_t World::stepCount() const { return impl_->stepCount; }
double World::time() const { return impl_->time; }

StepStats World::stats() const {
    const WorldImpl& w = *impl_;
    StepStats stats;
    stats.stages = w.stages;
    stats.islands = w.ledger;
    stats.directFailures = w.directFailures;
    stats.outOfRange = w.outOfRange;
    stats.energyGuarded = w.energyGuard.caught;
    stats.energyTaken = w.energyGuard.taken;
    stats.jointsClosed = w.jointClosing.closed;
    stats.strayImpulses = w.moduleWork.strays;
    stats.solvedBodies = static_cast<int>(w.freezing.solved.size() - w.multirate.independentCount);
    stats.independentBodies = static_cast<int>(w.multirate.independentCount);
    stats.regions = w.regions.independent ? w.graph.regionCount() : 0;
    stats.totalMs = w.totalMs;
    stats.modulesMs = w.moduleWork.ms;
    stats.bodies = static_cast<int>(w.bodySlots.used()) - 1;
    stats.awakeBodies = static_cast<int>(w.awakeBodies.size());
    stats.contacts = static_cast<int>(w.contactSlots.used());
    stats.joints = static_cast<int>(w.jointSlots.used());
    stats.colors = w.graph.usedColors();
    for (const std::uint32_t c : w.awakeContacts) stats.touching += w.contacts[c].touching;
    stats.bytes = w.bodies.bytes() + w.states.bytes() + w.inertias.bytes() + w.dynamics.bytes() + w.histories.bytes() +
                  w.shapes.bytes() + w.contacts.bytes() + w.contactLinks.bytes() + w.manifolds.bytes() +
                  w.meshMemory.bytes() + w.joints.bytes() + w.jointSims.bytes() + w.jointBundles.bytes();
    for (int c = 0; c < w.graph.listCount(); ++c) stats.bytes += w.graph.color(c).bundles.bytes();
    return stats;
}

BodyId World::create(const BodyDef& def) { return impl_->id(impl_->createBody(def)); }
BodyId World::create(const StaticBody& def) {
    BodyDef body;
    body.type = BodyType::fixed;
    ShapeDef shape;
    shape.geometry = def.shape;
    shape.material = def.material;
    shape.filter = def.filter;
    body.shapes.push_back(std::move(shape));
    body.pose = {def.position, def.rotation};
    body.userData = def.userData;
    return create(body);
}
BodyId World::create(const DynamicBody& def) {
    BodyDef body;
    ShapeDef shape;
    shape.geometry = def.shape;
    shape.density = def.density;
    shape.material = def.material;
    shape.filter = def.filter;
    body.shapes.push_back(std::move(shape));
    body.pose = {def.position, def.rotation};
    body.linearVelocity = def.linearVelocity;
    body.angularVelocity = def.angularVelocity;
    body.userData = def.userData;
    return create(body);
}
CouplingId World::create(const CouplingDef& def) { return impl_->couplingId(impl_->createCoupling(def)); }
void World::destroy(CouplingId coupling) { impl_->destroyCoupling(impl_->index(coupling)); }
bool World::isValid(CouplingId id) const { return impl_->couplingSlots.isValid(id.index, id.generation); }
JointId World::create(const JointDef& def) { return impl_->jointId(impl_->createJoint(def)); }
void World::destroy(BodyId body) { impl_->destroyBody(impl_->index(body)); }
void World::destroy(JointId joint) { impl_->destroyJoint(impl_->index(joint)); }
bool World::isValid(BodyId id) const { return impl_->bodySlots.isValid(id.index, id.generation) && id.index != 0; }
bool World::isValid(ShapeId id) const { return impl_->shapeSlots.isValid(id.index, id.generation); }
bool World::isValid(JointId id) const { return impl_->jointSlots.isValid(id.index, id.generation); }

void World::apply(std::span<CommandBuffer* const> buffers) {
    std::exception_ptr first;
    for (CommandBuffer* buffer : inOrder(buffers))
        for (CommandBuffer::Command& command : buffer->commands_) try {
                using B = CommandBuffer;
                if (auto* c = std::get_if<B::CreateBody>(&command)) {
                    buffer->created_.emplace_back();
                    buffer->created_.back() = create(c->def);
                } else if (auto* j = std::get_if<B::CreateJoint>(&command)) {
                    buffer->createdJoints_.emplace_back();
                    buffer->createdJoints_.back() = create(j->def);
                } else if (auto* d = std::get_if<B::DestroyBody>(&command)) {
                    destroy(d->body);
                } else if (auto* dj = std::get_if<B::DestroyJoint>(&command)) {
                    destroy(dj->joint);
                } else if (auto* i = std::get_if<B::Impulse>(&command)) {
                    applyImpulse(i->body, i->impulse, i->point);
                } else if (auto* a = std::get_if<B::AngularImpulse>(&command)) {
                    applyAngularImpulse(a->body, a->impulse);
                } else if (auto* v = std::get_if<B::SetVelocity>(&command)) {
                    setVelocity(v->body, v->linear, v->angular);
                } else if (auto* p = std::get_if<B::SetPose>(&command)) {
                    setPose(p->body, p->pose);
                } else if (auto* w = std::get_if<B::Wake>(&command)) {
                    wake(w->body);
                }
            } catch (...) {
                if (!first) first = std::current_exception();
            }
    if (first) std::rethrow_exception(first);
}

std::uint64_t World::fixedVersion() const { return impl_->fixedVersion; }
void World::add(StepModule* module) { impl_->modules.push_back(module); }
void World::remove(StepModule* module) { std::erase(impl_->modules, module); }

}  // namespace ragtop
