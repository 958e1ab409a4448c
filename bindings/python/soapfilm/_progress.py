"""What a run tells: warnings as Python's, progress by tqdm, by lines on a terminal, or to a function of the caller."""
from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from typing import Any, Union

from .errors import warn

#: Of a caller: progress(stage, fraction in [0, 1], detail). What it raises cancels the run.
Function = Callable[[str, float, str], Any]
Progress = Union[bool, Function]


def listener(progress: Progress, stacklevel: int) -> Callable[[str, float, str], None]:
    """on_event(kind, number, text) for the library. `stacklevel`: of warnings, from the one who calls on_event."""
    if callable(progress):
        show: Any = _Told(progress)
    elif not progress:
        show = None
    else:
        show = _bar() or (_Lines() if sys.stderr is not None and sys.stderr.isatty() else None)

    def on_event(kind: str, number: float, text: str) -> None:
        if kind == "warning":
            warn(text, stacklevel)
        elif show is not None:
            show(kind, number, text)

    return on_event


class _Told:
    """Calls a function of the caller."""

    def __init__(self, function: Function) -> None:
        self.function = function
        self.stage = ""

    def __call__(self, kind: str, number: float, text: str) -> None:
        if kind == "stage":
            self.stage = text
            self.function(text, 0.0, "")
        elif kind == "advance":
            self.function(self.stage, number, text)
        elif kind == "done":
            self.function(self.stage, 1.0, "")


class _Lines:
    """One line on the terminal, drawn again as the stages go."""

    def __init__(self) -> None:
        self.stage = ""

    def __call__(self, kind: str, number: float, text: str) -> None:
        if kind == "stage":
            self.stage = text
            self._draw(f"{text} ...")
        elif kind == "advance":
            self._draw(f"{self.stage} {100 * number:3.0f} %  {text}")
        elif kind == "done":
            self._draw("")

    @staticmethod
    def _draw(line: str) -> None:
        sys.stderr.write("\r\x1b[K" + line[:100])
        sys.stderr.flush()


class _Tqdm:
    """A bar of one stage after the other, in the terminal or the notebook."""

    def __init__(self, tqdm: Any) -> None:
        self.tqdm = tqdm
        self.bar: Any = None

    def __call__(self, kind: str, number: float, text: str) -> None:
        if kind == "stage":
            self._close()
            self.bar = self.tqdm(total=100, desc=text, leave=False,
                                 bar_format="{desc:<12}{percentage:3.0f} %|{bar}| {postfix}")
        elif self.bar is None:
            return
        elif kind == "advance":
            self.bar.set_postfix_str(text, refresh=False)
            self.bar.update(round(100 * number) - self.bar.n)
        elif kind == "done":
            self._close()

    def _close(self) -> None:
        if self.bar is not None:
            self.bar.close()
            self.bar = None

    def __del__(self) -> None:
        self._close()


def _bar() -> _Tqdm | None:
    """tqdm where it is installed and has somewhere to draw."""
    notebook = "ipykernel" in sys.modules
    if not notebook and (sys.stderr is None or not sys.stderr.isatty()):
        return None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # tqdm's, where a notebook has no widgets: it draws text then
            from tqdm.auto import tqdm
    except ImportError:
        return None
    return _Tqdm(tqdm)
