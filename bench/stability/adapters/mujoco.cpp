#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "../scenery.h"
#include "mujoco_model.h"

namespace ragtop::stability {
namespace {

[[noreturn]] void fail(const char* message) { throw std::runtime_error(std::string("MuJoCo: ") + message); }
/// Warnings are counted in the data, for `complaint`.
void ignore(const char*) {}

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using Data = std::unique_ptr<mjData, decltype(&mj_deleteData)>;

Model load(const std::string& xml) {
    mju_user_error = fail;
    mju_user_warning = ignore;
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    if (mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(xml.size())) != 0) fail("no room for the model");
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    char error[1000] = "";
    Model model(mj_loadXML("scene.xml", files.get(), error, sizeof error), mj_deleteModel);
    mj_deleteVFS(files.get());
    if (!model) fail(error);
    return model;
}

/// MuJoCo 2.2 with default settings, but for elliptic cones; steps of about its default of 2 ms.
class MujocoEngine : public Engine {
public:
    explicit MujocoEngine(const Scene& scene)
        : peers_(scene), model_(load(mujocoModel(scene, peers_))), data_(mj_makeData(model_.get()), mj_deleteData) {
        for (int i = 0; i < peers_.count(); ++i) {
            ids_.push_back(mj_name2id(model_.get(), mjOBJ_BODY, ("b" + std::to_string(i)).c_str()));
            const BodyDef& def = peers_.def(i);
            if (def.type == BodyType::dynamic) setVelocity(i, def.linearVelocity, def.angularVelocity);
        }
    }

    void step(double dt) override {
        constexpr double kStep = 0.002;
        const int count = std::max(1, static_cast<int>(std::lround(dt / kStep)));
        model_->opt.timestep = dt / count;
        for (int i = 0; i < count; ++i) mj_step(model_.get(), data_.get());
        std::fill_n(data_->xfrc_applied, 6 * model_->nbody, 0.0);
    }
    BodyMotion motion(int i) const override {
        if (!moves(i)) return {peers_.def(i).pose, {}, {}};
        const mjtNum *x = data_->qpos + positionAt(i), *v = data_->qvel + velocityAt(i);
        const Pose pose{{x[0], x[1], x[2]}, {toFloat(x[4]), toFloat(x[5]), toFloat(x[6]), toFloat(x[3])}};
        // The angular velocity is in the axes of the body.
        const Vec3 w = rotate(pose.rotation, {toFloat(v[3]), toFloat(v[4]), toFloat(v[5])});
        return {peers_.ownPose(i, pose), {toFloat(v[0]), toFloat(v[1]), toFloat(v[2])}, w};
    }
    void setVelocity(int i, const Vec3& linear, const Vec3& angular) override {
        const mjtNum* x = data_->qpos + positionAt(i);
        const Quat q{toFloat(x[4]), toFloat(x[5]), toFloat(x[6]), toFloat(x[3])};
        const Vec3 w = inverseRotate(q, angular);
        mjtNum* v = data_->qvel + velocityAt(i);
        for (int k = 0; k < 3; ++k) {
            v[k] = static_cast<mjtNum>(linear[k]);
            v[3 + k] = static_cast<mjtNum>(w[k]);
        }
    }
    void push(int i, const Vec3& force, const DVec3& point) override {
        const mjtNum* x = data_->qpos + positionAt(i);
        const Vec3 moment = cross(relative(point, {x[0], x[1], x[2]}), force);
        mjtNum* applied = data_->xfrc_applied + 6 * ids_[static_cast<std::size_t>(i)];
        for (int k = 0; k < 3; ++k) {
            applied[k] += static_cast<mjtNum>(force[k]);
            applied[3 + k] += static_cast<mjtNum>(moment[k]);
        }
    }
    void remove(int) override { refuse("MuJoCo: taking bodies away"); }
    std::optional<double> normalForce(int a, int b) const override {
        double sum = 0;
        const int first = ids_[static_cast<std::size_t>(a)], second = ids_[static_cast<std::size_t>(b)];
        for (int i = 0; i < data_->ncon; ++i) {
            const mjContact& contact = data_->contact[i];
            const int p = model_->geom_bodyid[contact.geom1], q = model_->geom_bodyid[contact.geom2];
            if (!((p == first && q == second) || (p == second && q == first))) continue;
            mjtNum force[6];
            mj_contactForce(model_.get(), data_.get(), i, force);
            sum += force[0];
        }
        return sum;
    }

    /// Buffers that were full, matrices that were singular, and states out of all bounds, upon which MuJoCo puts
    /// everything back to where it began.
    std::string complaint() const override {
        constexpr int kOfPictures = mjWARN_VGEOMFULL;
        for (int i = 0; i < mjNWARNING; ++i)
            if (i != kOfPictures && data_->warning[i].number > 0) return mju_warningText(i, data_->warning[i].lastinfo);
        return {};
    }

private:
    static float toFloat(mjtNum a) { return static_cast<float>(a); }
    bool moves(int i) const { return peers_.def(i).type == BodyType::dynamic; }
    int joint(int i) const { return model_->body_jntadr[ids_[static_cast<std::size_t>(i)]]; }
    int positionAt(int i) const { return model_->jnt_qposadr[joint(i)]; }
    int velocityAt(int i) const { return model_->jnt_dofadr[joint(i)]; }

    PeerBodies peers_;
    Model model_;
    Data data_;
    std::vector<int> ids_;
};

}  // namespace

std::unique_ptr<Engine> makeMujoco(const Scene& scene) { return std::make_unique<MujocoEngine>(scene); }

}  // namespace ragtop::stability
