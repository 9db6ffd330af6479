#include "ragtop/cloth.h"

#include <cmath>
#include <memory_resource>
#include <stdexcept>

#include "cloth/cloth_sim.h"

namespace ragtop {
namespace {

const ClothDef& checked(const ClothDef& def) {
    if (const std::string why = whyInvalid(def); !why.empty()) throw std::invalid_argument("cloth: " + why);
    return def;
}

void requirePose(const Pose& pose) {
    const Quat& q = pose.rotation;
    const float squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if (isFinite(pose.position) && std::abs(squared - 1) < 2e-3f) return;
    throw std::invalid_argument("cloth: a pose has a position that is not finite or a rotation that is no unit quaternion");
}

std::size_t checkedIndex(const ClothSim& sim, int i) {
    if (i >= 0 && i < sim.count) return cloth::index(i);
    throw std::out_of_range("cloth: point " + std::to_string(i) + " is none of " + std::to_string(sim.count));
}

}  // namespace

ClothSim::ClothSim(World& inWorld, const ClothDef& inDef, const Pose& pose)
    : world(&inWorld), def(checked(inDef)), fabric(std::pmr::get_default_resource()),
      state(std::pmr::get_default_resource()), around(std::pmr::get_default_resource()) {
    requirePose(pose);
    cloth::build(*this, pose);
    cloth::moveHeld(*this);
    cloth::findBlocks(*this);
    module = cloth::moduleOf(*this);
    world->add(&module);
}

ClothSim::~ClothSim() { world->remove(&module); }

Cloth::Cloth(World& world, const ClothDef& def, const Pose& pose) : sim_(std::make_unique<ClothSim>(world, def, pose)) {}
Cloth::~Cloth() = default;
Cloth::Cloth(Cloth&&) noexcept = default;

const ClothDef& Cloth::def() const { return sim_->def; }
int Cloth::pointCount() const { return sim_->count; }
DVec3 Cloth::point(int index) const { return sim_->state.origin + sim_->state.points[checkedIndex(*sim_, index)].place; }
Vec3 Cloth::velocity(int index) const { return sim_->state.velocities[checkedIndex(*sim_, index)].v; }
float Cloth::mass(int index) const { return sim_->fabric.masses[checkedIndex(*sim_, index)]; }
Vec3 Cloth::wind() const { return sim_->state.wind; }
bool Cloth::isAwake() const { return sim_->state.awake; }
int Cloth::contactCount() const { return static_cast<int>(sim_->around.contacts.size()); }

void Cloth::readPoints(std::span<DVec3> points) const {
    if (points.size() != cloth::index(sim_->count)) {
        throw std::length_error("cloth: " + std::to_string(points.size()) + " places for " + std::to_string(sim_->count) +
                                " points");
    }
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = sim_->state.origin + sim_->state.points[i].place;
}

void Cloth::push(const Vec3& velocity) {
    for (std::size_t i = 0; i < cloth::index(sim_->count); ++i)
        if (sim_->fabric.heldOfPoint[i] == cloth::kNoPoint) sim_->state.velocities[i].v += velocity;
    cloth::findBlocks(*sim_);
    wake();
}

void Cloth::setWind(const Vec3& wind) {
    if (!isFinite(wind)) throw std::invalid_argument("cloth: wind is not finite, must be");
    if (wind == sim_->state.wind) return;
    sim_->state.wind = wind;
    wake();
}

void Cloth::wake() {
    sim_->state.awake = true;
    sim_->state.quiet = 0;
}

void Cloth::follow(std::span<const DVec3> places, std::span<const Vec3> normals) {
    cloth::State& state = sim_->state;
    const std::size_t count = sim_->def.skin.size();
    if (count == 0) throw std::invalid_argument("cloth: has no skin to follow with");
    if (places.size() != count || normals.size() != count) {
        throw std::invalid_argument("cloth: " + std::to_string(places.size()) + " places and " +
                                    std::to_string(normals.size()) + " normals for " + std::to_string(count) + " points");
    }
    for (std::size_t i = 0; i < count; ++i)
        if (!isFinite(places[i]) || !isFinite(normals[i]))
            throw std::invalid_argument("cloth: place or normal " + std::to_string(i) + " is not finite, must be");
    state.skinTo.assign(places.begin(), places.end());
    state.skinNormals.assign(normals.begin(), normals.end());
    if (!state.follows) state.skinFrom = state.skinTo;
    state.follows = true;
    wake();
}

void Cloth::teleport(const Pose& from, const Pose& to) {
    requirePose(from);
    requirePose(to);
    cloth::State& state = sim_->state;
    const Quat turn = to.rotation * conjugate(from.rotation);
    const auto moved = [&](const DVec3& place) {
        return to.position + rotate(to.rotation, inverseTransformPoint(from, place));
    };
    const DVec3 origin = state.origin, next = moved(origin);
    state.origin = {std::round(next.x), std::round(next.y), std::round(next.z)};
    for (std::size_t i = 0; i < cloth::index(sim_->count); ++i) {
        state.points[i].place = cloth::placeFrom(moved(origin + state.points[i].place), state.origin);
        state.velocities[i].v = rotate(turn, state.velocities[i].v);
    }
    for (cloth::HeldPoint& held : state.held) held.fixed = moved(held.fixed);
    for (auto* list : {&state.skinFrom, &state.skinTo})
        for (DVec3& place : *list) place = moved(place);
    for (Vec3& normal : state.skinNormals) normal = rotate(turn, normal);
    cloth::moveHeld(*sim_);
    cloth::findBlocks(*sim_);
    wake();
}

}  // namespace ragtop
