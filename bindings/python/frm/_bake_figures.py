"""The figures of a bake's page; each function gives a data: URI."""
from __future__ import annotations

import colorsys

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from ._bake import Bake, Lattice, running
from ._drawing import AXIS_COLOURS, INK, QUIET, RULE, canvas, curve, mark, png, styled
from ._flow_figures import COLOURS, SPEED, UPSTREAM, amplitudes, draw_slice, shown_part

# Light to dark, so that a print in grey still tells which is more.
AMOUNT = LinearSegmentedColormap.from_list("frm_amount", ["#eef4f7", "#a9d0e2", "#4f9cc4", "#0b5a8a", "#0b2a3f"])
ERROR = LinearSegmentedColormap.from_list("frm_error", ["#fdf3e3", "#efbf8f", "#cf7440", "#7c2f10", "#3c1206"])
STEP = LinearSegmentedColormap.from_list("frm_step", ["#e8d9c4", "#a9d0e2", "#4f9cc4", "#0b5a8a", "#0b2a3f"])
STEP.set_under("#cf7440")
_FASTEST = 2  # speed where the colours of the small slices end, shares of the stream's (a spin's fastest point's)
_LONG = 2.2  # a body longer than so many times its height is seen in pictures one below the other


# ---- The body --------------------------------------------------------------------------------------------------------

def region_colours(count: int) -> np.ndarray:
    """Hues by the golden ratio, in three tones: regions of neighbouring numbers, which are often neighbours, differ."""
    tones = ((0.42, 0.95), (0.58, 0.85), (0.34, 0.99))
    return np.array([colorsys.hsv_to_rgb(0.07 + 0.618034 * at % 1, *tones[at % 3]) for at in range(count)])


def views(low: np.ndarray, high: np.ndarray):
    """Three (name, right, up, towards the eye): face-on and back with the longest extent across, and from a corner."""
    extent = high - low
    across, thin = int(np.argmax(extent)), int(np.argmin(extent))
    if across == thin:
        across, thin = 0, 2
    axes = np.eye(3)
    right, eye = axes[across], axes[thin]
    up = np.cross(eye, right)
    corner = 0.45 * right + 0.62 * up + 0.85 * eye
    corner /= np.linalg.norm(corner)
    slanted = right - corner * (right @ corner)
    slanted /= np.linalg.norm(slanted)
    name = "xyz"[thin]
    return [(f"from +{name}", right, up, eye), (f"from −{name}", right, -up, -eye),
            ("from a corner", slanted, np.cross(corner, slanted), corner)]


def _draw_body(axes, bake: Bake, view) -> None:
    name, right, up, eye = view
    corners = bake.surface("vertices")[bake.surface("triangles").astype(int)]
    begin = bake.surface("region_begin").astype(int).ravel()
    region = np.repeat(np.arange(len(begin) - 1), np.diff(begin))
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    normal /= np.where(size > 0, size, 1)[:, None]
    order = np.argsort(corners.mean(1) @ eye)  # painter's algorithm: the nearest last
    order = order[normal[order] @ eye > 0]
    light = eye + 0.5 * up - 0.4 * right
    shade = 0.62 + 0.38 * np.maximum(normal[order] @ (light / np.linalg.norm(light)), 0)
    colours = region_colours(len(begin) - 1)[region[order]] * shade[:, None]
    flat = np.stack([corners[order] @ right, corners[order] @ up], axis=2)
    axes.add_collection(PolyCollection(flat, facecolors=colours, edgecolors=colours, linewidths=0.7))
    sources = bake.surface("sources")
    seen = sources[sources[:, 3:] @ eye > 0.05, :3]
    axes.plot(seen @ right, seen @ up, "o", color=INK, markersize=3.2 if len(sources) < 100 else 1.6,
              markeredgecolor="white", markeredgewidth=0.5)
    low, high = flat.reshape(-1, 2).min(0), flat.reshape(-1, 2).max(0)
    margin = 0.06 * (high - low).max()
    axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin), aspect="equal",
             title=name[:1].upper() + name[1:])
    axes.grid(False)
    axes.set_xticks([])
    axes.set_yticks([])
    for side in ("left", "bottom"):
        axes.spines[side].set_visible(False)


