"""Progress of long work on stderr: a bar with the time left on a terminal, a line now and then elsewhere."""
from __future__ import annotations

import sys
import time

_WAIT_S = 2.0  # shorter work says nothing
_BAR_EVERY_S = 0.1
_LINE_EVERY_S = 2.0


class Progress:
    """Call it with the amount of work that is done, out of `total`; close it at the end."""

    def __init__(self, what: str, total: int, stream=None):
        self.what, self.total = what, max(total, 1)
        self.stream = stream or sys.stderr
        self.bar = self.stream.isatty()
        self.start = time.monotonic()
        self.next = self.start + _WAIT_S
        self.shown = False

    def __call__(self, done: int) -> None:
        now = time.monotonic()
        if now < self.next:
            return
        self.next = now + (_BAR_EVERY_S if self.bar else _LINE_EVERY_S)
        self.shown = True
        share = min(done / self.total, 1.0)
        left = f"{(now - self.start) * (1 - share) / share:.0f} s left" if share else "..."
        if self.bar:
            filled = round(30 * share)
            text = f"\r{self.what} [{'#' * filled}{'.' * (30 - filled)}] {share:4.0%}  {left}\x1b[K"
        else:
            text = f"{self.what}: {share:.0%}, {left}\n"
        self.stream.write(text)
        self.stream.flush()

    def close(self) -> None:
        if self.shown and self.bar:
            self.stream.write("\r\x1b[K")
            self.stream.flush()

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, *exception) -> None:
        self.close()
