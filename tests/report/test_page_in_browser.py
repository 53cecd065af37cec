"""The page as its reader meets it: from file://, in a browser, by mouse and by keyboard."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import prs_model as prs
from tests.browser import Opened

pytestmark = pytest.mark.browser


def picture(tab: Any) -> np.ndarray:
    """The canvas as seen, (rows, columns, 3)."""
    image = pytest.importorskip("PIL.Image")
    shot = tab.locator("#canvas").screenshot()
    return np.asarray(image.open(io.BytesIO(shot)).convert("RGB"), dtype=float)


def difference(a: np.ndarray, b: np.ndarray) -> float:
    """Share of the pixels that differ clearly."""
    return float(np.mean(np.abs(a - b).max(axis=2) > 30.0))


def at_phase(tab: Any, degrees: int) -> np.ndarray:
    tab.evaluate(
        "degrees => { const range = document.getElementById('phase'); range.value = degrees;"
        " range.dispatchEvent(new Event('input')); }",
        degrees,
    )
    return picture(tab)


@pytest.mark.parametrize("name", ["head", "hexapod"])
def test_machine_swings(name: str, request: pytest.FixtureRequest, opened: Opened) -> None:
    tab = opened(request.getfixturevalue(name) / "report.html", 700, 600)
    tab.locator("#play").click()
    phase = tab.locator("#phase").input_value()
    tab.wait_for_function(f"document.getElementById('phase').value !== '{phase}'")
    middle, out, back = at_phase(tab, 0), at_phase(tab, 90), at_phase(tab, 180)
    assert len(np.unique(out @ [65536.0, 256.0, 1.0])) > 500  # colours: not blank
    assert difference(middle, out) > 0.005
    assert difference(middle, back) < 0.001
    assert tab.locator("#play").inner_text() == "Play"  # a hand on the phase has stopped it


def test_what_a_large_face_turns_about_stands_still(hexapod: Path, opened: Opened) -> None:
    """Mode 6 turns the platform, a box whose corners all go equally far, about its middle."""
    tab = opened(hexapod / "report.html", 700, 600)
    tab.get_by_role("button", name="Top").click()
    tab.locator("input[name=mode-0]").nth(5).check()
    green = at_phase(tab, 0)[:, :, 1]  # grows along the colour scale
    row, column = (length // 2 for length in green.shape)
    middle, outside = green[row + 10 : row + 20, column - 20 : column - 10], green[row - 60 : row + 60]
    assert middle.mean() < 70.0
    assert outside[:, column - 100 : column - 60].mean() > middle.mean() + 30.0


def test_controls_work_by_mouse(head: Path, opened: Opened) -> None:
    tab = opened(head / "report.html")
    start = at_phase(tab, 90)
    for act in (
        lambda: tab.get_by_role("button", name="Top").click(),
        lambda: tab.get_by_role("button", name="Zoom in").click(),
        lambda: tab.locator("#ground").select_option("hidden"),
        lambda: tab.locator("#colour").select_option("part"),
        lambda: tab.locator("#amplitude").fill("200"),
        lambda: tab.locator("input[name=mode-0]").nth(4).check(),
    ):
        act()
        now = picture(tab)
        assert difference(start, now) > 0.002
        start = now
    assert "Mode 5" in tab.locator("#which").inner_text()
    box = tab.locator("#canvas").bounding_box()
    tab.mouse.move(box["x"] + 200, box["y"] + 200)
    tab.mouse.down()
    tab.mouse.move(box["x"] + 330, box["y"] + 150)
    tab.mouse.up()
    assert difference(start, picture(tab)) > 0.01


def test_controls_work_by_keyboard(head: Path, opened: Opened) -> None:
    tab = opened(head / "report.html")
    assert tab.locator("#play").inner_text() == "Play"  # nothing moves by itself for who does not want it
    tab.locator("#play").focus()
    tab.keyboard.press("Enter")
    assert tab.locator("#play").inner_text() == "Pause"
    tab.keyboard.press("Enter")
    tab.locator("#canvas").focus()
    start = picture(tab)
    for key in ("ArrowLeft", "ArrowUp", "+", "n"):
        tab.keyboard.press(key)
        now = picture(tab)
        assert difference(start, now) > 0.002, key
        start = now
    assert "Mode 2" in tab.locator("#which").inner_text()
    tab.keyboard.press("5")
    assert tab.locator("input[name=mode-0]").nth(4).is_checked()
    tab.keyboard.press("Space")
    assert tab.locator("#play").inner_text() == "Pause"


def test_response_follows_mouse_and_keys(head: Path, opened: Opened) -> None:
    tab = opened(head / "report.html")
    chart, readout = tab.locator("#chart"), tab.locator("#readout")
    assert tab.locator("#chart path.curve").count() == 6
    chart.focus()
    before = readout.inner_text()
    tab.keyboard.press("Shift+ArrowRight")
    moved = readout.inner_text()
    assert moved != before
    assert "µm/N" in moved
    tab.locator("#quantity").select_option("accelerance")
    assert "m/s²/N" in readout.inner_text()
    tab.locator("[data-curve=u]").uncheck()
    assert tab.locator("#chart path.curve").count() == 4
    ticks = tab.locator("#chart text.tick").all_text_contents()
    chart.hover(position={"x": 500, "y": 100})
    tab.mouse.down()
    chart.hover(position={"x": 700, "y": 100})
    tab.mouse.up()
    assert tab.locator("#chart text.tick").all_text_contents() != ticks
    tab.keyboard.press("Home")
    assert tab.locator("#chart text.tick").all_text_contents() == ticks
    tab.locator("#chart .mode text").nth(2).click()
    assert "Mode 3" in tab.locator("#which").inner_text()


def test_poses_are_chosen(hexapod: Path, opened: Opened) -> None:
    tab = opened(hexapod / "report.html")
    assert tab.locator("fieldset.modes:visible").count() == 1
    published = tab.get_by_role("heading", name="Beside published frequencies, at x 0 mm, y 0 mm, z 90 mm")
    assert published.is_visible()
    assert tab.locator("header dd:visible").first.inner_text() == "780.6 Hz"
    first = tab.locator("#which").inner_text()
    start = at_phase(tab, 90)
    tab.locator("#pose").select_option("1")
    frequency = prs.load_machine("hexapod").modes(1, z=0.0935).frequencies[0]
    assert tab.locator("header dd:visible").first.inner_text() == f"{frequency:.1f} Hz"
    assert not published.is_visible()
    assert tab.locator("#which").inner_text() != first
    assert difference(start, picture(tab)) > 0.002
    assert tab.locator("figure:visible img").count() == 7


@pytest.mark.parametrize("name", ["head", "hexapod"])
def test_phone(name: str, request: pytest.FixtureRequest, opened: Opened) -> None:
    """Nothing is wider than the screen, but for what scrolls by itself."""
    tab = opened(request.getfixturevalue(name) / "report.html", 390, 844)
    assert tab.evaluate("document.documentElement.scrollWidth") == 390
    assert tab.locator("#chart svg").bounding_box()["width"] <= 390
    for image in tab.locator("figure:visible img").all():
        box = image.bounding_box()
        assert box["x"] + box["width"] <= 378


def test_paper_shows_every_pose_and_the_details(hexapod: Path, opened: Opened) -> None:
    tab = opened(hexapod / "report.html")
    tab.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    tab.emulate_media(media="print")
    assert not tab.locator("canvas").is_visible()
    assert not tab.locator("#chart").is_visible()
    assert tab.locator(".paper:visible img").count() == 4  # shapes and response of both
    assert tab.locator("details:not([open])").count() == 0
    tab.evaluate("window.dispatchEvent(new Event('afterprint'))")
    assert tab.locator(".still:visible").count() == 1


def test_without_webgl_the_pictures_are_there(head: Path, tmp_path: Path, opened: Opened) -> None:
    text = (head / "report.html").read_text(encoding="utf-8")
    (tmp_path / "plain.html").write_text(text.replace('"webgl2"', '"no such thing"'), encoding="utf-8")
    tab = opened(tmp_path / "plain.html")
    assert tab.locator(".still img").is_visible()
    assert not tab.locator("#play").is_visible()
    tab.locator("input[name=mode-0]").nth(2).check()
    assert tab.locator("#chart path.curve").count() == 6
