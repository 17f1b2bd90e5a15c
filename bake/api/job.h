// A bake that runs on a thread of its own: what a frm_bake handle names.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "bake/tasks/rounds.h"
#include "bake/tasks/store.h"
#include "frm_bake.h"

namespace frm::bake::api {

/// Calls are those of frm_bake.h, with arguments checked; failures are thrown as frm::Error.
class Job {
public:
    ~Job();

    void plan(const BakeOptions& options, const std::string& work, frm_bake_plan_info& info);
    void start();
    void cancel() { cancelled_ = true; }
    void wait();
    frm_bake_progress progress();
    const std::vector<std::uint8_t>& map();
    const std::string& report();
    void write(const std::string& path);
    void clear();
    std::string notes();

    /// The text of the last error, under its own lock: progress and errors are read while the work runs.
    void fail(const char* text) noexcept;
    std::string error();

private:
    void require_not_running();
    void run();
    void end(frm_bake_stage stage, frm_status status, const std::string& text);
    void note(const std::string& text);

    std::unique_ptr<BakePlan> plan_, first_;  ///< as extended by the work, and as it was planned
    std::string work_;                        ///< the folder above the store's
    std::unique_ptr<Store> store_;
    std::vector<std::uint8_t> map_;
    std::string report_;
    std::thread thread_;
    std::atomic<bool> cancelled_{false};

    std::mutex lock_;  ///< of what follows
    frm_bake_stage stage_ = FRM_BAKE_NEW;
    frm_status status_ = FRM_OK;  ///< of the work
    std::string why_, notes_, error_;
    RunState state_;
};

}  // namespace frm::bake::api
