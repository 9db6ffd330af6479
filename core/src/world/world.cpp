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
      bodies(memory),
      shapes(memory),
      contacts(memory),
      manifolds(runner.workers(), memory),
      joints(jointKernels->lanes, memory),
      couplings(memory),
      graph(kernels->lanes, memory),
      stageMemory(memory),
      broadphase(memory, stageMemory),
      islands(memory),
      events(memory),
      directSet(memory),
      moduleWork(memory),
      regions(memory),
      freezing(memory),
      articulations(memory),
      energyGuard(memory),
      jointClosing(memory),
      contactFinds(memory),
      sweptBodies(memory),
      profile(memory) {
    if (const std::string wrong = whyInvalid(settings); !wrong.empty()) throw std::invalid_argument(wrong);
    const auto expected = static_cast<std::size_t>(std::max(config.expectedBodies, 0)) + 1;
    bodies.reserve(expected);
    shapes.reserve(expected);
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
    if (settings.solver != impl_->settings.solver) impl_->islands.graphChanged = impl_->islands.directChanged = true;
    impl_->directSet.seen.clear();
    impl_->settings = settings;
    if (!wake) return;
    for (std::uint32_t i = 1; i < impl_->bodies.slots.count(); ++i)
        if (impl_->bodies.slots.isUsed(i) && impl_->bodies.moves(i)) impl_->activity().wakeBody(i);
}
void World::setCallbacks(WorldCallbacks callbacks) { impl_->callbacks = std::move(callbacks); }
int World::lanes() const { return impl_->graph.lanes(); }
void World::step(double dt) { impl_->step(*this, dt); }
std::uint64_t World::stepCount() const { return impl_->stepCount; }
double World::time() const { return impl_->time; }

StepStats World::stats() const {
    const WorldImpl& w = *impl_;
    StepStats stats;
    stats.stages = w.profile.stages();
    stats.islands = w.directSet.ledger;
    stats.directFailures = w.directSet.failures;
    stats.outOfRange = w.outOfRange;
    stats.energyGuarded = w.energyGuard.caught;
    stats.energyTaken = w.energyGuard.taken;
    stats.jointsClosed = w.jointClosing.closed;
    stats.stepsCut = w.jointClosing.cut;
    stats.strayImpulses = w.moduleWork.strays;
    stats.solvedBodies = static_cast<int>(w.freezing.solved.size() - w.directSet.multirate.independentCount);
    stats.independentBodies = static_cast<int>(w.directSet.multirate.independentCount);
    stats.regions = w.regions.independent ? w.graph.regionCount() : 0;
    stats.totalMs = w.profile.totalMs();
    stats.modulesMs = w.moduleWork.ms;
    stats.bodies = static_cast<int>(w.bodies.slots.used()) - 1;
    stats.awakeBodies = static_cast<int>(w.bodies.awake.size());
    stats.contacts = static_cast<int>(w.contacts.slots.used());
    stats.joints = static_cast<int>(w.joints.slots.used());
    stats.colors = w.graph.usedColors();
    for (const std::uint32_t c : w.contacts.awake) stats.touching += w.contacts[c].touching;
    stats.bytes = w.bodies.bytes() + w.shapes.bytes() + w.contacts.bytes() + w.manifolds.bytes() + w.joints.bytes();
    for (int c = 0; c < w.graph.listCount(); ++c) stats.bytes += w.graph.color(c).bundles.bytes();
    return stats;
}

BodyId World::create(const BodyDef& def) { return impl_->bodies.id(impl_->scene().createBody(def)); }
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
CouplingId World::create(const CouplingDef& def) { return impl_->couplings.id(impl_->scene().createCoupling(def)); }
void World::destroy(CouplingId coupling) { impl_->scene().destroyCoupling(indexOf(impl_->couplings, coupling)); }
bool World::isValid(CouplingId id) const { return impl_->couplings.slots.isValid(id.index, id.generation); }
JointId World::create(const JointDef& def) { return impl_->joints.id(impl_->scene().createJoint(def)); }
void World::destroy(BodyId body) { impl_->scene().destroyBody(indexOf(impl_->bodies, body)); }
void World::destroy(JointId joint) { impl_->scene().destroyJoint(indexOf(impl_->joints, joint)); }
bool World::isValid(BodyId id) const { return impl_->bodies.slots.isValid(id.index, id.generation) && id.index != 0; }
bool World::isValid(ShapeId id) const { return impl_->shapes.slots.isValid(id.index, id.generation); }
bool World::isValid(JointId id) const { return impl_->joints.slots.isValid(id.index, id.generation); }

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

std::uint64_t World::fixedVersion() const { return impl_->versions.fixed; }
void World::add(StepModule* module) { impl_->moduleWork.modules.push_back(module); }
void World::remove(StepModule* module) { std::erase(impl_->moduleWork.modules, module); }

}  // namespace ragtop
