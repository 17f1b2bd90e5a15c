// As consumer.c, in C++11: errors become exceptions on the caller's side of the interface.
#include <frm.h>

#include <exception>
#include <iostream>
#include <stdexcept>

namespace {

void ok(frm_status status) {
    if (status != FRM_OK) throw std::runtime_error(frm_status_name(status));
}

class Context {
public:
    Context() { ok(frm_context_create(nullptr, &handle_)); }
    ~Context() { frm_context_destroy(handle_); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    frm_context handle() const { return handle_; }

private:
    frm_context handle_ = 0;
};

}  // namespace

int main() {
    try {
        const Context context;
        frm_world world = 0;
        ok(frm_world_create(context.handle(), nullptr, &world));
        ok(frm_world_tick(world, 0.002f));
        uint32_t major = 0, minor = 0, patch = 0;
        ok(frm_version(&major, &minor, &patch));
        std::cout << "frm " << major << '.' << minor << '.' << patch << '\n';
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
