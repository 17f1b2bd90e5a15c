"""The figures of a report, drawn by matplotlib without a screen; each function gives a data: URI."""
from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib import patheffects
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from ._drawing import AXIS_COLOURS, INK, QUIET, canvas, curve, legend_above, mark, png, styled, svg
from ._replayed import PARTS, STATES, BodySeries, Frame, Replayed

# Trough to crest through calm, which is nearly white.
WATER = LinearSegmentedColormap.from_list(
    "frm_water", ["#0b3c5d", "#2a78a8", "#8fc1da", "#f6f7f5", "#efbf8f", "#cf7440", "#7c2f10"])
BUDGET_US = 2000.0  # one tick at 500 Hz
CUT = 2.0  # where the oblique view cuts splashes, in units of the colours' limit

def _vector(axes, time, vectors, magnitude=True) -> None:
    if magnitude:
        curve(axes, time, np.linalg.norm(vectors, axis=1), color=INK, linewidth=0.9, alpha=0.55,
               label="magnitude")
    for axis, (name, colour) in enumerate(AXIS_COLOURS.items()):
        curve(axes, time, vectors[:, axis], color=colour, label=name)


@styled
def forces(replayed: Replayed, body: BodySeries) -> str:
    """Total force and torque over time."""
    figure = canvas(7.6, 4.6)
    upper, lower = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": (3, 2)})
    _vector(upper, replayed.time, body.force[:, 0])
    _vector(lower, replayed.time, body.torque[:, 0])
    row = int(np.nanargmax(body.magnitude))
    upper.plot(replayed.time[row], body.magnitude[row], "o", color=INK, markersize=4.5)
    right = row > 0.75 * replayed.ticks
    upper.annotate(f"peak {body.magnitude[row]:.3g} N", (replayed.time[row], body.magnitude[row]),
                   xytext=(-6 if right else 6, 2), textcoords="offset points",
                   ha="right" if right else "left")
    upper.set(title="Force on the body", ylabel="N")
    lower.set(title="Torque about its origin", ylabel="N m", xlabel="time, s")
    upper.margins(x=0.01, y=0.1)
    legend_above(upper)
    return svg(figure)


@styled
def parts(replayed: Replayed, body: BodySeries) -> str:
    """The force by its four parts, each with a scale of its own."""
    figure = canvas(7.6, 4.6)
    grid = figure.subplots(2, 2, sharex=True).ravel()
    for axes, (part, name) in zip(grid, list(enumerate(PARTS))[1:]):
        _vector(axes, replayed.time, body.force[:, part], magnitude=False)
        axes.set_title(name.capitalize())
        axes.set_ylabel("N")
        axes.margins(x=0.01)
        # A part that is not there would otherwise show rounding as a curve.
        if not np.nanmax(np.abs(body.force[:, part])) > 0:
            axes.set_ylim(-1, 1)
    for axes in grid[2:]:
        axes.set_xlabel("time, s")
    legend_above(grid[1], 3)
    return svg(figure)


@styled
def motion(replayed: Replayed, body: BodySeries) -> str:
    """How deep and how fast the body went."""
    figure = canvas(7.6, 4.8)
    height, speed, wet = figure.subplots(3, 1, sharex=True)
    state = dict(zip(STATES, body.state.T))
    curve(height, replayed.time, body.position[:, 2], color=AXIS_COLOURS["z"])
    height.set(title="Height of the body's origin (z)", ylabel="m")
    curve(speed, replayed.time, body.speed, color=QUIET, label="of the origin")
    # Without a wet source there is no such speed.
    relative = np.where(state["wet_sources"] > 0, state["relative_speed"], np.nan)
    curve(speed, replayed.time, relative, color=AXIS_COLOURS["x"],
           label="relative to the water, mean of the wet sources")
    speed.set(title="Speed", ylabel="m/s", ylim=(0, None))
    legend_above(speed, 2)
    curve(wet, replayed.time, state["wet_area"], color=AXIS_COLOURS["y"])
    wet.set(title="Wet area", ylabel="m²", xlabel="time, s", ylim=(0, None))
    height.margins(x=0.01)
    return svg(figure)


