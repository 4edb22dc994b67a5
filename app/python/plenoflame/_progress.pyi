from contextlib import AbstractContextManager
from typing import Any, Callable, Optional, Union

def watcher(progress: Union[None, bool, Callable[[float], Any]],
            what: str) -> AbstractContextManager[tuple[Optional[Callable[[float], Any]], Callable[[], None]]]: ...
