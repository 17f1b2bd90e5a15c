"""What all figures of the reports share: colours, style, and a drawing as a data: URI."""
from __future__ import annotations

import base64
import io

import matplotlib
import numpy as np
from matplotlib import patheffects
from matplotlib.figure import Figure
from PIL import Image

# Colours that stay apart for colour-blind eyes (Okabe and Ito); one thing has one colour everywhere.
AXIS_COLOURS = {"x": "#D55E00", "y": "#009E73", "z": "#0072B2"}
INK, QUIET, RULE = "#22303c", "#66727c", "#d9dfe3"
_POINTS = 1200  # of a curve; a longer one keeps the extremes of each stretch

matplotlib.use("Agg")
_STYLE = {
    "font.size": 9, "axes.titlesize": 9, "axes.titleweight": "bold", "axes.titlelocation": "left",
    "axes.edgecolor": QUIET, "axes.labelcolor": INK, "axes.linewidth": 0.7, "text.color": INK,
    "xtick.color": QUIET, "ytick.color": QUIET, "xtick.labelcolor": INK, "ytick.labelcolor": INK,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": RULE,
    "grid.linewidth": 0.6, "axes.axisbelow": True, "legend.frameon": False, "lines.linewidth": 1.3,
    "axes.formatter.useoffset": False, "axes.formatter.limits": (-4, 5), "axes.formatter.use_mathtext": True,
    "svg.hashsalt": "frm", "path.simplify_threshold": 0.3,
}


def styled(draw):
    """A function that draws in the reports' style."""
    def wrapped(*arguments, **options):
        with matplotlib.rc_context(_STYLE):
            return draw(*arguments, **options)
    return wrapped


def canvas(width: float, height: float) -> Figure:
    return Figure(figsize=(width, height), layout="constrained")


def svg(figure: Figure) -> str:
    out = io.BytesIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    return "data:image/svg+xml;base64," + base64.b64encode(out.getvalue()).decode()


def png(figure: Figure, dpi: int) -> str:
    """With a palette: a third of the size, and no difference that an eye would see."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=dpi)
    picture = Image.open(out).convert("RGB").quantize(256)
    out = io.BytesIO()
    picture.save(out, format="png", optimize=True)
    return "data:image/png;base64," + base64.b64encode(out.getvalue()).decode()


def thinned(time: np.ndarray, values: np.ndarray):
    """Fewer points that draw the same curve: the lowest and the highest of each stretch."""
    stretch = len(values) // (_POINTS // 2)
    if stretch < 3:
        return time, values
    whole = len(values) // stretch * stretch
    blocks = np.nan_to_num(values[:whole].reshape(-1, stretch))
    starts = np.arange(0, whole, stretch)
    extremes = [starts + blocks.argmin(1), starts + blocks.argmax(1), [len(values) - 1]]
    rows = np.unique(np.concatenate(extremes))
    return time[rows], values[rows]


def curve(axes, time, values, **style) -> None:
    axes.plot(*thinned(time, values), **style)


def legend_above(axes, columns: int = 4) -> None:
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=columns, borderaxespad=0.1,
                handlelength=1.4, columnspacing=1.2)


def mark(axes, at: float, name: str, level: int, colour: str, left: bool = False) -> None:
    """A name beside a line; each at its own height, because the lines may be close together."""
    axes.annotate(name, (at, 1 - 0.09 * level), xycoords=("data", "axes fraction"),
                  xytext=(-3 if left else 3, -1), textcoords="offset points",
                  va="top", ha="right" if left else "left", fontsize=8, color=colour,
                  path_effects=[patheffects.withStroke(linewidth=2.5, foreground="white")])
