#include "ragtop/recording.h"

#include <algorithm>
#include <limits>

#include "gltf_writer.h"
#include "ragtop/world.h"
#include "recording_tracks.h"

namespace ragtop {

struct Recording::Impl {
    const World* world;
    RecordingOptions options;
    RecordedScene scene;
    std::vector<std::size_t> trackOfIndex;  ///< by BodyId::index; kNone: not seen
    std::int64_t captures = 0;
    double startTime = 0;

    static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

    RecordedBody& track(BodyId id);
    void add(BodyId id, int frame);
    void storeFrame();
    void storePose(RecordedBody& body, int frame) const;
};

void Recording::Impl::add(BodyId id, int frame) {
    RecordedBody body;
    body.id = id;
    body.type = world->type(id);
    body.firstFrame = frame;
    for (const ShapeId shape : world->shapes(id)) {
        if (!world->givesWay(shape)) body.parts.push_back({world->geometry(shape), world->frame(shape)});
    }
    if (id.index >= trackOfIndex.size()) trackOfIndex.resize(std::size_t{id.index} + 1, kNone);
    trackOfIndex[id.index] = scene.bodies.size();
    scene.bodies.push_back(std::move(body));
}

RecordedBody& Recording::Impl::track(BodyId id) {
    const auto known = [&] {
        return id.index < trackOfIndex.size() && trackOfIndex[id.index] != kNone &&
               scene.bodies[trackOfIndex[id.index]].id == id;
    };
    if (!known()) {
        add(id, static_cast<int>(scene.times.size()) - 1);
        storePose(scene.bodies.back(), scene.bodies.back().firstFrame);
    }
    return scene.bodies[trackOfIndex[id.index]];
}

void Recording::Impl::storePose(RecordedBody& body, int frame) const {
    const Pose pose = world->pose(body.id);
    RecordedKey key{frame, relative(pose.position, options.origin), pose.rotation};
    if (body.keys.empty()) {
        body.keys.push_back(key);
        return;
    }
    const RecordedKey last = body.keys.back();
    // q and −q are the same rotation, but blending towards the far one would spin the body.
    const Quat& p = last.rotation;
    Quat& q = key.rotation;
    if (p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w < 0) q = {-q.x, -q.y, -q.z, -q.w};
    if (key.position == last.position && key.rotation == last.rotation) return;
    if (last.frame < frame - 1) body.keys.push_back({frame - 1, last.position, last.rotation});
    body.keys.push_back(key);
}

void Recording::Impl::storeFrame() {
    const int frame = static_cast<int>(scene.times.size());
    scene.times.push_back(world->time() - startTime);
    for (const BodyId id : world->bodies()) storePose(track(id), frame);
    for (RecordedBody& body : scene.bodies) {
        if (body.goneFrame > frame && !world->isValid(body.id)) body.goneFrame = frame;
    }
}

Recording::Recording(const World& world, const RecordingOptions& options)
    : impl_(std::make_unique<Impl>(Impl{&world, options, {}, {}, 0, world.time()})) {
    impl_->options.every = std::max(options.every, 1);
    impl_->storeFrame();
}
Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;

void Recording::name(BodyId body, std::string name) { impl_->track(body).name = std::move(name); }
void Recording::paint(BodyId body, Color color) { impl_->track(body).color = color; }

void Recording::capture() {
    if (++impl_->captures % impl_->options.every == 0) impl_->storeFrame();
}

int Recording::frames() const { return static_cast<int>(impl_->scene.times.size()); }

void Recording::write(const std::filesystem::path& path) const { writeGltf(impl_->scene, path); }

}  // namespace ragtop
