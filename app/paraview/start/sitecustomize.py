"""Debian 12's ParaView 5.11.0 asks for inspect.getargspec(), which Python 3.11 no longer has, so that no plugin in Python
loads there. Python runs this file first where its folder is in PYTHONPATH, as plenoflame-paraview puts it."""

import inspect

if not hasattr(inspect, "getargspec"):
    inspect.getargspec = inspect.getfullargspec
