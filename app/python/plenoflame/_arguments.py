"""A wrong keyword is refused with the nearest right one."""

import difflib
import functools
import inspect


def guarded(thing):
    """The function, or the class with its public methods, that does so. Functions of any keyword stay as they are."""
    if inspect.isclass(thing):
        for name, method in list(vars(thing).items()):
            if inspect.isfunction(method) and (not name.startswith("_") or name == "__init__"):
                setattr(thing, name, guarded(method))
        return thing
    if not inspect.isfunction(thing):
        return thing
    parameters = inspect.signature(thing).parameters
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters.values()):
        return thing
    known = [name for name in parameters if name != "self"]

    @functools.wraps(thing)
    def checked(*arguments, **named):
        for name in named:
            if name not in parameters:
                raise TypeError(refusal(thing.__qualname__.removesuffix(".__init__"), name, known))
        return thing(*arguments, **named)

    return checked


def refusal(function, name, known):
    """The sentence about a keyword that a function does not have."""
    nearest = difflib.get_close_matches(name, known, 1, 0.5)
    hint = f"did you mean {nearest[0]!r}?" if nearest else f"there are {', '.join(known)}" if known else "it takes none"
    return f"{function}() has no argument {name!r}; {hint}"
