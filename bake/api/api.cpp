// The C entry points of frm_bake.h: arguments are checked before anything changes, no exception gets out.
#include <array>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>

#include "bake/api/job.h"
#include "bake/tasks/durable.h"
#include "core/api/arguments.h"
#include "frm_bake.h"

using namespace frm;
using frm::bake::api::Job;

namespace {

// A handle: generation (32 bits), a mark that no handle of libfrm has (its fourth byte from the bottom is a context's
// number, its fifth a kind), index (8 bits). What bakes share: which of them exist.
constexpr std::size_t most = 64;
constexpr std::uint64_t mark = 0xBA4Eull << 16;

struct Place {
    std::uint64_t handle = 0;
    std::shared_ptr<Job> job;
};
std::array<Place, most> places;
std::uint32_t generation = 0;
std::mutex places_lock;

std::shared_ptr<Job> find(frm_bake handle) {
    const std::lock_guard<std::mutex> lock(places_lock);
    const std::size_t index = handle & 0xFF;
    if (handle == 0 || index >= most || places[index].handle != handle) return nullptr;
    return places[index].job;
}

/// Runs `call` on the job that a handle names; what it throws becomes a status and the job's last-error text.
template <typename Call>
frm_status with(frm_bake handle, const Call& call) noexcept {
    const std::shared_ptr<Job> job = find(handle);
    if (!job) return FRM_ERROR_HANDLE;
    try {
        call(*job);
        return FRM_OK;
    } catch (const Error& error) {
        job->fail(error.text());
        return error.status();
    } catch (const bake::FileError& error) {
        job->fail(error.what());
        return FRM_ERROR_FILE;
    } catch (const std::bad_alloc&) {
        return FRM_ERROR_MEMORY;
    } catch (const std::exception& error) {
        job->fail(error.what());
        return FRM_ERROR_INTERNAL;
    } catch (...) {
        return FRM_ERROR_INTERNAL;
    }
}

frm_bake_def defaults() {
    const bake::BakeOptions o;
    frm_bake_def def{};
    def.quality = FRM_BAKE_STANDARD;
    def.scale = o.scale;
    def.density = o.density;
    def.viscosity = o.viscosity;
    def.speed = o.speed;
    def.spin = o.spin;
    def.added_mass = o.added_mass;
    def.symmetry = o.symmetry;
    def.threshold = o.threshold;
    return def;
}

constexpr std::uint32_t most_further_speeds = Map::max_speeds - 1;

void require_switch(std::uint32_t value, const char* name) {
    if (value > 1) throw Error(FRM_ERROR_ARGUMENT, "%s = %u is neither 0 nor 1", name, value);
}

bake::BakeOptions options_of(const frm_bake_def& def) {
    using api::require_range;
    api::require_pointer(def.mesh, "def.mesh");
    if (def.quality > FRM_BAKE_HIGH)
        throw Error(FRM_ERROR_ARGUMENT, "def.quality = %u is no frm_bake_quality", def.quality);
    require_range(def.scale, 1e-6, 1e6, "def.scale");
    require_range(def.density, 1e-3, 1e5, "def.density");
    require_range(def.viscosity, 1e-9, 1e2, "def.viscosity");
    require_range(def.speed, 1e-6, 1e4, "def.speed");
    require_range(def.speed_count, 0, most_further_speeds, "def.speed_count");
    if (def.speed_count > 0) api::require_pointer(def.speeds, "def.speeds");
    for (std::uint32_t k = 0; k < def.speed_count; ++k) {
        char name[32];
        std::snprintf(name, sizeof name, "def.speeds[%u]", k);
        require_range(def.speeds[k], 1e-6, 1e4, name);
    }
    require_switch(def.spin, "def.spin");
    require_switch(def.added_mass, "def.added_mass");
    require_switch(def.symmetry, "def.symmetry");
    require_range(def.threshold, 0, 1, "def.threshold");
    if (def.resolution != 0) require_range(def.resolution, 4, 512, "def.resolution");
    if (def.directions != 0 && bake::frequency_of(def.directions) == 0)
        throw Error(FRM_ERROR_ARGUMENT, "def.directions = %u is not 6, 18, 38, 66, 102, ... up to 1026",
                    def.directions);
    if (def.sources != 0) require_range(def.sources, 1, 4096, "def.sources");
    if (def.triangles != 0) require_range(def.triangles, 4, 2097152, "def.triangles");
    require_range(def.threads, 0, 256, "def.threads");
    bake::BakeOptions o;
    o.mesh = def.mesh;
    o.scale = def.scale;
    o.quality = def.quality == FRM_BAKE_DRAFT  ? bake::Quality::draft
                : def.quality == FRM_BAKE_HIGH ? bake::Quality::high
                                               : bake::Quality::standard;
    o.density = def.density;
    o.viscosity = def.viscosity;
    o.speed = def.speed;
    if (def.speed_count > 0) o.speeds.assign(def.speeds, def.speeds + def.speed_count);
    o.spin = def.spin != 0;
    o.added_mass = def.added_mass != 0;
    o.symmetry = def.symmetry != 0;
    o.threshold = def.threshold;
    o.resolution = def.resolution;
    o.directions = def.directions;
    o.sources = def.sources;
    o.triangles = def.triangles;
    o.threads = static_cast<int>(def.threads);
    return o;
}

}  // namespace

