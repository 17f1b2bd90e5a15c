// What Slurm or an MPI launcher says of this process, by environment variables: frm needs no library of theirs.
#pragma once

#include <cstddef>

namespace frm::cli {

struct Launched {
    long task = -1;                   ///< number of this element of a Slurm array; -1: none
    std::size_t rank = 0, ranks = 1;  ///< of mpirun or srun
    int threads = 0;                  ///< this process's part of the machine; 0: nobody said
};

Launched launched();

}  // namespace frm::cli
