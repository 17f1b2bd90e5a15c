#include "cli/frontier_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "bake/regions/choose.h"
#include "cli/command.h"
#include "cli/file.h"
#include "cli/motion.h"
#include "cli/presets.h"

namespace frm::cli {
namespace {

constexpr double pi = 3.14159265358979323846, degree = pi / 180;

using Six = std::array<double, 6>;  ///< position, m; rotation about x, y, z, degrees

Motion motion_of(const nlohmann::json& keys) {
    const nlohmann::json j{{"type", "keyframes"}, {"keys", keys}};
    return Motion(JsonReader(j, "bench"));
}

/// A smooth motion through what a formula says every twentieth of a second.
Motion motion_of(const std::function<Six(double)>& formula, double seconds) {
    nlohmann::json keys = nlohmann::json::array();
    for (int k = -2; 0.05 * (k - 2) <= seconds; ++k) {
        const Six v = formula(0.05 * k);
        keys.push_back({{"time", 0.05 * (k + 2)}, {"position", {v[0], v[1], v[2]}}, {"rotation", {v[3], v[4], v[5]}}});
    }
    return motion_of(keys);
}

std::function<void(double, std::uint32_t, frm_pose&, frm_twist&)> alone(Motion motion, double begin = 0) {
    const auto shared = std::make_shared<const Motion>(std::move(motion));
    return [shared, begin](double time, std::uint32_t, frm_pose& pose, frm_twist& twist) {
        shared->at(time + begin, pose, twist);
    };
}

frm_water_def water_of(double metres, double cell, double depth) {
    frm_water_def def;
    frm_water_def_init(&def, sizeof def);
    def.nx = def.ny = static_cast<std::uint32_t>(std::lround(metres / cell));
    def.cell = static_cast<float>(cell);
    def.depth = static_cast<float>(depth);
    return def;
}

std::string text_of(double v, const char* unit) {
    char text[48];
    std::snprintf(text, sizeof text, "%.4g%s%s", v, *unit ? " " : "", unit);
    return text;
}

/// A body as law_map() makes it.
struct Shape {
    std::function<bake::Surface(std::uint32_t triangles)> surface;
    std::uint32_t triangles = 2000;                  ///< of a standard bake
    std::uint32_t draft = 0, sources = 0, high = 0;  ///< of the three qualities
};

Shape shape_of(std::function<bake::Surface(std::uint32_t)> surface) {
    Shape shape;
    shape.surface = std::move(surface);
    const bake::Surface sample = shape.surface(shape.triangles);
    const auto sources = [&](double error) { return bake::choose_regions(sample, {error}).regions.count; };
    shape.draft = sources(bake::kDraftRegionError);
    shape.sources = sources(bake::kStandardRegionError);
    shape.high = sources(bake::kHighRegionError);
    return shape;
}

/// What is known of a scene before its knobs: the shape, and the default.
struct Base {
    Shape shape;
    FrontierScene scene;
    bool quick = false;

    MapFile map(std::uint32_t triangles, std::uint32_t sources, std::uint32_t frequency, double rounding) const {
        LawMap law;
        law.sources = sources;
        law.frequency = frequency;
        law.rounding = rounding;
        return law_map(shape.surface(triangles), law);
    }

    /// A knob over these values; `change` makes of the default what the value means.
    template <typename Change>
    void knob(const std::string& name, const char* unit, std::vector<double> values, double standard,
              const Change& change) {
        if (quick && values.size() > 3) {
            // The ends and the default, or the middle.
            const bool has = std::find(values.begin(), values.end(), standard) != values.end();
            std::vector<double> few{values.front(), has ? standard : values[values.size() / 2], values.back()};
            few.erase(std::unique(few.begin(), few.end()), few.end());
            values = std::move(few);
        }
        Knob knob{name, unit, {}};
        for (const double value : values) {
            Choice choice{text_of(value, unit), value, scene.standard, value == standard};
            if (!choice.standard) change(choice.setup, value);
            knob.choices.push_back(std::move(choice));
        }
        scene.knobs.push_back(std::move(knob));
    }

