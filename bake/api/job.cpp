#include "bake/api/job.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "bake/report_json.h"
#include "bake/tasks/durable.h"
#include "core/error.h"
#include "core/map/codec.h"

namespace frm::bake::api {

Job::~Job() {
    cancel();
    if (thread_.joinable()) thread_.join();
}

void Job::fail(const char* text) noexcept {
    try {
        const std::lock_guard<std::mutex> lock(lock_);
        error_ = text;
    } catch (...) {
        // No memory for the text: the status has to do.
    }
}

std::string Job::error() {
    const std::lock_guard<std::mutex> lock(lock_);
    return error_;
}

std::string Job::notes() {
    const std::lock_guard<std::mutex> lock(lock_);
    return notes_;
}

void Job::note(const std::string& text) {
    const std::lock_guard<std::mutex> lock(lock_);
    notes_ += text + "\n";
}

void Job::require_not_running() {
    {
        const std::lock_guard<std::mutex> lock(lock_);
        if (stage_ == FRM_BAKE_RUNNING) throw Error(FRM_ERROR_STATE, "the bake runs: cancel it and wait first");
    }
    if (thread_.joinable()) thread_.join();
}

void Job::plan(const BakeOptions& options, const std::string& work, frm_bake_plan_info& info) {
    require_not_running();
    store_.reset();
    work_ = work;
    plan_.reset();
    first_.reset();
    map_.clear();
    report_.clear();
    {
        const std::lock_guard<std::mutex> lock(lock_);
        stage_ = FRM_BAKE_NEW;
        state_ = {};
        notes_.clear();
    }
    auto plan = std::make_unique<BakePlan>();
    try {
        *plan = plan_bake(options);
    } catch (const BakeError& error) {
        throw Error(FRM_ERROR_ARGUMENT, "%s", error.what());
    }
    for (const std::string& text : plan->notes) note(text);
    if (!work.empty())
        store_ =
            std::make_unique<Store>(work_folder(work, *plan), *plan, [this](const std::string& text) { note(text); });
    first_ = std::move(plan);

    const SurfaceProperties shape = measure(first_->surface);
    const Vec3d size = shape.high - shape.low;
    info.flows = static_cast<std::uint32_t>(first_->tasks.size());
    info.flows_done = store_ ? static_cast<std::uint32_t>(store_->count(first_->tasks.size())) : 0;
    info.most_flows = static_cast<std::uint32_t>(most_tasks(*first_));
    info.directions = first_->directions.count();
    info.sources = first_->regions.count;
    info.triangles = static_cast<std::uint32_t>(first_->surface.triangles.size());
    for (const Task& task : first_->tasks) {
        info.updates += task.cost.updates;
        info.flow_bytes = std::max(info.flow_bytes, task.cost.bytes);
    }
    info.isometries = first_->symmetry.kind == SymmetryKind::finite
                          ? static_cast<std::uint32_t>(first_->symmetry.elements.size())
                          : 0;
    std::snprintf(info.symmetry, sizeof info.symmetry, "%s", describe(first_->symmetry).c_str());
    info.extent = std::max({size.x, size.y, size.z});
    const std::lock_guard<std::mutex> lock(lock_);
    stage_ = FRM_BAKE_PLANNED;
    state_.all = first_->tasks.size();
    state_.done = info.flows_done;
}

void Job::start() {
    require_not_running();
    {
        const std::lock_guard<std::mutex> lock(lock_);
        if (stage_ == FRM_BAKE_NEW) throw Error(FRM_ERROR_STATE, "nothing is planned: call frm_bake_plan first");
        if (stage_ == FRM_BAKE_DONE) throw Error(FRM_ERROR_STATE, "the bake is done");
        stage_ = FRM_BAKE_RUNNING;
    }
    cancelled_ = false;
    try {
        plan_ = std::make_unique<BakePlan>(*first_);
        thread_ = std::thread([this] { run(); });
    } catch (...) {
        end(FRM_BAKE_FAILED, FRM_ERROR_MEMORY, "the system gives no thread or memory");
        throw Error(FRM_ERROR_MEMORY, "the system gives no thread or memory");
    }
}

void Job::end(frm_bake_stage stage, frm_status status, const std::string& text) {
    const std::lock_guard<std::mutex> lock(lock_);
    stage_ = stage;
    status_ = status;
    why_ = text;
}

void Job::run() {
    try {
        RunSettings settings;
        settings.threads = plan_->options.threads;
        settings.store = store_.get();
        const std::vector<TaskResult> results = solve_rounds(*plan_, settings, [this](const RunState& state) {
            const std::lock_guard<std::mutex> lock(lock_);
            state_ = state;
            return !cancelled_;
        });
        {
            const std::lock_guard<std::mutex> lock(lock_);
            state_.share = 1;
            state_.seconds_left = -1;
            state_.task = "making the map";
        }
        const auto go_on = [this] {
            if (cancelled_) throw FlowCancelled("the bake was cancelled");
        };
        go_on();
        BakeReport report;
        const std::unique_ptr<Map> map = make_map(*plan_, results, report);
        go_on();
        map_ = encode_map(*map);
        report_ = report_text(*plan_, *map, report);
        {
            const std::lock_guard<std::mutex> lock(lock_);
            state_ = {};
            state_.share = 1;
            state_.seconds_left = 0;
            state_.done = state_.all = plan_->tasks.size();
        }
        end(FRM_BAKE_DONE, FRM_OK, "");
    } catch (const FlowCancelled&) {
        end(FRM_BAKE_CANCELLED, FRM_ERROR_STATE, "the bake was cancelled");
    } catch (const FileError& error) {
        end(FRM_BAKE_FAILED, FRM_ERROR_FILE, error.what());
    } catch (const BakeError& error) {
        end(FRM_BAKE_FAILED, FRM_ERROR_DIVERGED, error.what());
    } catch (const Error& error) {
        end(FRM_BAKE_FAILED, error.status(), error.text());
    } catch (const std::bad_alloc&) {
        end(FRM_BAKE_FAILED, FRM_ERROR_MEMORY, "out of memory");
    } catch (const std::exception& error) {
        end(FRM_BAKE_FAILED, FRM_ERROR_INTERNAL, error.what());
    }
}

void Job::wait() {
    if (thread_.joinable()) thread_.join();
    const std::lock_guard<std::mutex> lock(lock_);
    if (stage_ == FRM_BAKE_NEW || stage_ == FRM_BAKE_PLANNED)
        throw Error(FRM_ERROR_STATE, "the bake was not started: call frm_bake_start first");
    if (status_ != FRM_OK) throw Error(status_, "%s", why_.c_str());
}

frm_bake_progress Job::progress() {
    const std::lock_guard<std::mutex> lock(lock_);
    frm_bake_progress p{};
    p.stage = stage_;
    p.share = state_.share;
    p.seconds_left = state_.seconds_left;
    p.flows = static_cast<std::uint32_t>(state_.all);
    p.flows_done = static_cast<std::uint32_t>(state_.done);
    p.drag = state_.recording ? static_cast<float>(state_.drag_coefficient) : 0;
    p.uncertainty = state_.recording ? static_cast<float>(state_.statistics) : 0;
    std::strncpy(p.flow, state_.task.c_str(), sizeof p.flow - 1);
    return p;
}

const std::vector<std::uint8_t>& Job::map() {
    const std::lock_guard<std::mutex> lock(lock_);
    if (stage_ != FRM_BAKE_DONE) throw Error(FRM_ERROR_STATE, "there is no map: the bake is not done");
    return map_;
}

const std::string& Job::report() {
    map();
    return report_;
}

void Job::write(const std::string& path) {
    const std::vector<std::uint8_t>& bytes = map();
    write_durably(path, bytes.data(), bytes.size());
}

void Job::clear() {
    map();
    if (thread_.joinable()) thread_.join();
    if (store_ && store_->remove()) rmdir(work_.c_str());  // which fails where others have something there
    store_.reset();
}

}  // namespace frm::bake::api
