"""The figures of a flow's page; each function gives a data: URI."""
from __future__ import annotations

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, Normalize, TwoSlopeNorm
from matplotlib.patches import Rectangle

from ._drawing import AXIS_COLOURS, INK, QUIET, canvas, curve, legend_above, mark, png, styled, svg
from ._flow import Flow, Slice, knows_grid

COLOURS = {"drag": AXIS_COLOURS["z"], "lift": AXIS_COLOURS["x"], "torque": AXIS_COLOURS["y"]}
BODY = "#4a5560"
# Still water through the stream's speed, suction through its pressure to stagnation: as the stream is nearly white.
SPEED = LinearSegmentedColormap.from_list(
    "frm_speed", ["#0b2a3f", "#0b5a8a", "#8fc1da", "#f6f7f5", "#efbf8f", "#cf7440", "#7c2f10"])
PRESSURE = LinearSegmentedColormap.from_list(
    "frm_pressure", ["#0b3c5d", "#2a78a8", "#8fc1da", "#f6f7f5", "#efbf8f", "#cf7440", "#7c2f10"])
UPSTREAM, DOWNSTREAM, BESIDE = 1.5, 5.0, 1.5  # lengths about the body that the slices show
_PAD = 4  # the spectrum's lines are so many times as close as the record's length gives


@styled
def uncertainty(parts: dict, total: float) -> str:
    """A bar for each part, in per cent; a part that is not known has none."""
    figure = canvas(7.6, 1.9)
    axes = figure.subplots()
    names = ["total", *parts]
    values = [100 * total, *(100 * (value or 0) for value in parts.values())]
    axes.barh(names, values, color=[INK] + [COLOURS["drag"]] * len(parts), height=0.62)
    for at, (name, value) in enumerate(zip(names, values)):
        known = name == "total" or parts[name] is not None
        text = f"{value:.0f} %" if value >= 99.5 else f"{value:.2g} %"
        axes.annotate(text if known else "not measured", (value, at), xytext=(4, 0), textcoords="offset points",
                      va="center", color=INK if known else QUIET)
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    axes.set(xlabel="one standard error as a share of the mean, %", xlim=(0, 1.18 * max(*values, 1e-3)))
    axes.tick_params(axis="y", length=0)
    return svg(figure)


@styled
def series(flow: Flow) -> str:
    """The coefficients over the way of the stream, with their means; the drag's in the band of its uncertainty."""
    curves = flow.coefficients
    figure = canvas(7.6, 1.0 + 1.8 * len(curves))
    rows = np.atleast_1d(figure.subplots(len(curves), 1, sharex=True))
    for axes, (name, values) in zip(rows, curves.items()):
        curve(axes, flow.travelled, values, color=COLOURS[name], linewidth=1.0)
        mean = float(values.mean())
        axes.axhline(mean, color=INK, linewidth=0.9, linestyle=(0, (4, 2)), label="mean")
        if name != "lift":
            off = abs(mean) * flow.json["uncertainty"]
            axes.axhspan(mean - off, mean + off, color=COLOURS[name], alpha=0.14, linewidth=0,
                         label="± uncertainty" if knows_grid(flow.json) else "± uncertainty, without the grid's")
            legend_above(axes)
        axes.set(title="Torque about the axis, N m" if name == "torque" else f"{name.capitalize()} coefficient")
        axes.margins(x=0.01)
    what = "fastest point" if flow.spin_alone else "stream"
    rows[-1].set_xlabel(f"lengths travelled by the {what} since the series began")
    return svg(figure)


def amplitudes(flow: Flow, values: np.ndarray):
    """Frequencies as Strouhal numbers, and the amplitude of a sine that each line would be (Hann window)."""
    window = np.hanning(len(values) + 1)[:-1]
    padded = _PAD * len(values)
    size = 2 * np.abs(np.fft.rfft(window * (values - values.mean()), padded)) / window.sum()
    frequency = np.fft.rfftfreq(padded, flow.json["interval"])
    return frequency * flow.json["length"] / flow.report["fastest"], size


