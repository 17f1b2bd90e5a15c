#include "cli/bench_mujoco.h"

#ifdef FRM_HAVE_MUJOCO

#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>

#include "cli/command.h"

namespace frm::cli {
namespace {

struct FreeModel {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
};

/// A free box, an ellipsoid to the fluid; in nothing if `density` is 0. (One alone: the cost of a geom grows with all
/// that moves in its scene, because its force goes through a Jacobian of that width.)
class Scene {
public:
    Scene(double density, double viscosity, const Vec3d& half_sizes = {0.04, 0.005, 0.15}) {
        const std::string xml = "<mujoco><option gravity='0 0 0' density='" + std::to_string(density) +
                                "' viscosity='" + std::to_string(viscosity) +
                                "'/><worldbody><body><freejoint/><geom type='box' size='" +
                                std::to_string(half_sizes.x) + " " + std::to_string(half_sizes.y) + " " +
                                std::to_string(half_sizes.z) + "' fluidshape='ellipsoid'/></body></worldbody></mujoco>";
        const auto files = std::make_unique<mjVFS>();
        mj_defaultVFS(files.get());
        mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(xml.size()));
        std::memcpy(files->filedata[mj_findFileVFS(files.get(), "scene.xml")], xml.data(), xml.size());
        char error[256] = "";
        model_.reset(mj_loadXML("scene.xml", files.get(), error, sizeof error));
        mj_deleteVFS(files.get());
        if (!model_) throw Failure(std::string("MuJoCo: ") + error);
        data_.reset(mj_makeData(model_.get()));
        mj_forward(model_.get(), data_.get());
    }

    void move(double x, double y, double z, double spin) {
        const mjtNum v[6] = {x, y, z, spin, 0.5 * spin, 0.25 * spin};
        std::copy(v, v + 6, data_->qvel);
        mj_fwdVelocity(model_.get(), data_.get());
    }

    void move(const frm_pose& pose, const frm_twist& twist) {
        const frm_quaternion& q = pose.rotation;
        const mjtNum quat[4] = {static_cast<mjtNum>(q.w), static_cast<mjtNum>(q.x), static_cast<mjtNum>(q.y),
                                static_cast<mjtNum>(q.z)};
        std::copy(quat, quat + 4, data_->qpos + 3);
        // A free joint turns about the body's axes, and moves along the world's.
        mjtNum inverse[4], spin[3] = {static_cast<mjtNum>(twist.angular.x), static_cast<mjtNum>(twist.angular.y),
                                      static_cast<mjtNum>(twist.angular.z)};
        mju_negQuat(inverse, quat);
        mju_rotVecQuat(data_->qvel + 3, spin, inverse);
        data_->qvel[0] = static_cast<mjtNum>(twist.linear.x);
        data_->qvel[1] = static_cast<mjtNum>(twist.linear.y);
        data_->qvel[2] = static_cast<mjtNum>(twist.linear.z);
        mj_fwdPosition(model_.get(), data_.get());
        mj_fwdVelocity(model_.get(), data_.get());
    }

    Reading reading() const {
        const mjtNum* f = data_->qfrc_passive;
        mjtNum torque[3];
        mju_rotVecQuat(torque, f + 3, data_->qpos + 3);
        return {{f[0], f[1], f[2]}, {torque[0], torque[1], torque[2]}};
    }

    /// Of one call of mj_passive, ns: the least of many, in which nothing else ran.
    double passive_ns(double seconds) {
        using clock = std::chrono::steady_clock;
        const auto begin = clock::now();
        constexpr int calls = 1000;
        double least = 1e300;
        while (std::chrono::duration<double>(clock::now() - begin).count() < seconds) {
            const auto start = clock::now();
            for (int n = 0; n < calls; ++n) mj_passive(model_.get(), data_.get());
            least = std::min(least, std::chrono::duration<double, std::nano>(clock::now() - start).count() / calls);
        }
        return least;
    }

    double force_y() const { return data_->qfrc_passive[1]; }

private:
    std::unique_ptr<mjModel, FreeModel> model_;
    std::unique_ptr<mjData, FreeModel> data_;
};

}  // namespace

std::optional<MujocoFluid> measure_mujoco(double seconds) {
    Scene water(1000, 0.001), nothing(0, 0);
    MujocoFluid out;
    water.move(0, 0.25, 0, 0);
    out.plate_drag = std::fabs(water.force_y()) / (0.5 * 1000 * 0.25 * 0.25 * 0.08 * 0.3);
    water.move(0.3, 0.25, 0.1, 0.5);
    nothing.move(0.3, 0.25, 0.1, 0.5);
    out.nanoseconds = water.passive_ns(0.5 * seconds) - nothing.passive_ns(0.5 * seconds);
    return out;
}

std::optional<MujocoMotion> move_mujoco(const Vec3d& half_sizes,
                                        const std::vector<std::pair<frm_pose, frm_twist>>& motion, double density,
                                        double viscosity, double seconds) {
    // MuJoCo's viscosity is the dynamic one.
    Scene water(density, density * viscosity, half_sizes), nothing(0, 0, half_sizes);
    MujocoMotion out;
    for (const auto& [pose, twist] : motion) {
        water.move(pose, twist);
        out.readings.push_back(water.reading());
    }
    const auto& [pose, twist] = motion[motion.size() / 2];
    water.move(pose, twist);
    nothing.move(pose, twist);
    out.nanoseconds = water.passive_ns(0.5 * seconds) - nothing.passive_ns(0.5 * seconds);
    return out;
}

}  // namespace frm::cli

#else

namespace frm::cli {
std::optional<MujocoFluid> measure_mujoco(double) { return std::nullopt; }
std::optional<MujocoMotion> move_mujoco(const Vec3d&, const std::vector<std::pair<frm_pose, frm_twist>>&, double,
                                        double, double) {
    return std::nullopt;
}
}  // namespace frm::cli

#endif
