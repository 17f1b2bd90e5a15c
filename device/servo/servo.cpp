#include "device/servo/servo.h"

#include "device/servo/realtime.h"
#include "device/start_thread.h"

namespace frm::device {

Servo::Servo(const api::Axes& axes, const ServoDef& def, api::BodyObject& body, Device& device)
    : axes_(axes), def_(def), body_(body), world_(body.world), device_(device), period_(1'000'000'000 / def.rate) {
    ++body_.users;
    ++world_.users;
    ++device_.servos;
    asked_.write(requests_);
    newest_.write(beginning());
}

frm_servo_state Servo::beginning() const {
    frm_servo_state state{};
    state.time = world_.world.time();
    state.pose = axes_.pose_out(body_.body.def.pose);
    state.twist = axes_.twist_out(body_.body.def.twist);
    state.grip_pose.rotation.w = 1;
    return state;
}

Servo::~Servo() {
    stop();
    --body_.users;
    --world_.users;
    --device_.servos;
}

// The world goes to the thread before start() returns, so that no call of the host comes between.
void Servo::claim() {
    if (world_.served.load()) throw Error(FRM_ERROR_STATE, "another servo runs this world");
    world_.served.store(this);
    device_.served.store(true);
}

void Servo::release() {
    device_.served.store(false, std::memory_order_release);
    world_.served.store(nullptr, std::memory_order_release);
}

void Servo::start() {
    if (running_.load()) return;
    if (thread_.joinable()) thread_.join();  // it came to its end by itself
    device_.prepare();
    claim();
    quit_.store(false);
    newest_.write(beginning());
    tick_times_.clear();
    lateness_.clear();
    for (Counter* counter : {&ticks_, &missed_, &skipped_, &failed_exchanges_, &diverged_}) counter->clear();
    locked_.store(def_.lock_memory && lock_memory());
    running_.store(true);
    try {
        thread_ = start_thread("the servo", [this] { run(); });
    } catch (const Error&) {
        running_.store(false);
        release();
        throw;
    }
}

void Servo::stop() {
    quit_.store(true);
    if (!thread_.joinable()) return;
    thread_.join();
    // What was engaged before is not engaged by the next start().
    requests_.engage = false;
    asked_.write(requests_);
}

void Servo::set_input(const frm_servo_input& input) {
    requests_.input = input;
    asked_.write(requests_);
}

void Servo::engage(bool engage) {
    requests_.engage = engage;
    ++requests_.engaging;
    asked_.write(requests_);
}

void Servo::clear_fault() {
    ++requests_.clearing;
    asked_.write(requests_);
}

void Servo::run() {
    const FloatingPointGuard modes;
    world_.served.store(api::this_thread(), std::memory_order_release);
    realtime_.store(def_.priority > 0 && take_realtime_priority(def_.priority));
    prepare_thread();
    tick_at_deadlines();
    try {
        device_.stop();
    } catch (const Error&) {
        // It was told; what became of it is in the state.
    }
    running_.store(false);
    release();
}

void Servo::tick_at_deadlines() {
    ServoLoop loop({axes_, world_.world, body_.body, device_, def_.grip, def_.rate, def_.on_tick, def_.user});
    bool goes_on = true;
    std::int64_t due = clock_now() + period_;
    while (goes_on && !quit_.load(std::memory_order_relaxed)) {
        sleep_until(due);
        const std::int64_t begin = clock_now();
        goes_on = loop.tick(asked_.read());
        newest_.write(loop.state());
        const std::int64_t end = clock_now();
        lateness_.add(static_cast<std::uint64_t>(begin > due ? begin - due : 0));
        tick_times_.add(static_cast<std::uint64_t>(end - begin));
        ticks_.add();
        failed_exchanges_.add(loop.failed_exchanges().get() - failed_exchanges_.get());
        diverged_.add(loop.diverged().get() - diverged_.get());
        // Late by less than a period, the next tick follows at once and the grid of deadlines stays. Whole periods are
        // lost: to catch up on them would only make more ticks late.
        due += period_;
        if (end >= due) {
            missed_.add();
            const std::int64_t lost = (end - due) / period_;
            skipped_.add(static_cast<std::uint64_t>(lost));
            due += lost * period_;
        }
    }
}

frm_servo_state Servo::state() const {
    frm_servo_state state = newest_.read();
    state.running = running_.load();
    return state;
}

frm_servo_stats Servo::stats() const {
    frm_servo_stats out{};
    out.realtime = realtime_.load();
    out.memory_locked = locked_.load();
    out.period_ns = static_cast<std::uint64_t>(period_);
    out.ticks = ticks_.get();
    out.missed = missed_.get();
    out.skipped = skipped_.get();
    out.failed_exchanges = failed_exchanges_.get();
    out.diverged = diverged_.get();
    out.tick_p50 = tick_times_.quantile(0.5);
    out.tick_p99 = tick_times_.quantile(0.99);
    out.tick_p9999 = tick_times_.quantile(0.9999);
    out.tick_max = tick_times_.largest();
    out.late_p50 = lateness_.quantile(0.5);
    out.late_p99 = lateness_.quantile(0.99);
    out.late_p9999 = lateness_.quantile(0.9999);
    out.late_max = lateness_.largest();
    return out;
}

}  // namespace frm::device
