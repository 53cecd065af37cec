"""Pages opened in the Chromium of this computer, whatever it is called, without a screen and without a network."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

_NAMES = ("chromium", "chromium-browser", "google-chrome")
_FLAGS = ("--no-sandbox", "--enable-unsafe-swiftshader", "--use-angle=swiftshader")


@contextmanager
def opened(page: Path, width: int = 1280, height: int = 900) -> Iterator[tuple[Any, list[str]]]:
    """A page from file://, and what its console complains of; every request that leaves the file is a complaint too.

    For a reader who has asked for less motion, so that nothing moves unless it is told to.
    """
    api = pytest.importorskip("playwright.sync_api", reason="playwright drives the browser")
    found = next(filter(None, map(shutil.which, _NAMES)), None)
    if found is None:
        pytest.skip(f"no browser: none of {', '.join(_NAMES)} is installed")
    with api.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=found, args=_FLAGS)
        try:
            size, said = {"width": width, "height": height}, list[str]()
            tab = browser.new_page(viewport=size, reduced_motion="reduce")
            tab.on(
                "console", lambda message: said.append(message.text) if message.type in ("error", "warning") else None
            )
            tab.on("pageerror", lambda error: said.append(str(error)))
            tab.on("request", lambda request: said.append(request.url) if request.url.startswith("http") else None)
            tab.goto(page.as_uri())
            yield tab, said
        finally:
            browser.close()
