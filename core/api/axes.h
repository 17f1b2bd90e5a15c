// The host's axes and ours (right-handed, z up). The world's axes are permuted (matrix C); a body's own axes are the
// mesh file's, which some hosts' importers mirror (matrix D, host to mesh). A rotation then is R = C R_host D^-1.
#pragma once

#include <array>

#include "core/body/body.h"
#include "frm.h"

namespace frm::api {

class Axes {
public:
    explicit Axes(std::uint32_t axes);

    std::uint32_t host() const { return axes_; }

    Vec3f vector_in(const frm_vec3& v) const { return permute_in(Vec3f(v.x, v.y, v.z)); }
    frm_vec3 vector_out(const Vec3f& v) const { return plain(permute_out(v)); }
    /// Axial: angular velocity and torque change sign where the handedness changes.
    Vec3f axial_in(const frm_vec3& v) const { return vector_in(v) * hand_; }
    frm_vec3 axial_out(const Vec3f& v) const { return vector_out(v * hand_); }

    Vec3d position_in(const frm_position& p) const { return permute_in(Vec3d(p.x, p.y, p.z)); }
    frm_position position_out(const Vec3d& p) const {
        const Vec3d q = permute_out(p);
        return {q.x, q.y, q.z};
    }
    /// Throws Error for a pose or twist that is not finite or out of range; `what` names it.
    Pose pose_in(const frm_pose& pose, const char* what) const;
    Twist twist_in(const frm_twist& twist, const char* what) const;
    frm_pose pose_out(const Pose& pose) const;
    frm_twist twist_out(const Twist& t) const { return {vector_out(t.linear), axial_out(t.angular)}; }
    frm_wrench wrench_out(const Wrench& w) const { return {vector_out(w.force), axial_out(w.torque)}; }
    /// A matrix that gives a wrench for a twist, row after row, in the world's axes.
    std::array<double, 36> matrix_out(const std::array<double, 36>& m) const;
    Wrench wrench_in(const frm_wrench& w) const { return {vector_in(w.force), axial_in(w.torque)}; }

    /// A vector in the body's frame.
    Vec3f body_in(const frm_vec3& v) const { return mirror(Vec3f(v.x, v.y, v.z)); }
    frm_vec3 body_out(const Vec3f& v) const { return plain(mirror(v)); }
    /// An axial one: a torque or an angular velocity.
    frm_vec3 body_axial_out(const Vec3f& v) const { return plain(mirror(v) * hand_); }

private:
    static frm_vec3 plain(const Vec3f& v) { return {v.x, v.y, v.z}; }

    template <typename T>
    Vec3<T> permute_in(const Vec3<T>& v) const {
        return {v[from_[0]], v[from_[1]], v[from_[2]]};
    }
    template <typename T>
    Vec3<T> permute_out(const Vec3<T>& v) const {
        Vec3<T> out;
        for (int i = 0; i < 3; ++i) out[from_[i]] = v[i];
        return out;
    }
    /// D is its own inverse for every host.
    Vec3f mirror(const Vec3f& v) const;

    std::uint32_t axes_;
    int from_[3] = {0, 1, 2};   ///< our axis i is the host's axis from_[i]
    float hand_ = 1;            ///< determinant of C (and of D)
    Quat<float> world_, body_;  ///< the rotations hand * C and hand * D
};

}  // namespace frm::api
