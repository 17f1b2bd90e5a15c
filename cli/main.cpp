#include <cmath>
#include <cstdio>

#include "bake/error.h"
#include "cli/command.h"
#include "core/error.h"
#include "frm.h"

namespace frm::cli {

Numbers read_vector(const std::string& text, const std::string& option) {
    Numbers v{};
    int used = 0;
    if (std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &v[0], &v[1], &v[2], &used) != 3 || text.c_str()[used] != 0 ||
        !std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2]))
        throw Failure(option + " " + text + ": three numbers are needed, such as 0,1,0");
    return v;
}

Numbers read_direction(const std::string& text, const std::string& option) {
    Numbers v = read_vector(text, option);
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 0)) throw Failure(option + " " + text + ": a direction cannot be zero");
    for (double& x : v) x /= length;
    return v;
}

void require_positive(double value, const std::string& option) {
    if (!(value > 0) || !std::isfinite(value)) throw Failure(option + " must be a positive number");
}

}  // namespace frm::cli

int main(int argc, char** argv) {
    using namespace frm::cli;
    CLI::App app{"frm - the force of water on moving rigid objects.\n\n"
                 "  frm bake paddle.glb -o paddle.frm      solve the flow around an object once\n"
                 "  frm info paddle.frm                    what the map holds\n"
                 "  frm force paddle.frm --velocity 0,1,0  what it feels when it moves\n"
                 "  frm run scene.json --report out        move it through water, and see\n\n"
                 "Units are SI: m, s, kg, N. Each command has its own --help.",
                 "frm"};
    app.require_subcommand(1);
    app.fallthrough(false);
    app.set_version_flag("--version", std::to_string(FRM_VERSION_MAJOR) + "." + std::to_string(FRM_VERSION_MINOR) + "." +
                                          std::to_string(FRM_VERSION_PATCH));
    add_bake(app);
    add_info(app);
    add_verify(app);
    add_flow(app);
    add_force(app);
    add_run(app);
    add_replay(app);
    add_bench(app);
    try {
        app.parse(argc, argv);
        return 0;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const Unsuccessful&) {
        return 1;
    } catch (const frm::Error& error) {
        std::fprintf(stderr, "frm: %s\n", error.text());
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "frm: out of memory\n");
    } catch (const std::exception& error) {
        std::fprintf(stderr, "frm: %s\n", error.what());
    }
    return 1;
}
