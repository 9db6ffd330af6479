#include "ragtop/world.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ragtop/command_buffer.h"
#include "world/invariants.h"
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

Machine::Machine(const WorldConfig& config)
    : memory(orDefault(config.memory)),
      runner(config.tasks),
      workerChoice(runner.workers()),
      kernels(&selectKernels(checkedLanes(config.lanes))),
      jointKernels(&selectJointKernels(kernels->lanes)),
      stageMemory(memory) {}

WorldImpl::WorldImpl(const WorldSettings& worldSettings, const WorldConfig& config)
    : settings(worldSettings),
      machine(config),
      tables(machine),
      collision(machine),
      partition(machine.memory),
      events(machine.memory),
      moduleWork(machine.memory),
      solving(machine.memory),
      guards(machine.memory) {
    if (const std::string wrong = whyInvalid(settings); !wrong.empty()) throw std::invalid_argument(wrong);
    const auto expected = static_cast<std::size_t>(std::max(config.expectedBodies, 0)) + 1;
    tables.bodies.reserve(expected);
    tables.shapes.reserve(expected);
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
    if (settings.solver != impl_->settings.solver) impl_->partition.islands.structureChangedAt();
    impl_->partition.direct.seen.clear();
    impl_->settings = settings;
    if (!wake) return;
    for (std::uint32_t i = 1; i < impl_->tables.bodies.slots.count(); ++i)
        if (impl_->tables.bodies.slots.isUsed(i) && impl_->tables.bodies.moves(i)) impl_->activity().wakeBody(i);
}
void World::setCallbacks(WorldCallbacks callbacks) { impl_->callbacks = std::move(callbacks); }
int World::lanes() const { return impl_->tables.graph.lanes(); }
void World::step(double dt) { impl_->step(*this, dt); }
std::uint64_t World::stepCount() const { return impl_->clock.stepCount; }
double World::time() const { return impl_->clock.time; }

StepStats World::stats() const {
    const WorldImpl& w = *impl_;
    StepStats stats;
    stats.stages = w.reports.profile.stages();
    stats.islands = w.partition.direct.ledger;
    stats.directFailures = w.partition.direct.failures;
    stats.outOfRange = w.guards.outOfRange;
    stats.energyGuarded = w.guards.energy.caught;
    stats.energyTaken = w.guards.energy.taken;
    stats.jointsClosed = w.guards.closing.closed;
    stats.stepsCut = w.guards.closing.cut;
    stats.strayImpulses = w.moduleWork.strays;
    stats.solvedBodies =
        static_cast<int>(w.solving.freezing.solved.size() - w.partition.direct.multirate.independentCount);
    stats.independentBodies = static_cast<int>(w.partition.direct.multirate.independentCount);
    stats.regions = w.solving.regions.independent ? w.tables.graph.regionCount() : 0;
    stats.totalMs = w.reports.profile.totalMs();
    stats.modulesMs = w.moduleWork.ms;
    stats.bodies = static_cast<int>(w.tables.bodies.slots.used()) - 1;
    stats.awakeBodies = static_cast<int>(w.tables.bodies.awake.size());
    stats.contacts = static_cast<int>(w.tables.contacts.slots.used());
    stats.joints = static_cast<int>(w.tables.joints.slots.used());
    stats.colors = w.tables.graph.usedColors();
    for (const std::uint32_t c : w.tables.contacts.awake) stats.touching += w.tables.contacts[c].touching;
    stats.bytes = w.tables.bodies.bytes() + w.tables.shapes.bytes() + w.tables.contacts.bytes() +
                  w.tables.manifolds.bytes() + w.tables.joints.bytes();
    for (int c = 0; c < w.tables.graph.listCount(); ++c) stats.bytes += w.tables.graph.color(c).bundles.bytes();
    return stats;
}

BodyId World::create(const BodyDef& def) { return impl_->tables.bodies.id(impl_->scene().createBody(def)); }
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
CouplingId World::create(const CouplingDef& def) {
    return impl_->tables.couplings.id(impl_->scene().createCoupling(def));
}
void World::destroy(CouplingId coupling) { impl_->scene().destroyCoupling(indexOf(impl_->tables.couplings, coupling)); }
bool World::isValid(CouplingId id) const { return impl_->tables.couplings.slots.isValid(id.index, id.generation); }
JointId World::create(const JointDef& def) { return impl_->tables.joints.id(impl_->scene().createJoint(def)); }
void World::destroy(BodyId body) { impl_->scene().destroyBody(indexOf(impl_->tables.bodies, body)); }
void World::destroy(JointId joint) { impl_->scene().destroyJoint(indexOf(impl_->tables.joints, joint)); }
bool World::isValid(BodyId id) const {
    return impl_->tables.bodies.slots.isValid(id.index, id.generation) && id.index != 0;
}
bool World::isValid(ShapeId id) const { return impl_->tables.shapes.slots.isValid(id.index, id.generation); }
bool World::isValid(JointId id) const { return impl_->tables.joints.slots.isValid(id.index, id.generation); }

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

std::string World::validate() const { return firstBroken(impl_->tables, impl_->collision.broadphase); }

std::uint64_t World::fixedVersion() const { return impl_->tables.versions.fixed; }
void World::add(StepModule* module) { impl_->moduleWork.modules.push_back(module); }
void World::remove(StepModule* module) { std::erase(impl_->moduleWork.modules, module); }

}  // namespace ragtop
