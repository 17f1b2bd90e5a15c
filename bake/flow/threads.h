// How many threads a run uses.
#pragma once

#ifdef _OPENMP
#include <omp.h>
#endif

namespace frm::bake::flow {

inline int thread_count(int wanted) {
#ifdef _OPENMP
    return wanted > 0 ? wanted : omp_get_max_threads();
#else
    static_cast<void>(wanted);
    return 1;
#endif
}

}  // namespace frm::bake::flow