@styled
def spectrum(flow: Flow) -> str:
    """Of the lift along the axis on which it swings most."""
    figure = canvas(7.6, 2.8)
    axes = figure.subplots()
    strouhal, size = amplitudes(flow, flow.coefficients["lift"])
    found = flow.json["strouhal"]
    # Up to five times the shedding; without any, to where all but a hundredth of the energy is.
    energy = np.cumsum(size ** 2)
    end = 5 * found if found else strouhal[min(np.searchsorted(energy, 0.99 * energy[-1]) + 1, len(size) - 1)]
    shown = strouhal <= max(end, strouhal[min(8, len(size) - 1)])
    axes.fill_between(strouhal[shown], size[shown], color=COLOURS["lift"], alpha=0.18, linewidth=0)
    axes.plot(strouhal[shown], size[shown], color=COLOURS["lift"])
    if found:
        axes.axvline(found, color=INK, linewidth=0.9, linestyle=(0, (3, 2)))
        mark(axes, found, f"Strouhal number {found:.4g}", 0, INK)
    axes.set(xlabel="frequency × length / speed", ylabel="amplitude of the lift coefficient", ylim=(0, None))
    axes.margins(x=0.0)
    return svg(figure)


def shown_part(flow: Flow, slice_: Slice):
    """(x low, x high, across low, across high) of what the slices show, m."""
    length, body = flow.report["reference_length"], slice_.body
    wanted = body + length * np.array([-UPSTREAM, DOWNSTREAM, -BESIDE, BESIDE])
    half = (slice_.x[1] - slice_.x[0]) / 2 if len(slice_.x) > 1 else 0
    there = np.array([slice_.x[0] - half, slice_.x[-1] + half, slice_.across[0] - half, slice_.across[-1] + half])
    return np.array([max(wanted[0], there[0]), min(wanted[1], there[1]),
                     max(wanted[2], there[2]), min(wanted[3], there[3])])


def draw_slice(axes, slice_: Slice, values, colours, norm):
    half = (slice_.x[1] - slice_.x[0]) / 2 if len(slice_.x) > 1 else 0.5
    axes.set_facecolor(BODY)
    axes.grid(False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)
    axes.tick_params(labelsize=7.5, length=2)
    axes.set_aspect("equal")
    return axes.imshow(values, origin="lower", cmap=colours, norm=norm, interpolation="nearest",
                       extent=(slice_.x[0] - half, slice_.x[-1] + half,
                               slice_.across[0] - half, slice_.across[-1] + half))


def _scales(flow: Flow):
    """Colours that all slices share: speeds about the stream's, where there is one, and pressures about its."""
    slices = flow.slices
    pressures = np.concatenate([np.abs(one.pressure[np.isfinite(one.pressure)]) for one in slices])
    speeds = np.concatenate([one.speed[np.isfinite(one.speed)] for one in slices])
    limit = max(float(np.quantile(pressures, 0.999)), 0.1) if len(pressures) else 1.0
    fastest = max(float(np.quantile(speeds, 0.999)), 1e-3) if len(speeds) else 1.0
    if flow.spin_alone:
        return Normalize(0, fastest), Normalize(-limit, limit)
    return TwoSlopeNorm(1, 0, max(fastest, 1.05)), Normalize(-limit, limit)