extern "C" {

frm_status FRM_CALL frm_bake_version(uint32_t* major, uint32_t* minor, uint32_t* patch) {
    if (major) *major = FRM_VERSION_MAJOR;
    if (minor) *minor = FRM_VERSION_MINOR;
    if (patch) *patch = FRM_VERSION_PATCH;
    return FRM_OK;
}

frm_status FRM_CALL frm_bake_def_init(frm_bake_def* def, uint64_t size) { return api::init_def(def, size, defaults()); }

frm_status FRM_CALL frm_bake_create(frm_bake* bake) {
    if (!bake) return FRM_ERROR_ARGUMENT;
    try {
        auto job = std::make_shared<Job>();
        const std::lock_guard<std::mutex> lock(places_lock);
        for (std::size_t i = 0; i < most; ++i) {
            if (places[i].handle != 0) continue;
            generation = generation == UINT32_MAX ? 1 : generation + 1;
            places[i] = {std::uint64_t{generation} << 32 | mark | i, std::move(job)};
            *bake = places[i].handle;
            return FRM_OK;
        }
        return FRM_ERROR_LIMIT;
    } catch (...) {
        return FRM_ERROR_MEMORY;
    }
}

frm_status FRM_CALL frm_bake_destroy(frm_bake bake) {
    std::shared_ptr<Job> job;
    {
        const std::lock_guard<std::mutex> lock(places_lock);
        const std::size_t index = bake & 0xFF;
        if (bake == 0 || index >= most || places[index].handle != bake) return FRM_ERROR_HANDLE;
        job = std::move(places[index].job);
        places[index].handle = 0;
    }
    job.reset();  // joins, without the lock
    return FRM_OK;
}

frm_status FRM_CALL frm_bake_last_error(frm_bake bake, char* text, uint64_t capacity, uint64_t* size) {
    return with(bake, [&](Job& job) {
        const std::string error = job.error();
        api::write_text(error.c_str(), error.size(), text, capacity, size);
    });
}

frm_status FRM_CALL frm_bake_plan(frm_bake bake, const frm_bake_def* def, frm_bake_plan_info* info) {
    return with(bake, [&](Job& job) {
        api::require_pointer(def, "def");
        if (info) api::require_out(info, "info");
        const frm_bake_def whole = api::read_def(def, defaults(), "def");
        const bake::BakeOptions options = options_of(whole);
        frm_bake_plan_info found{};
        job.plan(options, whole.work ? whole.work : "", found);
        if (info) api::write_struct(info, found);
    });
}

frm_status FRM_CALL frm_bake_get_notes(frm_bake bake, char* text, uint64_t capacity, uint64_t* size) {
    return with(bake, [&](Job& job) {
        const std::string notes = job.notes();
        api::write_text(notes.c_str(), notes.size(), text, capacity, size);
    });
}

frm_status FRM_CALL frm_bake_start(frm_bake bake) {
    return with(bake, [](Job& job) { job.start(); });
}

frm_status FRM_CALL frm_bake_get_progress(frm_bake bake, frm_bake_progress* progress) {
    return with(bake, [&](Job& job) {
        api::require_out(progress, "progress");
        api::write_struct(progress, job.progress());
    });
}

frm_status FRM_CALL frm_bake_cancel(frm_bake bake) {
    return with(bake, [](Job& job) { job.cancel(); });
}

frm_status FRM_CALL frm_bake_wait(frm_bake bake) {
    return with(bake, [](Job& job) { job.wait(); });
}

frm_status FRM_CALL frm_bake_get_map(frm_bake bake, void* data, uint64_t capacity, uint64_t* size) {
    return with(bake, [&](Job& job) {
        api::require_pointer(size, "size");
        const std::vector<std::uint8_t>& map = job.map();
        *size = map.size();
        if (!data) return;
        if (capacity < map.size())
            throw Error(FRM_ERROR_CAPACITY, "the buffer takes %llu bytes; %zu are needed",
                        static_cast<unsigned long long>(capacity), map.size());
        std::memcpy(data, map.data(), map.size());
    });
}

frm_status FRM_CALL frm_bake_get_report(frm_bake bake, char* text, uint64_t capacity, uint64_t* size) {
    return with(bake, [&](Job& job) {
        const std::string& report = job.report();
        api::write_text(report.c_str(), report.size(), text, capacity, size);
    });
}

frm_status FRM_CALL frm_bake_write_map(frm_bake bake, const char* path) {
    return with(bake, [&](Job& job) {
        api::require_pointer(path, "path");
        job.write(path);
    });
}

frm_status FRM_CALL frm_bake_clear_work(frm_bake bake) {
    return with(bake, [](Job& job) { job.clear(); });
}

}  // extern "C"