    void map_knobs(std::vector<double> triangles, std::vector<double> sources, bool directions) {
        const auto with = [](std::vector<double> values, double standard) {
            values.push_back(standard);
            std::sort(values.begin(), values.end());
            values.erase(std::unique(values.begin(), values.end()), values.end());
            return values;
        };
        const LawMap law;
        knob("triangles", "", with(std::move(triangles), shape.triangles), shape.triangles, [&](Setup& s, double v) {
            s.map = map(static_cast<std::uint32_t>(v), shape.sources, law.frequency, law.rounding);
        });
        knob("sources", "", with(std::move(sources), shape.sources), shape.sources, [&](Setup& s, double v) {
            s.map = map(shape.triangles, static_cast<std::uint32_t>(v), law.frequency, law.rounding);
        });
        if (!directions) return;
        knob("directions", "", {6, 18, 38, 66, 102, 258, 578, 1026}, 258, [&](Setup& s, double v) {
            const auto n = static_cast<std::uint32_t>(std::lround(std::sqrt((v - 2) / 4)));
            s.map = map(shape.triangles, shape.sources, n, law.rounding);
        });
        knob("map precision", "", {0.1, 0.03, 0.015, 0.005, 0.0015, 0.0005, 0.00005}, 0.005,
             [&](Setup& s, double v) { s.map = map(shape.triangles, shape.sources, law.frequency, v); });
    }

    void water_knobs(const std::vector<double>& cells, double metres) {
        const auto standard = static_cast<double>(scene.standard.water->cell);
        knob("cell", "m", cells, standard_of(cells, standard), [&](Setup& s, double v) {
            s.water->cell = static_cast<float>(v);
            s.water->nx = s.water->ny = static_cast<std::uint32_t>(std::lround(metres / v));
        });
        knob("order", "", {2, 4}, 2, [&](Setup& s, double v) { s.water->order = static_cast<std::uint32_t>(v); });
    }

    void tick_knob(std::vector<double> milliseconds) {
        knob("tick", "ms", std::move(milliseconds), 2, [](Setup& s, double v) { s.dt = 1e-3 * v; });
    }

    /// Each rule off by itself, then none on.
    void skip_knob(const std::vector<std::pair<const char*, std::uint32_t>>& rules) {
        Knob knob{"skip", "", {{"all", 1, scene.standard, true}}};
        for (const auto& [name, bit] : rules) {
            knob.choices.push_back({std::string("without ") + name, 0, scene.standard, false});
            knob.choices.back().setup.world.skip &= ~bit;
        }
        knob.choices.push_back({"nothing", 0, scene.standard, false});
        knob.choices.back().setup.world.skip = FRM_SKIP_NOTHING;
        scene.knobs.push_back(std::move(knob));
    }

    void budget_knobs(const std::vector<double>& newtons, const std::vector<double>& microseconds) {
        knob("error budget", "N", newtons, 0, [](Setup& s, double v) { s.world.error_budget = static_cast<float>(v); });
        knob("time budget", "us", microseconds, 0,
             [](Setup& s, double v) { s.world.time_budget = static_cast<float>(v); });
    }