@styled
def slices(flow: Flow, slice_: Slice) -> str:
    """Speed and pressure about the body, one above the other."""
    window = shown_part(flow, slice_)
    width = 7.6
    height = min((width - 1.5) * (window[3] - window[2]) / (window[1] - window[0]), 5.0)
    figure = canvas(width, 2 * (height + 0.45))
    pair = figure.subplots(2, 1, sharex=True)
    norms = _scales(flow)
    for axes, values, colours, norm, title in zip(
            pair, (slice_.speed, slice_.pressure), (SPEED, PRESSURE), norms,
            (f"Speed, shares of {'the fastest point' if flow.spin_alone else 'the stream'}'s",
             "Pressure coefficient")):
        image = draw_slice(axes, slice_, values, colours, norm)
        axes.set(xlim=window[:2], ylim=window[2:], title=title, ylabel=f"{'xyz'[slice_.other]}, m")
        bar = figure.colorbar(image, ax=axes, shrink=0.9, pad=0.015, extend="max" if values is slice_.speed else "both")
        if isinstance(norm, TwoSlopeNorm):  # of its own it marks nothing above the stream's speed
            bar.set_ticks([0, 0.25, 0.5, 0.75, 1, round((1 + norm.vmax) / 2, 2), round(norm.vmax, 2)])
            bar.ax.yaxis.set_major_formatter(lambda at, _: f"{at:g}")
    pair[1].set_xlabel("x, along the stream, m")
    return png(figure, 150)


@styled
def grid(flow: Flow, slice_: Slice) -> str:
    """The boxes of the grid over the speed: all of them, and those about the body."""
    cut = [block for block in flow.json["blocks"]
           if block["low"][slice_.normal] <= slice_.place <= block["high"][slice_.normal]]
    blocks = cut or flow.json["blocks"]  # a section's may have no height
    low = np.array([block["low"] for block in blocks])[:, [0, slice_.other]]
    high = np.array([block["high"] for block in blocks])[:, [0, slice_.other]]
    whole = np.array([low[:, 0].min(), high[:, 0].max(), low[:, 1].min(), high[:, 1].max()])
    finest = min(block["cell"] for block in blocks)
    near = np.array([block["cell"] < 1.5 * finest for block in blocks])
    close = np.array([low[near, 0].min(), high[near, 0].max(), low[near, 1].min(), high[near, 1].max()])
    middle = (close[0::2] + close[1::2]) / 2
    half = np.maximum((close[1::2] - close[0::2]) * 0.75, 1.2 * flow.report["reference_length"])
    close = np.array([middle[0] - half[0], middle[0] + half[0], middle[1] - half[1], middle[1] + half[1]])
    figure = canvas(7.6, 3.3)
    levels = sorted({round(np.log2(block["cell"] / finest)) for block in blocks})
    shades = [AXIS_COLOURS["x"], AXIS_COLOURS["y"], AXIS_COLOURS["z"], "#CC79A7", "#E69F00", "#56B4E9"]
    left, right = figure.subplots(1, 2)
    for axes, view, title in ((left, whole, "All of the grid"), (right, close, "About the body")):
        draw_slice(axes, slice_, slice_.speed, SPEED, _scales(flow)[0]).set_alpha(0.55)
        axes.set_facecolor("white")
        solid = np.where(np.isnan(slice_.speed), 1.0, np.nan)
        draw_slice(axes, slice_, solid, LinearSegmentedColormap.from_list("frm_body", [BODY, BODY]), None)
        axes.set_facecolor("white")
        for block, corner, far in zip(blocks, low, high):
            level = round(np.log2(block["cell"] / finest))
            axes.add_patch(Rectangle(corner, *(far - corner), fill=False, linewidth=1.0,
                                     edgecolor=shades[levels.index(level) % len(shades)]))
        margin = 0.02 * max(view[1] - view[0], view[3] - view[2])
        axes.set(xlim=(view[0] - margin, view[1] + margin), ylim=(view[2] - margin, view[3] + margin), title=title,
                 xlabel="x, along the stream, m")
    left.set_ylabel(f"{'xyz'[slice_.other]}, m")
    handles = [Rectangle((0, 0), 1, 1, fill=False, edgecolor=shades[at % len(shades)]) for at in range(len(levels))]
    right.legend(handles, [f"{1e3 * finest * 2 ** level:.3g} mm" for level in levels], title="cells of",
                 loc="center left", bbox_to_anchor=(1.02, 0.5), borderaxespad=0)
    return png(figure, 150)
