"""Running VTK algorithms the way Python expects: errors as exceptions, warnings as warnings, Ctrl-C at once."""

import contextlib
import re
import signal
import threading
import warnings

from vtkmodules.util.vtkConstants import VTK_STRING
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkCommand


class Error(RuntimeError):
    """What went wrong, in the words of the command line."""


def _text(message):
    """The message within VTK's 'ERROR: In FILE, line N\\nCLASS (ADDRESS): MESSAGE'."""
    match = re.search(r"\(0x[0-9a-f]+\): (.*)", message, re.DOTALL)
    return (match[1] if match else message).strip()


@contextlib.contextmanager
def errors_of(*objects):
    """Raises Error for the first error event of these objects, and passes their warning events on."""
    errors, cautions, tags = [], [], []

    def note(into):
        def callback(_caller, _event, text):
            into.append(_text(text))
        callback.CallDataType = VTK_STRING
        return callback

    for subject in objects:
        tags.append((subject, subject.AddObserver(vtkCommand.ErrorEvent, note(errors))))
        tags.append((subject, subject.AddObserver(vtkCommand.WarningEvent, note(cautions))))
    try:
        yield
    finally:
        for subject, tag in tags:
            subject.RemoveObserver(tag)
    for text in cautions:
        warnings.warn(text, RuntimeWarning, stacklevel=4)
    if errors:
        raise Error(errors[0])


@contextlib.contextmanager
def _interrupt_noted(noted):
    """Puts Ctrl-C off: within a callback VTK would end the whole program for it."""
    if threading.current_thread() is not threading.main_thread():
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
    """Runs an algorithm. `progress` is called with the fraction done, now and then; a true result stops the run, and so
    do an exception, which is raised again, and Ctrl-C."""
    raised, interrupted = [], []

    def callback(_caller, _event):
        # An exception may not leave the callback: VTK would print it and go on.
        try:
            if interrupted or raised or progress and progress(algorithm.GetProgress()):
                algorithm.SetAbortExecute(1)
        except BaseException as exception:
            raised.append(exception)
            algorithm.SetAbortExecute(1)

    tag = algorithm.AddObserver(vtkCommand.ProgressEvent, callback)
    try:
        with _interrupt_noted(interrupted), errors_of(algorithm, algorithm.GetExecutive()):
            algorithm.Update()
    finally:
        algorithm.RemoveObserver(tag)
        if raised:
            raise raised[0]
    return algorithm


def image_array(image, name):
    """An array of a vtkImageData as numpy (rows, columns), row 0 at the top. Shares its memory."""
    columns, rows, _ = image.GetDimensions()
    values = image.GetPointData().GetArray(name)
    if values is None:
        present = [image.GetPointData().GetArrayName(i) for i in range(image.GetPointData().GetNumberOfArrays())]
        raise Error(f"the image has no array '{name}'; it has {', '.join(present) or 'none'}")
    return vtk_to_numpy(values).reshape(rows, columns)[::-1]