def _draw_triad(axes, view) -> None:
    """The mesh's axes as the view shows them."""
    name, right, up, eye = view
    axes.set(xlim=(-1.5, 1.5), ylim=(-1.5, 1.5), aspect="equal")
    axes.axis("off")
    for at, letter in enumerate("xyz"):
        tip = np.array([right[at], up[at]])
        if np.linalg.norm(tip) < 0.05:
            continue
        axes.annotate("", tip, (0, 0), arrowprops={"arrowstyle": "-|>", "color": AXIS_COLOURS[letter], "linewidth": 1.2,
                                                   "shrinkA": 0, "shrinkB": 0})
        axes.text(*(1.28 * tip), letter, color=AXIS_COLOURS[letter], ha="center", va="center", fontsize=8)


@styled
def body(bake: Bake) -> str:
    """The surface from three sides in the colours of its regions, with the sources that are seen."""
    low, high = np.array(bake.json["body"]["low"]), np.array(bake.json["body"]["high"])
    three = views(low, high)
    extent = np.sort(high - low)
    if extent[2] > _LONG * extent[1]:
        figure = canvas(7.6, min(1.0 + 3 * (7.0 * extent[1] / extent[2] + 0.35), 7.5))
        cells = figure.subplots(3, 2, gridspec_kw={"width_ratios": [7, 0.7]})
        pairs = [(row[0], row[1]) for row in cells]
    else:
        figure = canvas(7.6, 3.1)
        cells = figure.subplots(2, 3, gridspec_kw={"height_ratios": [3, 0.8]})
        pairs = list(zip(cells[0], cells[1]))
    for (axes, triad), view in zip(pairs, three):
        _draw_body(axes, bake, view)
        _draw_triad(triad, view)
    return png(figure, 150)


# ---- The sphere of directions ----------------------------------------------------------------------------------------

def mollweide(directions: np.ndarray):
    """(x, y) of unit directions: equal areas, +x in the middle, +z above, +y to the right."""
    e = np.atleast_2d(directions)
    latitude, longitude = np.arcsin(np.clip(e[:, 2], -1, 1)), np.arctan2(e[:, 1], e[:, 0])
    theta = latitude.copy()
    for _ in range(60):
        slope = 2 + 2 * np.cos(2 * theta)
        theta -= (2 * theta + np.sin(2 * theta) - np.pi * np.sin(latitude)) / np.where(slope > 1e-9, slope, np.inf)
    return 2 * np.sqrt(2) / np.pi * longitude * np.cos(theta), np.sqrt(2) * np.sin(theta)


