#include "poses.h"

#include <fmt/format.h>

#include "ragtop/asset_error.h"

namespace ragtop::demos {

PosesFile::PosesFile(const std::filesystem::path& path) : out_(path) {
    if (!out_) throw AssetError(path.string() + ": cannot be written");
    out_ << "step,time_s,body,x_m,y_m,z_m,qx,qy,qz,qw\n";
}

void PosesFile::add(const World& world, bool last) {
    // Times of steps are sums of rounded numbers.
    constexpr double kRounding = 1e-9;
    if (!last && world.time() < next_ - kRounding) return;
    while (next_ <= world.time() + kRounding) next_ += 1;
    for (const BodyId body : world.bodies()) {
        const Pose pose = world.pose(body);
        const Quat& q = pose.rotation;
        out_ << fmt::format("{},{:.9g},{},{:.12g},{:.12g},{:.12g},{:.9g},{:.9g},{:.9g},{:.9g}\n", world.stepCount(),
                            world.time(), body.index, pose.position.x, pose.position.y, pose.position.z, q.x, q.y, q.z,
                            q.w);
    }
}

}  // namespace ragtop::demos
