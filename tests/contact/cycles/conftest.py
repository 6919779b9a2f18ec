"""A family of motions that is a map in closed form."""

from importlib import import_module

import pytest

from tests.contact.cycles.henon import Henon, followed_map


@pytest.fixture
def family(monkeypatch):
    for name in ("shooting", "basins"):
        monkeypatch.setattr(import_module(f"contact.cycles.{name}"), "passage", followed_map)
    monkeypatch.setattr(import_module("contact.cycles.shooting"), "beside", lambda *_: None)
    return Henon()
