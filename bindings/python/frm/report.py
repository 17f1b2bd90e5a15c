"""A recording as one page: python3 -m frm.report RECORDING -o report.html [--run run.json]

Replays the recording, compares it bit for bit, and writes an HTML file that holds everything it shows. Needs
numpy and matplotlib (apt install python3-matplotlib).
"""
from __future__ import annotations

import argparse
import importlib.util
import json
import os
import sys
import tempfile
from pathlib import Path

from ._base import Error
from ._library import LibraryError


class Unusable(Exception):
    """An input of the report that cannot be used; the text says why."""


def read_run(path) -> dict:
    """What `frm run` wrote about the run."""
    try:
        run = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise Unusable(f"{path}: {error.strerror}") from None
    except ValueError as error:
        raise Unusable(f"{path} is not JSON: {error}") from None
    if not isinstance(run, dict):
        raise Unusable(f"{path} is not the summary of a run: no JSON object")
    tick_us = run.get("tick_us")
    if tick_us is not None:
        histogram = tick_us.get("histogram", {}) if isinstance(tick_us, dict) else {}
        missing = [key for key in ("median", "p99", "p9999", "max", "mean") if key not in tick_us]
        if missing:
            raise Unusable(f"{path}: tick_us lacks {', '.join(missing)}")
        edges, counts = (histogram.get(key, ()) for key in ("edges_us", "counts"))
        if not counts or len(edges) != len(counts) + 1:
            raise Unusable(f"{path}: tick_us.histogram needs n counts and n + 1 edges_us")
    return run


def write_report(recording, output, run: dict | None = None, frames: int = 12) -> None:
    """Writes the page about a recording; `output` appears whole or not at all."""
    from . import _page, _replayed
    replayed = _replayed.collect(os.fspath(recording), frames)
    write_whole(Path(output), _page.page(replayed, Path(recording), run or {}))


def write_whole(output: Path, page: str) -> None:
    handle, temporary = tempfile.mkstemp(prefix=f".{output.name}.", dir=output.parent)
    try:
        with open(handle, "w", encoding="utf-8", newline="\n") as file:
            file.write(page)
        # mkstemp makes files for one user only; a report is an ordinary file.
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)
        os.replace(temporary, output)
    except BaseException:
        os.unlink(temporary)
        raise


def run_program(name: str, output, draw) -> int:
    """Calls `draw`; the exit status. What went wrong is told on standard error, of `output` where no file is named."""
    if any(importlib.util.find_spec(package) is None for package in ("numpy", "matplotlib")):
        print(f"{name}: matplotlib is not installed; apt install python3-matplotlib", file=sys.stderr)
        return 1
    try:
        draw()
    except (Error, LibraryError, Unusable) as error:
        text = error.text if isinstance(error, Error) and error.text else error
        print(f"{name}: {text}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"{name}: {error.filename or output}: {error.strerror}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


def run_folder_program(kind: str, write, arguments: list[str] | None) -> int:
    """The program of a page about a folder that `frm KIND --report` left."""
    parser = argparse.ArgumentParser(prog=f"frm.{kind}_report", description=f"Shows a {kind} as one page.")
    parser.add_argument("folder", metavar="DIR", help=f"what `frm {kind} --report` wrote")
    parser.add_argument("-o", "--output", metavar="FILE", help="the page to write (default: DIR/report.html)")
    options = parser.parse_args(arguments)
    return run_program(parser.prog, options.folder, lambda: write(options.folder, options.output))


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="frm.report",
                                     description="Replays a recording and shows it as one page.")
    parser.add_argument("recording", help="what a recorder wrote")
    parser.add_argument("-o", "--output", default="report.html",
                        help="the page to write (default: %(default)s)")
    parser.add_argument("--run", metavar="JSON",
                        help="what `frm run` wrote about the run: adds the tick times")
    parser.add_argument("--frames", type=int, default=12, metavar="N", choices=range(1, 61),
                        help="pictures of the water, 1 to 60 (default: %(default)s)")
    options = parser.parse_args(arguments)

    def draw():
        run = read_run(options.run) if options.run else None
        write_report(options.recording, options.output, run, options.frames)

    status = run_program("frm.report", options.output, draw)
    if status == 0:
        print(options.output)
    return status


if __name__ == "__main__":
    sys.exit(main())
