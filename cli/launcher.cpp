#include "cli/launcher.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>

namespace frm::cli {
namespace {

/// A whole number from an environment variable; -1 if there is none.
long number_of(const char* name) {
    const char* const text = std::getenv(name);
    if (!text) return -1;
    const std::string digits = text;
    if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) return -1;
    return std::atol(text);
}

struct Names {
    const char *rank, *size, *local;  ///< this process, all of them, those on this machine
};

// Open MPI; MPICH and Intel MPI (Hydra); srun without either.
constexpr Names launchers[] = {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_LOCAL_SIZE"},
                               {"PMI_RANK", "PMI_SIZE", "MPI_LOCALNRANKS"},
                               {"SLURM_PROCID", "SLURM_STEP_NUM_TASKS", "SLURM_STEP_TASKS_PER_NODE"}};

}  // namespace

Launched launched() {
    Launched l;
    l.task = number_of("SLURM_ARRAY_TASK_ID");
    long local = 1;
    for (const Names& names : launchers) {
        const long rank = number_of(names.rank), size = number_of(names.size);
        if (rank < 0 || size < 1 || rank >= size) continue;
        l.rank = static_cast<std::size_t>(rank);
        l.ranks = static_cast<std::size_t>(size);
        local = std::max(1L, number_of(names.local));
        break;
    }
    // A launcher that binds processes to cores is seen by OpenMP. Where it does not, processes must not all take all.
    const long cores = number_of("SLURM_CPUS_ON_NODE") > 0 ? number_of("SLURM_CPUS_ON_NODE")
                                                           : static_cast<long>(std::thread::hardware_concurrency());
    if (l.ranks > 1)
        l.threads = static_cast<int>(std::max(1L, cores / local));
    else if (number_of("SLURM_CPUS_ON_NODE") > 0)
        l.threads = static_cast<int>(cores);
    return l;
}

}  // namespace frm::cli