class FrameScale:
    """What all frames share, so that they can be compared: colours, window and lengths of arrows."""

    def __init__(self, replayed: Replayed):
        self.water = water = replayed.water
        self.x = water.centre_x + (np.arange(water.nx) - (water.nx - 1) / 2) * water.cell
        self.y = water.centre_y + (np.arange(water.ny) - (water.ny - 1) / 2) * water.cell
        heights = np.abs([frame.height for frame in replayed.frames])
        # One cell's splash must not wash out the rest.
        self.limit = max(float(np.quantile(heights, 0.995)), 0.2 * float(heights.max()), 1e-6)
        self._window(replayed)
        self.total = max((np.linalg.norm(force) for frame in replayed.frames
                          for _, force, _ in frame.bodies.values()), default=0.0)
        self.source = max((np.linalg.norm(sources["force"], axis=1).max(initial=0)
                           for frame in replayed.frames for _, _, sources in frame.bodies.values()),
                          default=0.0)

    def _window(self, replayed: Replayed) -> None:
        """All of the bodies' ways, and at least half of the field; without bodies all of it."""
        low, high = np.array([self.x[0], self.y[0]]), np.array([self.x[-1], self.y[-1]])
        points = [sources["position"][:, :2]
                  for frame in replayed.frames for _, _, sources in frame.bodies.values()]
        points = np.concatenate(points) if points else np.array([low, high])
        near, far = np.clip(points.min(0), low, high), np.clip(points.max(0), low, high)
        half = np.maximum((far - near) / 2 * 1.1, (high - low) / 4)
        # At most twice as wide as high, and the reverse, so that the pictures fill their places.
        half = np.minimum(np.maximum(half, half[::-1] / 2), (high - low) / 2)
        middle = np.clip((near + far) / 2, low + half, high - half)
        self.low, self.high = middle - half, middle + half

    @property
    def clipped(self) -> bool:
        """Whether the window leaves a part of the field out."""
        cell = 2 * self.water.cell
        return bool((self.low > [self.x[0] + cell, self.y[0] + cell]).any()
                    or (self.high < [self.x[-1] - cell, self.y[-1] - cell]).any())


@styled
def colour_bar(scale: FrameScale) -> str:
    figure = canvas(7.6, 0.62)
    axes = figure.subplots()
    limit = scale.limit * 1e3
    colours = matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(-limit, limit), WATER)
    figure.colorbar(colours, cax=axes, orientation="horizontal", extend="both",
                    label="water height above calm, mm")
    return svg(figure)


@styled
def frame(scale: FrameScale, shown: Frame) -> str:
    """The surface from above, with the sources and the horizontal part of their forces."""
    across = scale.high - scale.low
    width = 3.5
    figure = canvas(width, (width - 0.45) * across[1] / across[0] + 0.36)
    axes = figure.subplots()
    axes.grid(False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)
    half = scale.water.cell / 2
    limit = scale.limit * 1e3
    axes.imshow(shown.height * 1e3, origin="lower", cmap=WATER, vmin=-limit, vmax=limit,
                extent=(scale.x[0] - half, scale.x[-1] + half, scale.y[0] - half, scale.y[-1] + half),
                interpolation="bilinear")
    axes.set(xlim=(scale.low[0], scale.high[0]), ylim=(scale.low[1], scale.high[1]), aspect="equal")
    axes.tick_params(labelsize=7, length=2)
    axes.set_xlabel("x, m", fontsize=7.5, labelpad=1)
    axes.set_ylabel("y, m", fontsize=7.5, labelpad=1)
    halo = [patheffects.withStroke(linewidth=2.4, foreground="white", alpha=0.85)]
    length = 0.28 * min(across)
    for origin, force, sources in shown.bodies.values():
        position = sources["position"]
        wet = sources["wet_ratio"] > 0
        axes.scatter(*position[~wet, :2].T, s=5, facecolors="none", edgecolors=QUIET, linewidths=0.5)
        axes.scatter(*position[wet, :2].T, s=5, color=INK, linewidths=0)
        if scale.source > 0:
            _arrows(axes, position, sources["force"] * (0.6 * length / scale.source), 0.0035, "#3f4b55")
        if scale.total > 0:
            _arrows(axes, origin[None], force[None] * (length / scale.total), 0.013, "black", halo)
    if scale.total > 0:
        _scale_arrow(axes, scale, length, halo)
    axes.text(0.03, 0.965, f"{shown.time:.3f} s", transform=axes.transAxes, va="top", fontsize=9,
              fontweight="bold", path_effects=halo)
    return png(figure, 150)


def _arrows(axes, positions, vectors, width, colour, effects=None) -> None:
    axes.quiver(*positions[:, :2].T, *vectors[:, :2].T, angles="xy", scale_units="xy", scale=1, width=width,
                color=colour, path_effects=effects, zorder=3, minlength=0)


