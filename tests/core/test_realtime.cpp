// What the header tags [realtime] takes no lock and calls no system: every lock of this program is counted, and a process
// that may not call the system ticks on. (That it allocates nothing: test_allocation.cpp.)
#include <linux/seccomp.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>

#include "tests/support/library.h"
#include "tests/support/locks.h"

using frm::test::locks_here;

namespace {

/// A body that goes in and out of the water, turning, and one that stays in it.
class Scene {
public:
    explicit Scene(bool recorded = false) {
        REQUIRE(frm_world_create(library_.context, nullptr, &world_) == FRM_OK);
        frm_water water = 0;
        frm_water_def water_def;
        REQUIRE(frm_water_def_init(&water_def, sizeof water_def) == FRM_OK);
        water_def.nx = water_def.ny = 100;
        REQUIRE(frm_water_create(world_, &water_def, &water) == FRM_OK);
        frm_body_def def;
        REQUIRE(frm_body_def_init(&def, sizeof def) == FRM_OK);
        def.map = library_.map();
        def.mass = 1;
        for (frm_body& body : bodies_) REQUIRE(frm_body_create(world_, &def, &body) == FRM_OK);
        REQUIRE(frm_device_open_null(library_.context, &device_) == FRM_OK);
        if (!recorded) return;
        frm_recorder recorder = 0;
        REQUIRE(frm_recorder_create(world_, folder_.file("r.frmrec").c_str(), nullptr, &recorder) == FRM_OK);
        REQUIRE(frm_recorder_add_device(recorder, device_) == FRM_OK);
    }

    /// False if a call failed.
    bool tick() {
        const double phase = 0.02 * ++ticks_;
        frm_device_state state{};
        state.struct_size = sizeof state;
        if (frm_device_exchange(device_, nullptr, &state)) return false;
        for (std::size_t i = 0; i < 2; ++i) {
            const frm_pose pose{
                {0.5 * std::sin(phase), 0.3 * static_cast<double>(i), i ? -0.05 : 0.5 * std::cos(phase)},
                {static_cast<float>(std::sin(phase)), 0, 0, static_cast<float>(std::cos(phase))}};
            const frm_twist twist{{1, 0, -1}, {2, 0, 0}};
            if (frm_body_set_motion(bodies_[i], &pose, &twist)) return false;
        }
        frm_forces forces{};
        forces.struct_size = sizeof forces;
        frm_world_stats stats{};
        stats.struct_size = sizeof stats;
        return !frm_world_tick(world_, 0.002f) && !frm_body_get_forces(bodies_[0], &forces) &&
               !frm_world_get_stats(world_, &stats);
    }

private:
    frm::test::Folder folder_;
    frm::test::Library library_;
    frm_device device_ = 0;
    frm_world world_ = 0;
    frm_body bodies_[2] = {};
    int ticks_ = 0;
};

}  // namespace

TEST_CASE("a tick takes no lock, recorded or not", "[realtime]") {
    for (const bool recorded : {false, true}) {
        Scene scene(recorded);
        REQUIRE(scene.tick());
        pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
        const std::size_t before = locks_here();
        pthread_mutex_lock(&mutex);  // the counter counts
        pthread_mutex_unlock(&mutex);
        REQUIRE(locks_here() == before + 1);
        for (int t = 0; t < 500; ++t) REQUIRE(scene.tick());
        CHECK(locks_here() == before + 1);
    }
}

#ifndef __SANITIZE_THREAD__  // a thread of that sanitizer lives on in the child that the kernel has killed
TEST_CASE("a tick calls no system, recorded or not", "[realtime]") {
    for (const bool recorded : {false, true}) {
        Scene scene(recorded);
        for (int t = 0; t < 20; ++t) REQUIRE(scene.tick());
        const pid_t child = fork();
        REQUIRE(child >= 0);
        if (child == 0) {
            // From here on the kernel kills what calls it for anything but read, write and exit.
            bool good = prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) == 0;
            for (int t = 0; good && t < 500; ++t) good = scene.tick();
            syscall(SYS_exit, good ? 0 : 1);
        }
        int status = 0;
        REQUIRE(waitpid(child, &status, 0) == child);
        INFO((WIFSIGNALED(status) ? "killed for a system call, signal " : "exit status ")
             << (WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status)));
        CHECK(WIFEXITED(status));
        CHECK(WEXITSTATUS(status) == 0);
    }
}
#endif
