"""Running the library the way Python expects: errors as exceptions, warnings as warnings, Ctrl-C at once, other
threads at work meanwhile."""

import contextlib
import signal
import threading
import warnings


class Error(RuntimeError):
    """What went wrong, in the words of the command line."""


def deliver(errors, cautions):
    """Passes warnings on, and raises the first error."""
    for text in cautions:
        warnings.warn(text, RuntimeWarning, stacklevel=5)
    if errors:
        raise Error(errors[0])


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


def update(algorithm, progress=None):
    """Runs an algorithm, with Python's lock released. `progress` is called with the fraction done, now and then; a true
    result stops the run, and so do an exception, which is raised again, and Ctrl-C."""
    from ._library import data
    raised, interrupted, errors, cautions = [], [], [], []

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
            data.run(algorithm, on_progress, on_message)
    finally:
        if raised:
            raise raised[0]
    deliver(errors, cautions)
    return algorithm
