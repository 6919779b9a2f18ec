"""A plugin of pytest: files, and the tests of each, in an order drawn from --shuffle SEED; with xdist as without."""

import random

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    """Name the seed."""
    parser.addoption("--shuffle", type=int, default=0, metavar="SEED", help="run the tests in the order of this seed")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Draw an order of files, and one in each: tests of a file stay together, as its fixtures expect."""
    draw = random.Random(config.getoption("--shuffle"))
    place = {path: draw.random() for path in dict.fromkeys(item.path for item in items)}
    within = [draw.random() for _ in items]
    order = sorted(range(len(items)), key=lambda k: (place[items[k].path], within[k]))
    items[:] = [items[k] for k in order]
