"""Warnings about a model on the command line: one clean line each on stderr, and a list for --json."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import click

from casingfem.errors import ModelWarning

MOST = 3  # of one code: an update meets the same warning again and again in slightly other words

_collected: list[dict[str, str]] = []


def collected() -> list[dict[str, str]]:
    """The warnings of this command so far: code and message."""
    return [dict(entry) for entry in _collected]


@contextmanager
def collecting() -> Iterator[None]:
    """Print and keep warnings about the model while a command runs; others go the usual way."""
    _collected.clear()
    with warnings.catch_warnings():
        warnings.simplefilter("always", ModelWarning)
        usual = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *more: Any, **named: Any) -> None:
            if isinstance(message, ModelWarning):
                collect(message)
            else:
                usual(message, category, *more, **named)

        warnings.showwarning = show
        yield


def collect(warning: ModelWarning) -> None:
    """Keep and print a warning that was not there before."""
    entry = {"code": warning.code, "message": str(warning)}
    if entry not in _collected and sum(other["code"] == warning.code for other in _collected) < MOST:
        _collected.append(entry)
        click.echo(f"warning: {warning}", err=True)
