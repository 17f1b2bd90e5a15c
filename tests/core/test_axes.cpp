#include "core/api/axes.h"
#include "tests/support/catch.h"

using namespace frm;
using frm::api::Axes;

namespace {

struct Host {
    std::uint32_t axes;
    frm_vec3 up;       ///< the host's up
    frm_vec3 mesh_up;  ///< the mesh's y axis (glTF's up) in the host's body axes
};

const Host hosts[] = {{FRM_AXES_Y_UP_RIGHT, {0, 1, 0}, {0, 1, 0}},
                      {FRM_AXES_Y_UP_LEFT, {0, 1, 0}, {0, 1, 0}},
                      {FRM_AXES_Z_UP_LEFT, {0, 0, 1}, {0, 0, 1}}};

}  // namespace

TEST_CASE("up is up in every host's axes", "[axes]") {
    for (const Host& host : hosts) {
        const Axes axes(host.axes);
        const Vec3f up = axes.vector_in(host.up);
        CHECK(up.z == 1);
        CHECK(axes.position_in({host.up.x * 2.0, host.up.y * 2.0, host.up.z * 2.0}).z == 2);
    }
}

TEST_CASE("a mesh that stands upright unrotated in its host stands upright here", "[axes]") {
    for (const Host& host : hosts) {
        const Axes axes(host.axes);
        const Pose pose = axes.pose_in({{0, 0, 0}, {0, 0, 0, 1}}, "pose");
        const Vec3f world = Rotation<float>(pose.rotation).to_world(axes.body_in(host.mesh_up));
        CHECK(world.z == Approx(1));
        // And the mesh's own up (glTF: y) is what that is in the body's frame.
        CHECK(axes.body_in(host.mesh_up).y == 1);
    }
}

TEST_CASE("poses, twists and wrenches go in and out unchanged", "[axes]") {
    for (std::uint32_t a = 0; a < 4; ++a) {
        const Axes axes(a);
        const frm_pose pose{{1, -2, 3}, {0.1f, -0.5f, 0.3f, 0.806226f}};
        const frm_pose back = axes.pose_out(axes.pose_in(pose, "pose"));
        CHECK(back.position.x == 1);
        CHECK(back.position.y == -2);
        CHECK(back.position.z == 3);
        const float sign = back.rotation.w < 0 ? -1.0f : 1.0f;
        CHECK(sign * back.rotation.x == Approx(0.1).margin(1e-6));
        CHECK(sign * back.rotation.y == Approx(-0.5).margin(1e-6));
        CHECK(sign * back.rotation.z == Approx(0.3).margin(1e-6));
        const frm_twist twist = axes.twist_out(axes.twist_in({{1, 2, 3}, {4, 5, 6}}, "twist"));
        CHECK(twist.linear.y == 2);
        CHECK(twist.angular.z == 6);
        const frm_wrench wrench = axes.wrench_out(axes.wrench_in({{1, 2, 3}, {4, 5, 6}}));
        CHECK(wrench.force.x == 1);
        CHECK(wrench.torque.x == 4);
    }
}

// A point of the body, seen from the host: rotated by the host's own quaternion in the host's own axes (left-handed
// ones turn the other way round, by the same formula), it must land where the library's rotation puts it.
TEST_CASE("a rotation in the host's axes moves points as the host sees it", "[axes]") {
    const frm_quaternion q{0.2f, 0.4f, -0.1f, 0.888819f};
    const Rotation<float> host_rotation(Quat<float>{q.x, q.y, q.z, q.w});
    for (std::uint32_t a = 0; a < 4; ++a) {
        const Axes axes(a);
        const Pose pose = axes.pose_in({{0, 0, 0}, q}, "pose");
        const frm_vec3 point{0.3f, -0.7f, 0.2f};
        const Vec3f in_host = host_rotation.to_world({point.x, point.y, point.z});
        const Vec3f expected = axes.vector_in({in_host.x, in_host.y, in_host.z});
        const Vec3f here = Rotation<float>(pose.rotation).to_world(axes.body_in(point));
        CHECK(length(expected - here) < 1e-6f);
    }
}

// v = w x r must hold in the library's axes for what it was in the host's; a left-handed host's cross product is
// mirrored.
TEST_CASE("angular velocity keeps its sense", "[axes]") {
    for (std::uint32_t a = 0; a < 4; ++a) {
        const Axes axes(a);
        const Vec3f w(0.3f, -0.2f, 0.9f), r(1, 2, -0.5f);
        const Vec3f v =
            cross(w, r);  // by the same formula in every host: left-handed axes have a left-handed cross product
        const Vec3f here = cross(axes.axial_in({w.x, w.y, w.z}), axes.vector_in({r.x, r.y, r.z}));
        const Vec3f expected = axes.vector_in({v.x, v.y, v.z});
        CHECK(length(here - expected) < 1e-6f);
    }
}
