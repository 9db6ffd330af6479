#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numeric>
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

/// MuJoCo 2.2 with default settings, but for elliptic cones unless pyramids are asked for.
class MujocoEngine : public Engine {
public:
    MujocoEngine(const Scene& scene, const MujocoOptions& options)
        : peers_(scene),
          model_(load(mujocoModel(scene, peers_, options))),
          data_(mj_makeData(model_.get()), mj_deleteData),
          substeps_(options.substeps) {
        for (int i = 0; i < peers_.count(); ++i)
            ids_.push_back(mj_name2id(model_.get(), mjOBJ_BODY, ("b" + std::to_string(i)).c_str()));
        update();
        // MuJoCo numbers bodies with those first on which others hang.
        std::vector<int> order(ids_.size());
        std::iota(order.begin(), order.end(), 0);
        std::ranges::sort(order, {}, [this](int i) { return id(i); });
        for (const int i : order)
            if (moves(i)) setVelocity(i, peers_.def(i).linearVelocity, peers_.def(i).angularVelocity);
    }

    void step(double dt) override {
        constexpr double kStep = 0.002;
        const int count = substeps_ > 0 ? substeps_ : std::max(1, static_cast<int>(std::lround(dt / kStep)));
        work_ = {};
        model_->opt.timestep = dt / count;
        for (int i = 0; i < count; ++i) {
            mj_step(model_.get(), data_.get());
            work_.passes += data_->solver_iter;
        }
        work_.contacts = data_->ncon;
        std::fill_n(data_->xfrc_applied, 6 * model_->nbody, 0.0);
        update();
    }
    BodyMotion motion(int i) const override {
        if (!moves(i)) return {peers_.def(i).pose, {}, {}};
        mjtNum v[6];
        mj_objectVelocity(model_.get(), data_.get(), mjOBJ_BODY, id(i), v, 0);
        return {peers_.ownPose(i, pose(i)), toVec(v + 3), toVec(v)};
    }
    /// Of a body that hangs on another one only what its joint lets it have.
    void setVelocity(int i, const Vec3& linear, const Vec3& angular) override {
        const int joint = model_->body_jntadr[id(i)];
        mjtNum* v = data_->qvel + model_->jnt_dofadr[joint];
        mjtNum parent[6];
        mj_objectVelocity(model_.get(), data_.get(), mjOBJ_BODY, model_->body_parentid[id(i)], parent, 0);
        const Vec3 turning = angular - toVec(parent), own = inverseRotate(pose(i).rotation, turning);
        switch (model_->jnt_type[joint]) {
            case mjJNT_FREE:
                set(v, linear);
                set(v + 3, own);
                break;
            case mjJNT_BALL:
                set(v, own);
                break;
            default:
                v[0] = static_cast<mjtNum>(dot(turning, toVec(data_->xaxis + 3 * joint)));
        }
        update();
    }
    void push(int i, const Vec3& force, const DVec3& point) override {
        const mjtNum* x = data_->xpos + 3 * id(i);
        const Vec3 moment = cross(relative(point, {x[0], x[1], x[2]}), force);
        mjtNum* applied = data_->xfrc_applied + 6 * id(i);
        for (int k = 0; k < 3; ++k) {
            applied[k] += static_cast<mjtNum>(force[k]);
            applied[3 + k] += static_cast<mjtNum>(moment[k]);
        }
    }
    void remove(int) override { refuse("MuJoCo: taking bodies away"); }
    double normalForce(int a, int b) const override {
        double sum = 0;
        const int first = id(a), second = id(b);
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

    StepWork work() const override { return work_; }
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
    static Vec3 toVec(const mjtNum* v) { return {toFloat(v[0]), toFloat(v[1]), toFloat(v[2])}; }
    static void set(mjtNum* to, const Vec3& from) {
        for (int k = 0; k < 3; ++k) to[k] = static_cast<mjtNum>(from[k]);
    }
    bool moves(int i) const { return peers_.def(i).type == BodyType::dynamic; }
    int id(int i) const { return ids_[static_cast<std::size_t>(i)]; }
    Pose pose(int i) const {
        const mjtNum *x = data_->xpos + 3 * id(i), *q = data_->xquat + 4 * id(i);
        return {{x[0], x[1], x[2]}, {toFloat(q[1]), toFloat(q[2]), toFloat(q[3]), toFloat(q[0])}};
    }
    /// Poses and velocities of bodies are of where a step began until they are found anew.
    void update() {
        mj_kinematics(model_.get(), data_.get());
        mj_comPos(model_.get(), data_.get());
        mj_comVel(model_.get(), data_.get());
    }

    PeerBodies peers_;
    Model model_;
    Data data_;
    int substeps_;
    StepWork work_;
    std::vector<int> ids_;
};

}  // namespace

std::unique_ptr<Engine> makeMujoco(const Scene& scene, const MujocoOptions& options) {
    return std::make_unique<MujocoEngine>(scene, options);
}
std::string mujocoVersion() { return mj_versionString(); }

}  // namespace ragtop::stability