    /// All of it from coarse to fine: what a frontier can be that no knob reaches by itself.
    void together_knob() {
        struct Level {
            const char* label;
            std::uint32_t triangles, sources, frequency;
            double cells;
            std::uint32_t order;
            double dt;
        };
        const Level levels[] = {
            {"half a draft, cells x 4", shape.triangles / 4, shape.draft / 2, 3, 4, 2, 0.002},
            {"half a draft, cells x 2", shape.triangles / 4, shape.draft / 2, 3, 2, 2, 0.002},
            {"draft, cells x 2", shape.triangles, shape.draft, 6, 2, 2, 0.002},
            {"draft, cells x 2, order 4", shape.triangles, shape.draft, 6, 2, 4, 0.002},
            {"draft, cells x 2, 5 ms", shape.triangles, shape.draft, 6, 2, 2, 0.005},
            {"standard, cells x 4/3, order 4", shape.triangles, shape.sources, 8, 4.0 / 3, 4, 0.002},
            {"standard", shape.triangles, shape.sources, 8, 1, 2, 0.002},
            {"standard, order 4", shape.triangles, shape.sources, 8, 1, 4, 0.002},
            {"high", shape.triangles, shape.high, 10, 1, 2, 0.002},
            {"high, order 4", shape.triangles, shape.high, 10, 1, 4, 0.002},
            {"twice high, order 4, 1 ms", 2 * shape.triangles, 2 * shape.high, 16, 1, 4, 0.001},
            {"high, cells x 1/2", shape.triangles, shape.high, 10, 0.5, 2, 0.002},
            {"high, cells x 1/2, order 4", shape.triangles, shape.high, 10, 0.5, 4, 0.002},
            {"twice high, cells x 1/2, order 4, 1 ms", 2 * shape.triangles, 2 * shape.high, 16, 0.5, 4, 0.001},
        };
        Knob knob{"together", "", {}, false};
        for (const Level& level : levels) {
            Choice choice{level.label, 0, scene.standard, level.label == std::string("standard")};
            if (!choice.standard)
                choice.setup.map = map(level.triangles, level.sources, level.frequency, LawMap().rounding);
            if (choice.setup.water) apply_preset({"", "", level.cells, level.order}, *choice.setup.water);
            choice.setup.dt = level.dt;
            knob.choices.push_back(std::move(choice));
        }
        scene.knobs.push_back(std::move(knob));
    }

