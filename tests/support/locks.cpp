#include "tests/support/locks.h"

#include <dlfcn.h>
#include <pthread.h>

std::atomic<std::size_t> frm::test::locks{0};
static thread_local std::size_t here = 0;

std::size_t frm::test::locks_here() { return here; }
using frm::test::locks;

namespace {

template <typename Function>
Function* next_one(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" int pthread_mutex_lock(pthread_mutex_t* mutex) {
    static auto* const real = next_one<int(pthread_mutex_t*)>("pthread_mutex_lock");
    ++locks, ++here;
    return real(mutex);
}
extern "C" int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
    static auto* const real = next_one<int(pthread_rwlock_t*)>("pthread_rwlock_rdlock");
    ++locks, ++here;
    return real(lock);
}
extern "C" int pthread_rwlock_wrlock(pthread_rwlock_t* lock) {
    static auto* const real = next_one<int(pthread_rwlock_t*)>("pthread_rwlock_wrlock");
    ++locks, ++here;
    return real(lock);
}