def unmollweide(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Unit directions of points; NaN beside the ellipse."""
    with np.errstate(invalid="ignore", divide="ignore"):
        theta = np.arcsin(y / np.sqrt(2))
        latitude = np.arcsin((2 * theta + np.sin(2 * theta)) / np.pi)
        longitude = np.pi * x / (2 * np.sqrt(2) * np.cos(theta))
    longitude = np.where(np.abs(longitude) > np.pi, np.nan, longitude)
    return np.stack([np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)], -1)


def _globe(axes, title: str) -> None:
    root = np.sqrt(2)
    axes.add_patch(Ellipse((0, 0), 4 * root, 2 * root, fill=False, edgecolor=QUIET, linewidth=0.8, zorder=5))
    axes.set(xlim=(-2.2 * root, 2.2 * root), ylim=(-1.16 * root, 1.16 * root), aspect="equal")
    axes.axis("off")
    axes.set_title(title, loc="left")
    below = -0.115 * root  # so as not to lie on the dot that is there
    for name, at in (("+x", (0, below)), ("+y", (root, below)), ("−y", (-root, below)), ("+z", (0, 1.085 * root)),
                     ("−z", (0, -1.085 * root)), ("−x", (2.12 * root, 0)), ("−x", (-2.12 * root, 0))):
        axes.text(*at, name, fontsize=7.5, color=INK, ha="center", va="center", zorder=9,
                  bbox={"boxstyle": "round,pad=0.12", "facecolor": "white", "edgecolor": "none", "alpha": 0.75})


def _field(axes, frequency: int, values: np.ndarray, colours, norm):
    """Values of a lattice's directions, and what the map makes of them between."""
    x, y = np.meshgrid(np.linspace(-2, 2, 360) * np.sqrt(2), np.linspace(-1, 1, 180) * np.sqrt(2))
    e = unmollweide(x, y)
    there = np.isfinite(e).all(-1)
    drawn = np.full(x.shape, np.nan)
    drawn[there] = Lattice(frequency).interpolate(e[there], values)
    half = np.sqrt(2) / 179
    return axes.imshow(drawn, origin="lower", cmap=colours, norm=norm, interpolation="nearest",
                       extent=(-2 * np.sqrt(2) - half, 2 * np.sqrt(2) + half, -np.sqrt(2) - half, np.sqrt(2) + half))


def _images(bake: Bake):
    """(directions that are known by symmetry alone, those that were solved)"""
    all_of = [bake.array(flow["images"]) for flow in bake.base]
    images = np.concatenate([one[1:] for one in all_of])
    return images, np.array([flow["direction"] for flow in bake.base])


@styled
def directions(bake: Bake) -> str:
    """The mean drag over the sphere with what was solved, and how well each flow is predicted by the others."""
    judged = [flow for flow in bake.base if flow["left_out"] is not None]
    figure = canvas(7.6, 6.6 if judged else 3.3)
    above, *more = np.ravel(figure.subplots(2 if judged else 1, 1))
    image = _field(above, bake.map["frequency"], bake.drag, AMOUNT, Normalize(0, max(float(bake.drag.max()), 1e-12)))
    _globe(above, "Mean drag in the map, and where it was solved")
    figure.colorbar(image, ax=above, shrink=0.75, pad=0.01, label="N")
    images, solved = _images(bake)
    if len(images):
        above.plot(*mollweide(images), "o", markersize=4, markerfacecolor="none", markeredgecolor=AXIS_COLOURS["x"],
                   markeredgewidth=0.9, zorder=7, label="known by symmetry")
    above.plot(*mollweide(solved), "o", markersize=6, color=AXIS_COLOURS["x"], markeredgecolor="white",
               markeredgewidth=0.8, zorder=8, label="solved")
    above.legend(loc="lower left", bbox_to_anchor=(-0.01, -0.04), fontsize=8)
    if not judged:
        return png(figure, 150)
    below = more[0]
    errors = np.array([100 * flow["left_out"] for flow in judged])
    norm = Normalize(0, max(float(errors.max()), 1e-3))
    for flow, error in zip(judged, errors):
        x, y = mollweide(bake.array(flow["images"]))
        below.scatter(x, y, c=np.full(len(x), error), s=26, cmap=ERROR, norm=norm, edgecolors=QUIET, linewidths=0.4,
                      zorder=7)
    x, y = mollweide(solved)
    points = below.scatter(x, y, c=errors, s=62, cmap=ERROR, norm=norm, edgecolors=INK, linewidths=1.0, zorder=8)
    _globe(below, "Error of each flow as all others predict it")
    figure.colorbar(points, ax=below, shrink=0.75, pad=0.01, label="% of the largest force")
    return png(figure, 150)


@styled
def fluctuations(bake: Bake) -> str:
    """How strongly the force swings over the sphere, and how well neighbours are in step."""
    figure = canvas(7.6, 6.6)
    above, below = figure.subplots(2, 1)
    image = _field(above, bake.map["fluctuation_frequency"], bake.rms, AMOUNT,
                   Normalize(0, max(float(bake.rms.max()), 1e-12)))
    _globe(above, "Strength of the fluctuation (rms of the force on the whole body)")
    figure.colorbar(image, ax=above, shrink=0.75, pad=0.01, label="N")
    places = bake.array(bake.json["fluctuation_directions"])
    above.plot(*mollweide(places), ".", markersize=3, color=INK, zorder=7)
    pairs, step = bake.neighbours
    share = np.linspace(0, 1, 12)[:, None]
    lines, colours = [], []
    for (a, b), value in zip(pairs, step):
        way = places[a] * (1 - share) + places[b] * share
        x, y = mollweide(way / np.linalg.norm(way, axis=1, keepdims=True))
        # A line over the edge of the picture is two.
        cuts = np.flatnonzero(np.abs(np.diff(x)) > 2) + 1
        for part in np.split(np.stack([x, y], 1), cuts):
            lines.append(part)
            colours.append(value)
    drawn = LineCollection(lines, cmap=STEP, norm=Normalize(0, 1), linewidths=2.6, zorder=6)
    drawn.set_array(np.ma.masked_invalid(colours))
    below.add_collection(drawn)
    below.scatter(*mollweide(places), s=8 + 60 * bake.rms / max(float(bake.rms.max()), 1e-12), color=INK, zorder=7)
    _globe(below, "How well neighbours swing together (1: in step, 0: not at all)")
    figure.colorbar(drawn, ax=below, shrink=0.75, pad=0.01, label="correlation", extend="min")
    return png(figure, 150)


# ---- One flow --------------------------------------------------------------------------------------------------------

_PANELS = ((0.045, 0.315), (0.405, 0.165), (0.62, 0.155), (0.815, 0.18))  # left edge and width, shares of the figure's


@styled
def flow(bake: Bake, one: dict) -> str:
    """Series, spectrum, running mean, slice: a strip."""
    series = bake.flow(one)
    figure = Figure(figsize=(10.4, 1.95))
    panels = [figure.add_axes((left, 0.2, width, 0.65)) for left, width in _PANELS]
    curves = series.coefficients
    name = "torque" if series.spin_alone else "drag"
    time, values = series.travelled, curves[name]
    for what, drawn in curves.items():
        curve(panels[0], time, drawn, color=COLOURS[what], linewidth=1.0, label=what)
    panels[0].axhline(values.mean(), color=INK, linewidth=0.8, linestyle=(0, (4, 2)), label="mean")
    panels[0].set(title="Torque, N m" if series.spin_alone else "Coefficients", xlabel="lengths travelled")
    panels[0].margins(x=0.01)
    panels[0].legend(loc="lower right", bbox_to_anchor=(1.02, 0.98), ncol=3, fontsize=7, handlelength=1.2,
                     columnspacing=1.0, borderaxespad=0)
    swung = "lift" if "lift" in curves else name
    strouhal, size = amplitudes(series, curves[swung])
    found = one["strouhal"]
    energy = np.cumsum(size ** 2)
    end = 5 * found if found else strouhal[min(np.searchsorted(energy, 0.99 * energy[-1]) + 1, len(size) - 1)]
    shown = strouhal <= max(end, strouhal[min(8, len(size) - 1)])
    panels[1].fill_between(strouhal[shown], size[shown], color=COLOURS[swung], alpha=0.18, linewidth=0)
    panels[1].plot(strouhal[shown], size[shown], color=COLOURS[swung], linewidth=1.0)
    if found:
        panels[1].axvline(found, color=INK, linewidth=0.8, linestyle=(0, (3, 2)))
        mark(panels[1], found, f"St {found:.3g}", 0, INK)
    panels[1].set(title=f"Spectrum of the {swung}", xlabel="frequency × length / speed", ylim=(0, None))
    panels[1].margins(x=0)
    counts, means, errors = running(values)
    at = time[counts - 1]
    panels[2].fill_between(at, means - errors, means + errors, color=COLOURS[name], alpha=0.2, linewidth=0)
    panels[2].plot(at, means, color=COLOURS[name], linewidth=1.1)
    # The first means are of next to nothing: what is to be seen is whether the last ones still move.
    late = counts >= 0.25 * counts[-1]
    low, high = (means - errors)[late].min(), (means + errors)[late].max()
    pad = 0.25 * max(high - low, 0.01 * abs(means[-1]), 1e-12)
    panels[2].set(title=f"Mean {name} so far", xlabel="lengths travelled", xlim=(0, at[-1]),
                  ylim=(low - pad, high + pad))
    if series.slices:
        part = shown_part(series, series.slices[0])
        if series.spin_alone:  # there is no wake to one side
            part[1] = min(part[1], series.slices[0].body[1] + UPSTREAM * one["reference_length"])
        draw_slice(panels[3], series.slices[0], series.slices[0].speed, SPEED, Normalize(0, _FASTEST))
        panels[3].set(xlim=part[:2], ylim=part[2:], title="Speed", anchor="W")
        panels[3].set_xticks([])
        panels[3].set_yticks([])
    else:
        panels[3].axis("off")
    for axes in panels:
        axes.tick_params(labelsize=7, length=2)
        axes.xaxis.label.set_size(7.5)
        axes.title.set_size(8)
    return png(figure, 120)


@styled
def speed_key() -> str:
    """The colours of the slices."""
    figure = Figure(figsize=(10.4, 0.5))
    axes = figure.add_axes((0.46, 0.5, 0.4, 0.3))
    axes.imshow(np.linspace(0, _FASTEST, 200)[None], aspect="auto", cmap=SPEED, norm=Normalize(0, _FASTEST),
                extent=(0, _FASTEST, 0, 1))
    axes.grid(False)
    axes.set_yticks([])
    axes.tick_params(labelsize=7.5, length=2)
    figure.text(0.45, 0.62, "speed, shares of the stream's (of a spin: the fastest point's)", ha="right", va="center",
                fontsize=8)
    for spine in axes.spines.values():
        spine.set_color(RULE)
    return png(figure, 120)
