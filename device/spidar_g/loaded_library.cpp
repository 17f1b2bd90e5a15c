#include "device/spidar_g/loaded_library.h"

#include <dlfcn.h>

#include "core/error.h"

namespace frm::spidar_g {

LoadedLibrary::LoadedLibrary(std::initializer_list<const char*> names, const char* what) : what_(what) {
    std::string failure;
    for (const char* name : names) {
        handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
        if (handle_) return;
        if (failure.empty()) failure = dlerror();
    }
    throw Error(FRM_ERROR_UNSUPPORTED, "%s is not installed (%s)", what, failure.c_str());
}

LoadedLibrary::~LoadedLibrary() { dlclose(handle_); }

void* LoadedLibrary::symbol(const char* name) const {
    void* found = dlsym(handle_, name);
    if (!found) throw Error(FRM_ERROR_UNSUPPORTED, "%s has no %s: it is too old", what_.c_str(), name);
    return found;
}

}  // namespace frm::spidar_g
