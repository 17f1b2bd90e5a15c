// A shared library that is looked for when it is needed, so that libfrm itself loads where it is not installed.
#pragma once

#include <initializer_list>
#include <string>

namespace frm::spidar_g {

class LoadedLibrary {
public:
    /// The first of these names that can be loaded. Throws Error (FRM_ERROR_UNSUPPORTED); `what` names the package.
    LoadedLibrary(std::initializer_list<const char*> names, const char* what);
    ~LoadedLibrary();
    LoadedLibrary(const LoadedLibrary&) = delete;
    LoadedLibrary& operator=(const LoadedLibrary&) = delete;

    /// Throws Error (FRM_ERROR_UNSUPPORTED) if it is not there.
    template <typename Function>
    void find(const char* name, Function& out) const {
        out = reinterpret_cast<Function>(symbol(name));
    }

private:
    void* symbol(const char* name) const;

    void* handle_ = nullptr;
    std::string what_;
};

}  // namespace frm::spidar_g