def _scale_arrow(axes, scale: FrameScale, length: float, halo) -> None:
    """A round number of newtons, as long as such a force on the body is drawn."""
    decade = 10 ** np.floor(np.log10(scale.total))
    value = max(step * decade for step in (1, 2, 5) if step * decade <= scale.total * 1.0001)
    low, across = scale.low, scale.high - scale.low
    start = low + 0.05 * across
    _arrows(axes, start[None], np.array([[length * value / scale.total, 0]]), 0.013, "black", halo)
    axes.text(start[0], start[1] + 0.03 * across[1], f"{value:g} N", fontsize=7.5, path_effects=halo)


@styled
def oblique(scale: FrameScale, shown: Frame) -> tuple[str, float]:
    """The surface in space at one time; also how much higher than true it is drawn."""
    figure = Figure(figsize=(7.6, 3.7))
    axes = figure.add_axes((-0.19, -0.48, 1.38, 1.96), projection="3d", computed_zorder=False)
    columns = np.nonzero((scale.x >= scale.low[0]) & (scale.x <= scale.high[0]))[0]
    rows = np.nonzero((scale.y >= scale.low[1]) & (scale.y <= scale.high[1]))[0]
    step = max(1, int(np.ceil(max(len(rows), len(columns)) / 160)))
    columns, rows = columns[::step], rows[::step]
    height = np.clip(shown.height[np.ix_(rows, columns)], -CUT * scale.limit, CUT * scale.limit)
    across = scale.high - scale.low
    exaggeration = float(f"{0.05 * max(across) / scale.limit:.1g}")
    x, y = np.meshgrid(scale.x[columns], scale.y[rows])
    light = matplotlib.colors.LightSource(azdeg=300, altdeg=40)
    colours = WATER(np.clip(height / (2 * scale.limit) + 0.5, 0, 1))
    shaded = light.shade_rgb(colours[..., :3], height * exaggeration, dx=scale.water.cell * step,
                             dy=scale.water.cell * step, blend_mode="soft", fraction=0.9)
    axes.plot_surface(x, y, height * exaggeration, facecolors=shaded, rstride=1, cstride=1, linewidth=0,
                      antialiased=False, shade=False)
    for origin, force, _ in shown.bodies.values():
        if scale.total > 0:
            arrow = force * (0.3 * max(across) / scale.total)
            surface = _height_at(scale, shown, origin) * exaggeration
            axes.quiver(origin[0], origin[1], surface, *arrow, color="black", linewidth=2.2, zorder=10,
                        arrow_length_ratio=0.18)
    axes.set_box_aspect((*across, 0.35 * max(across)), zoom=1.0)
    axes.set(xlim=(scale.low[0], scale.high[0]), ylim=(scale.low[1], scale.high[1]),
             zlim=(-0.175 * max(across), 0.175 * max(across)))
    axes.view_init(elev=32, azim=-62)
    axes.set_axis_off()
    return png(figure, 180), exaggeration


def _height_at(scale: FrameScale, shown: Frame, position) -> float:
    column = int(np.clip(np.searchsorted(scale.x, position[0]), 0, len(scale.x) - 1))
    row = int(np.clip(np.searchsorted(scale.y, position[1]), 0, len(scale.y) - 1))
    return float(shown.height[row, column])


@styled
def tick_times(tick_us: dict) -> str:
    """The histogram of tick times on logarithmic axes."""
    edges = np.asarray(tick_us["histogram"]["edges_us"], float)
    counts = np.asarray(tick_us["histogram"]["counts"], float)
    if edges[0] <= 0:
        edges[0] = edges[1] / 2
    figure = canvas(7.6, 3.0)
    axes = figure.subplots()
    axes.stairs(counts, edges, fill=True, color="#8fc1da", edgecolor="#2a78a8", linewidth=0.6, baseline=0.6)
    axes.set(xscale="log", yscale="log", xlabel="time of a tick, µs", ylabel="ticks in the bin")
    filled = np.nonzero(counts)[0]
    low, high = edges[filled[0]] / 1.3, max(edges[filled[-1] + 1], tick_us["max"]) * 1.3
    # The budget is shown when it is near enough not to squeeze the histogram.
    if high > BUDGET_US / 4:
        high = max(high, BUDGET_US * 1.3)
        axes.axvline(BUDGET_US, color=AXIS_COLOURS["x"], linewidth=1.4)
        mark(axes, BUDGET_US, "500 Hz budget", 0, AXIS_COLOURS["x"], left=True)
    axes.set(xlim=(low, high), ylim=(0.6, counts.max() * 1.6))
    for level, (key, name) in enumerate((("median", "median"), ("p99", "99 %"), ("p9999", "99.99 %"),
                                         ("max", "slowest"))):
        axes.axvline(tick_us[key], color=INK, linewidth=0.9, linestyle=(0, (3, 2)))
        mark(axes, tick_us[key], name, level, INK)
    axes.xaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    return svg(figure)
