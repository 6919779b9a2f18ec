"""One browser for all tests of a process."""

from collections.abc import Iterator

import pytest

from tests.casingfem.plot.browser import Tab, browser


@pytest.fixture(scope="session")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    with browser(tmp_path_factory.mktemp("browser")) as one:
        yield one


@pytest.fixture
def tab(running: Tab) -> Iterator[Tab]:
    """The tab of the browser, without what it heard of other pages; afterwards no page moves in it any more."""
    running.heard.clear()
    yield running
    running.send("Page.navigate", url="about:blank")
    running.wait("location.protocol === 'about:'")
