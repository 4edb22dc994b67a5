"""Running the library the way Python expects: errors as exceptions, warnings as warnings, Ctrl-C at once, other
threads at work meanwhile."""

import contextlib
import importlib
import signal
import sys
import threading
import warnings

from ._core import Failure
from ._progress import watcher


class Error(RuntimeError):
    """What went wrong, in one sentence. It names arguments as Python writes them."""


def _depth_of_caller():
    """How many frames warnings.warn() has to go up to the code that uses the package."""
    depth, frame = 1, sys._getframe(1)
    while frame.f_back and frame.f_globals.get("__name__", "").partition(".")[0] in (__package__, "contextlib"):
        depth, frame = depth + 1, frame.f_back
    return depth


def deliver(errors, cautions):
    """Passes warnings on, and raises the first error."""
    for text in cautions:
        warnings.warn(text, RuntimeWarning, stacklevel=_depth_of_caller())
    if errors:
        raise Error(errors[0])


@contextlib.contextmanager
def errors_of(*objects):
    """Raises Error for what these objects of the library refuse, and passes their warnings on."""
    errors = []
    try:
        yield
    except Failure as failure:
        errors.append(str(failure))
    deliver(errors, [text for subject in objects if hasattr(subject, "take_warnings") for text in subject.take_warnings()])


def need_vtk(what):
    """The module plenoflame.vtk. Raises Error where it is not there."""
    try:
        return importlib.import_module(".vtk", __package__)
    except ImportError as missing:
        raise Error(str(missing).replace("plenoflame.vtk", what, 1)) from None


@contextlib.contextmanager
def _interrupt_noted(noted):
    """Puts Ctrl-C off: no exception may leave a function that the library calls."""
    # A program that Python is part of, such as ParaView, may have a handler of its own, which Python could not put back.
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGINT) is None:
        yield
        return
    before = signal.signal(signal.SIGINT, lambda number, _frame: noted.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if noted and callable(before):
        before(noted[0], None)  # Python's own raises KeyboardInterrupt


def made(kind, **attributes):
    """An object of the library that has these attributes."""
    thing = kind()
    for name, value in attributes.items():
        setattr(thing, name, value)
    return thing


def _run_library(algorithm, on_progress, on_message):
    try:
        algorithm.run(on_progress, lambda text: on_message(0, text))
    except Failure as failure:
        on_message(1, str(failure))


def update(algorithm, progress=None, what="progress", run=_run_library):
    """Runs an algorithm, with Python's lock released. `progress` is called with the fraction done, now and then; a true
    result stops the run, and so do an exception, which is raised again, and Ctrl-C. True shows a bar, named `what`.
    run: takes the algorithm and two functions that do not raise, of the fraction and of (is an error, text)."""
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise Error(f"progress takes True or a function of the fraction done, not {progress!r}")
    errors, cautions = [], []
    with watcher(progress, what) as (watch, show_the_end):
        _watched(lambda *functions: run(algorithm, *functions), watch, errors, cautions)
        if not errors:
            show_the_end()
    deliver(errors, cautions)
    return algorithm


def _watched(run, progress, errors, cautions):
    raised, interrupted = [], []

    def on_progress(fraction):
        try:
            return int(bool(interrupted or raised or progress and progress(fraction)))
        except BaseException as exception:
            raised.append(exception)
            return 1

    def on_message(is_error, text):
        (errors if is_error else cautions).append(text)

    try:
        with _interrupt_noted(interrupted):
            run(on_progress, on_message)
    finally:
        if raised:
            raise raised[0]