    /// The named presets, each with a map of the quality that goes with it.
    void preset_knob() {
        Knob knob{"preset", "", {}, false};
        for (const Preset& preset : kPresets) {
            Choice choice{preset.name, 0, scene.standard, preset.name == std::string("default")};
            if (!choice.standard) {
                const bool fast = preset.name == std::string("fast");
                choice.setup.map =
                    map(shape.triangles, fast ? shape.draft : shape.high, fast ? 6u : 10u, LawMap().rounding);
                if (choice.setup.water) apply_preset(preset, *choice.setup.water);
            }
            knob.choices.push_back(std::move(choice));
        }
        scene.knobs.push_back(std::move(knob));
    }

private:
    /// The one of the values that is the default but for its rounding to a float.
    static double standard_of(const std::vector<double>& values, double standard) {
        return *std::min_element(values.begin(), values.end(),
                                 [&](double a, double b) { return std::fabs(a - standard) < std::fabs(b - standard); });
    }
};

const std::vector<std::pair<const char*, std::uint32_t>> water_rules{
    {"FRICTION", FRM_SKIP_FRICTION},         {"STEADY", FRM_SKIP_STEADY},
    {"CALM_WATER", FRM_SKIP_CALM_WATER},     {"WAVE_STEPS", FRM_SKIP_WAVE_STEPS},
    {"STILL_BODIES", FRM_SKIP_STILL_BODIES}, {"DRY_BODIES", FRM_SKIP_DRY_BODIES}};

Setup finest_of(const Base& base, double cell, double metres) {
    Setup out = base.scene.standard;
    out.map = base.map(base.quick ? base.shape.triangles : 8000, base.quick ? base.shape.high : 400,
                       base.quick ? 10 : 16, 5e-5);
    if (out.water) {
        out.water->cell = static_cast<float>(cell);
        out.water->nx = out.water->ny = static_cast<std::uint32_t>(std::lround(metres / cell));
        out.water->order = 4;
    }
    out.dt = base.quick ? 1e-3 : 0.5e-3;
    out.world.skip = FRM_SKIP_NOTHING;
    return out;
}

FrontierScene stroke(bool quick) {
    Base base;
    base.quick = quick;
    base.shape = shape_of([](std::uint32_t n) { return box_surface({0.2, 0.02, 0.6}, {0, 0, -0.4}, n); });
    FrontierScene& s = base.scene;
    s.what =
        "a blade of 0.2 x 0.02 x 0.6 m on the paddle stroke of samples/paddle_stroke.json, through waves of 0.8 m "
        "and 1 cm, on 5 x 5 m of water 0.8 m deep";
    s.play.name = "stroke";
    s.play.seconds = quick ? 0.8 : 2.4;
    s.play.motion = alone(motion_of(nlohmann::json::parse(R"([
        {"time": 0.0, "position": [0, 0.50, 0.95], "rotation": [30, 0, 0]},
        {"time": 0.4, "position": [0, 0.45, 0.45], "rotation": [25, 0, 0]},
        {"time": 0.7, "position": [0, 0.25, 0.38], "rotation": [12, 0, 0]},
        {"time": 1.1, "position": [0, -0.15, 0.38], "rotation": [-10, 0, 0]},
        {"time": 1.4, "position": [0, -0.40, 0.50], "rotation": [-28, 0, 10]},
        {"time": 1.7, "position": [0, -0.30, 0.95], "rotation": [-20, 0, 20]},
        {"time": 2.4, "position": [0, 0.50, 0.95], "rotation": [30, 0, 0]}])")));
    s.play.height = [](double x, double y) { return 0.01 * std::sin(2 * pi * (0.8 * x + 0.6 * y) / 0.8); };
    s.standard.map = base.map(base.shape.triangles, base.shape.sources, 8, LawMap().rounding);
    const double metres = quick ? 2 : 5;
    s.standard.water = water_of(metres, quick ? 0.025 : 5.0 / 140, 0.8);
    base.map_knobs({50, 200, 500, 1000, 4000, 8000}, {6, 9, 14, 20, 28, 56, 80, 160, 400}, true);
    if (quick)
        base.water_knobs({0.1, 0.025, 0.0125}, metres);
    else
        base.water_knobs({0.1, 0.05, 5.0 / 140, 0.025, 0.0125, 0.00625}, metres);
    base.tick_knob({10, 5, 2, 1, 0.5});
    base.skip_knob(water_rules);
    base.together_knob();
    base.preset_knob();
    s.finest.push_back(finest_of(base, quick ? 0.0125 : 0.00625, metres));
    s.reference =
        "8,000 triangles, 400 sources, 1,026 directions, precision 0.005 %, cells of 6.25 mm at fourth order, "
        "ticks of 0.5 ms, nothing skipped";
    if (quick) s.reference = "the finest of --quick";
    return s;
}

FrontierScene boat(bool quick) {
    Base base;
    base.quick = quick;
    base.shape = shape_of([](std::uint32_t n) {
        return ellipsoid_surface({0.6, 0.25, 0.2}, static_cast<std::uint32_t>(std::lround(std::sqrt(n / 8.0))));
    });
    base.shape.triangles = 4608;
    FrontierScene& s = base.scene;
    s.what =
        "a hull (ellipsoid of 1.2 x 0.5 x 0.4 m) towed at 0.5 m/s that heaves, rolls and pitches half in waves of "
        "1.2 m and 2 cm, on 6 x 6 m of water 0.5 m deep";
    s.play.name = "boat";
    s.play.seconds = quick ? 0.6 : 2.4;
    s.play.motion = alone(motion_of(
        [](double t) {
            return Six{-0.6 + 0.5 * t,
                       0.1,
                       0.06 * std::sin(2 * pi * t / 1.1),
                       12 * std::sin(2 * pi * t / 1.3),
                       6 * std::sin(2 * pi * t / 1.7),
                       8 * t};
        },
        s.play.seconds));
    s.play.height = [](double x, double y) { return 0.02 * std::sin(2 * pi * (0.8 * x + 0.6 * y) / 1.2); };
    s.standard.map = base.map(base.shape.triangles, base.shape.sources, 8, LawMap().rounding);
    s.standard.water = water_of(6, 0.05, 0.5);
    if (quick) s.standard.water->nx = s.standard.water->ny = 48;
    const double metres = quick ? 2.4 : 6;
    base.water_knobs({0.2, 0.15, 0.1, 0.075, 0.05, 0.0375, 0.025, 0.0125}, metres);
    base.map_knobs({128, 288, 512, 1152, 2048, 8192}, {8, 14, 28, 56, 80, 160, 400}, false);
    base.tick_knob({10, 5, 2, 1, 0.5});
    base.skip_knob(water_rules);
    base.together_knob();
    base.preset_knob();
    s.finest.push_back(finest_of(base, quick ? 0.025 : 0.0125, metres));
    s.reference =
        "8,192 triangles, 400 sources, 1,026 directions, precision 0.005 %, cells of 12.5 mm at fourth order, "
        "ticks of 0.5 ms, nothing skipped";
    if (quick) s.reference = "the finest of --quick";
    return s;
}

/// Deep in still water, a circle that dives and rises while the body turns about all axes: streams from all round.
Six tumbling(double t) {
    return {0.4 * std::cos(1.2 * t),      0.4 * std::sin(1.2 * t),    -1.5 + 0.2 * std::sin(1.7 * t),
            40 * std::sin(1.1 * t + 0.3), 50 * std::sin(0.7 * t + 1), 70 * t};
}

FrontierScene tow(bool quick) {
    Base base;
    base.quick = quick;
    base.shape = shape_of([](std::uint32_t n) { return box_surface({0.2, 0.02, 0.6}, {}, n); });
    FrontierScene& s = base.scene;
    s.what = "a plate of 0.2 x 0.02 x 0.6 m towed in a circle deep under a flat surface while it turns about all axes";
    s.play.name = "tow";
    s.play.seconds = quick ? 1.2 : 6;
    s.play.motion = alone(motion_of(tumbling, s.play.seconds));
    s.standard.map = base.map(base.shape.triangles, base.shape.sources, 8, LawMap().rounding);
    base.map_knobs({50, 500, 8000}, {6, 9, 14, 20, 28, 56, 80, 160, 400}, true);
    base.tick_knob({10, 5, 2, 1, 0.5});
    base.budget_knobs({200, 100, 50, 20, 10, 5, 2, 1, 0}, {0.05, 0.1, 0.2, 0.4, 0});
    base.skip_knob({{"FRICTION", FRM_SKIP_FRICTION}, {"STEADY", FRM_SKIP_STEADY}, {"WET_BODIES", FRM_SKIP_WET_BODIES}});
    base.together_knob();
    base.preset_knob();
    s.finest.push_back(finest_of(base, 0, 0));
    s.reference = "8,000 triangles, 400 sources, 1,026 directions, precision 0.005 %, ticks of 0.5 ms, nothing skipped";
    if (quick) s.reference = "the finest of --quick";
    return s;
}

FrontierScene crowd(bool quick) {
    Base base;
    base.quick = quick;
    base.shape = shape_of([](std::uint32_t n) { return box_surface({0.2, 0.02, 0.6}, {}, n); });
    FrontierScene& s = base.scene;
    s.what = quick ? "60 such plates, each at another point of that motion"
                   : "1,000 such plates, each at another point of that motion";
    s.play.name = "crowd";
    s.play.seconds = 0.4;
    s.play.bodies = quick ? 60 : 1000;
    // Every body is some whole ticks behind the one before: one table has the motion of all.
    constexpr double tick = 0.002;
    constexpr std::uint32_t behind = 3;
    struct Place {
        frm_pose pose;
        frm_twist twist;
    };
    const auto table = std::make_shared<std::vector<Place>>();
    const Motion motion = motion_of(tumbling, 7);
    for (std::uint32_t n = 0; n < behind * s.play.bodies + s.play.seconds / tick + 1; ++n) {
        table->emplace_back();
        motion.at(tick * n, table->back().pose, table->back().twist);
    }
    s.play.motion = [table](double time, std::uint32_t body, frm_pose& pose, frm_twist& twist) {
        const Place& place = (*table)[behind * body + static_cast<std::size_t>(std::lround(time / tick))];
        pose = place.pose;
        twist = place.twist;
        pose.position.x += 2 * (body % 40);
        pose.position.y += 2 * (body / 40);
    };
    s.standard.map = base.map(base.shape.triangles, base.shape.sources, 8, LawMap().rounding);
    const double all = s.play.bodies;
    base.budget_knobs({200, 100, 50, 20, 10, 5, 2, 1, 0}, {0.05 * all, 0.1 * all, 0.15 * all, 0.2 * all, 0.4 * all, 0});
    base.skip_knob({{"FRICTION", FRM_SKIP_FRICTION}, {"STEADY", FRM_SKIP_STEADY}, {"WET_BODIES", FRM_SKIP_WET_BODIES}});
    s.finest.push_back(finest_of(base, 0, 0));
    s.finest.back().dt = s.standard.dt;
    s.reference = "8,000 triangles, 400 sources, 1,026 directions, precision 0.005 %, nothing skipped";
    if (quick) s.reference = "the finest of --quick";
    return s;
}

FrontierScene waves(bool quick) {
    Base base;
    base.quick = quick;
    FrontierScene& s = base.scene;
    s.what =
        "two packets of waves of 0.4 m that run apart (d'Alembert's solution of Eqs. 7 and 8) for 5.5 of their "
        "lengths, "
        "on 8 x 2 m of water 0.5 m deep";
    s.play.name = "waves";
    s.play.bodies = 0;
    s.play.seconds = 1;
    s.play.sample = 0.2;
    const auto packet = [](double x) { return std::exp(-0.5 * x * x / 0.16) * std::cos(2 * pi * x / 0.4); };
    s.play.height = [packet](double x, double) { return 0.01 * packet(x); };
    const double speed = std::sqrt(9.80665 * 0.5);
    s.play.exact_height = [packet, speed](double x, double, double t) {
        return 0.005 * (packet(x - speed * t) + packet(x + speed * t));
    };
    const auto sized = [](Setup& setup, double cell) {
        setup.water->cell = static_cast<float>(cell);
        setup.water->nx = static_cast<std::uint32_t>(std::lround(8 / cell));
        setup.water->ny = static_cast<std::uint32_t>(std::lround(2 / cell));
    };
    s.standard.water = water_of(8, 0.025, 0.5);
    s.standard.water->border = FRM_BORDER_REFLECTING;
    sized(s.standard, 0.025);
    for (const std::uint32_t order : {2u, 4u})
        base.knob(order == 2 ? "cell, order 2" : "cell, order 4", "m",
                  {0.1, 0.05, 0.033333333333333333, 0.025, 0.0125, 0.00625}, order == 2 ? 0.025 : -1,
                  [&](Setup& setup, double v) {
                      sized(setup, v);
                      setup.water->order = order;
                  });
    base.tick_knob({10, 5, 2, 1, 0.5, 0.2});
    return s;
}

}  // namespace

const std::vector<std::string> kPlayedScenes{"stroke", "boat", "tow", "crowd", "waves"};

FrontierScene make_scene(const std::string& name, bool quick) {
    if (name == "stroke") return stroke(quick);
    if (name == "boat") return boat(quick);
    if (name == "tow") return tow(quick);
    if (name == "crowd") return crowd(quick);
    return waves(quick);
}

FrontierScene make_map_scene(const std::vector<std::string>& maps) {
    FrontierScene s;
    s.what = "the body of the maps towed in a circle deep in water without a surface, while it turns about all axes";
    s.play.name = "maps";
    s.play.seconds = 6;
    s.play.motion = alone(motion_of(tumbling, s.play.seconds));
    s.standard.world.surface = FRM_SURFACE_NONE;
    Knob knob{"map", "", {}};
    for (const std::string& path : maps) {
        Choice choice{std::filesystem::path(path).stem().string(), 0, s.standard, false};
        choice.setup.map = std::make_shared<const std::vector<std::uint8_t>>(read_file(path));
        knob.choices.push_back(std::move(choice));
    }
    s.standard = knob.choices.back().setup;
    knob.choices.back().standard = true;
    s.knobs.push_back(std::move(knob));
    // Down to the whole body as one group of sources, which is what a simple model has.
    Knob budget{"time budget", "us", {}};
    for (const double us : {0.05, 0.1, 0.2, 0.0}) {
        budget.choices.push_back({text_of(us, "us"), us, s.standard, us == 0});
        budget.choices.back().setup.world.time_budget = static_cast<float>(us);
    }
    s.knobs.push_back(std::move(budget));
    s.reference = maps.back();
    return s;
}

}  // namespace frm::cli
