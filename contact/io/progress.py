"""Progress of a long computation, reported to any listener.

A computation calls `tell("3 of 12 groups", 0.25)`, or loops over its parts with `each`. Inside `quietly` nothing is
reported. A command listens with `listening`; without a listener nothing happens. A display with a thread of its own
registers with `pausable` how that thread ends for a while: a process is copied only while it has one thread.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from contextvars import ContextVar
from typing import TypeVar

T = TypeVar("T")
Listener = Callable[[str, float | None, bool], None]
Pause = Callable[[], AbstractContextManager[None]]
_LISTENER: ContextVar[Listener | None] = ContextVar("listener", default=None)
_PAUSES: ContextVar[tuple[Pause, ...]] = ContextVar("pauses", default=())


@contextmanager
def listening(listener: Listener | None) -> Iterator[None]:
    """Pass reports of computations inside to a listener: text, finished share, and whether fewer steps may be enough.

    >>> heard = []
    >>> with listening(lambda *told: heard.append(told)):
    ...     tell("1 of 4 bands", 0.25)
    >>> heard
    [('1 of 4 bands', 0.25, False)]
    """
    token = _LISTENER.set(listener)
    try:
        yield
    finally:
        _LISTENER.reset(token)


@contextmanager
def pausable(pause: Pause) -> Iterator[None]:
    """Within this context `paused` also enters the context that `pause` makes, in which a display has no thread.

    >>> from contextlib import nullcontext
    >>> made = []
    >>> with pausable(lambda: made.append("paused") or nullcontext()), paused():
    ...     made
    ['paused']
    """
    token = _PAUSES.set((*_PAUSES.get(), pause))
    try:
        yield
    finally:
        _PAUSES.reset(token)


@contextmanager
def paused() -> Iterator[bool]:
    """Within this context displays of progress have no thread; the value states whether there are displays."""
    with ExitStack() as stack:
        for pause in _PAUSES.get():
            stack.enter_context(pause())
        yield bool(_PAUSES.get())


def quietly() -> AbstractContextManager[None]:
    """Within this context computations report to no listener."""
    return listening(None)


@contextmanager
def as_part(whole: Callable[[float], tuple[str, float]]) -> Iterator[None]:
    """Report computations inside as a part of a larger one: `whole` makes text and total share from their own share.

    >>> heard = []
    >>> with listening(lambda *told: heard.append(told)), as_part(lambda done: ("run 2 of 4", (1 + done) / 4)):
    ...     tell("a run", 0.5)
    >>> heard
    [('run 2 of 4', 0.375, False)]
    """
    listener = _LISTENER.get()
    if listener is None:
        yield
        return
    with listening(lambda _, done, most: listener(*whole(done or 0.0), most)):
        yield


def tell(words: str, done: float | None = None, *, most: bool = False) -> None:
    """Report a text and the finished share, None if unknown.

    `most`: the share refers to the largest possible number of steps.
    """
    listener = _LISTENER.get()
    if listener is not None:
        listener(words, done, most)


def each(parts: Sequence[T], what: str) -> Iterator[T]:
    """Loop over the parts and report the number of each; a single part is not reported.

    >>> heard = []
    >>> with listening(lambda *told: heard.append(told)):
    ...     list(each("ab", "band"))
    ['a', 'b']
    >>> heard
    [('band 1 of 2', 0.0, False), ('band 2 of 2', 0.5, False)]
    """
    for k, part in enumerate(parts):
        if len(parts) > 1:
            tell(f"{what} {k + 1} of {len(parts)}", k / len(parts))
        yield part
