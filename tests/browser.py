"""The Chromium of this computer, whatever it is called, without a screen and without a network."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

_NAMES = ("chromium", "chromium-browser", "google-chrome")
_FLAGS = ("--no-sandbox", "--enable-unsafe-swiftshader", "--use-gl=angle", "--use-angle=swiftshader")
_PATIENCE = 60e3  # ms, for software rendering on a busy computer
_OWN = ("file:", "data:", "blob:", "http://127.0.0.1")

Opened = Callable[..., Any]


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium, driven by playwright, of which one runs at a time."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright drives the browser")
    path = next(filter(None, map(shutil.which, _NAMES)), None)
    if path is None:
        pytest.skip(f"no browser: none of {', '.join(_NAMES)} is installed")
    with playwright.sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=path, args=_FLAGS)
        yield running
        running.close()


@pytest.fixture
def opened(browser: Any) -> Iterator[Opened]:
    """Opens a file or an address in a tab of so many pixels, for a reader who has asked for less motion.

    At the end no page may have complained, or have asked for anything beyond itself.
    """
    said, tabs = list[str](), list[Any]()

    def show(page: Path | str, width: int = 1280, height: int = 900) -> Any:
        tab = browser.new_page(viewport={"width": width, "height": height}, reduced_motion="reduce")
        tabs.append(tab)
        tab.set_default_timeout(_PATIENCE)
        loud = ("error", "warning") if isinstance(page, Path) else ("error",)
        tab.on("console", lambda message: said.append(message.text) if message.type in loud else None)
        tab.on("pageerror", lambda error: said.append(str(error)))
        tab.on("request", lambda request: None if request.url.startswith(_OWN) else said.append(request.url))
        tab.goto(page.as_uri() if isinstance(page, Path) else page)
        return tab

    yield show
    for tab in tabs:
        tab.close()
    assert said == []
