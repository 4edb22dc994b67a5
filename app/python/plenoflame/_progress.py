"""What progress=True shows."""

import contextlib
import sys
import warnings


class _Text:
    """Tenths on standard error: render: 10 % 20 % ..."""

    def __init__(self, what):
        self._tenths = 0
        sys.stderr.write(f"{what}:")

    def show(self, fraction):
        while self._tenths < int(10 * fraction + 1e-9):
            self._tenths += 1
            sys.stderr.write(f" {10 * self._tenths} %")
            sys.stderr.flush()

    def close(self):
        sys.stderr.write("\n")


class _Bar:
    """tqdm's: in a notebook one of its own."""

    def __init__(self, tqdm, what):
        self._bar = tqdm(total=100, desc=what, bar_format="{desc}: {percentage:3.0f} %|{bar}| {elapsed}, left {remaining}")

    def show(self, fraction):
        self._bar.update(max(0, 100 * fraction - self._bar.n))

    def close(self):
        self._bar.close()


def _shown(what):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of ipywidgets, without which the bar is text
            from tqdm.auto import tqdm
    except ImportError:
        return _Text(what)
    return _Bar(tqdm, what)


@contextlib.contextmanager
def watcher(progress, what):
    """The function to call with the fraction done, or None, and one to call at the end of a run that did not fail.
    progress: None, False, True, or a function."""
    if progress is not True:
        yield progress or None, lambda: None
        return
    shown = _shown(what)
    try:
        yield shown.show, lambda: shown.show(1.0)
    finally:
        shown.close()
