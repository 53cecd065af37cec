"""The page in a browser: what it shows is what the library finds."""

from collections.abc import Callable
from io import BytesIO
from time import monotonic, sleep
from typing import Any

import numpy as np
import pytest

import prs_model as prs
from prs_model.explore.session import Session
from tests.browser import Opened
from tests.explore.conftest import Serve

_PATIENCE = 60.0  # s, for software rendering on a busy computer

pytestmark = pytest.mark.browser


Page = tuple[Any, Session]


@pytest.fixture
def explored(serve: Serve, opened: Opened) -> Callable[..., Page]:
    """A machine's page in a small window."""

    def show(machine: prs.Machine, width: int = 900, **how: Any) -> Page:
        session = serve(machine, **how)
        page = opened(session.address, width, 700)
        page.wait_for_selector("td.frequency")
        return page, session

    return show


def shown(page: Any) -> np.ndarray:
    return np.array([float(text) for text in page.locator("td.frequency").all_inner_texts()])


def slider(page: Any, label: str) -> Any:
    """The thumb beside a label."""
    row = page.get_by_text(label, exact=True).locator("xpath=ancestor::*[.//*[@role='slider']][1]")
    return row.locator("[role=slider]").first


def wait_for(condition: Callable[[], bool]) -> None:
    end = monotonic() + _PATIENCE
    while not condition():
        assert monotonic() < end
        sleep(0.05)


def test_the_frequencies_follow_the_pose_slider(explored: Callable[..., Page]) -> None:
    machine = prs.load_machine("hexapod")
    page, session = explored(machine)
    assert shown(page) == pytest.approx(machine.modes(8).frequencies, abs=6e-4)
    slider(page, "z [mm]").press("ArrowRight")
    wait_for(lambda: session.solved > 1)
    z = session.page.pose["z"].value
    assert z > 0.09
    expected = machine.modes(8, z=z).frequencies
    assert np.abs(expected - machine.modes(8).frequencies).max() > 6e-3
    wait_for(lambda: np.allclose(shown(page), expected, rtol=0.0, atol=6e-4))
    page.get_by_role("button", name="Back to the start").click()
    wait_for(lambda: np.allclose(shown(page), machine.modes(8).frequencies, rtol=0.0, atol=6e-4))


def test_a_stiffer_joint_and_back(explored: Callable[..., Page]) -> None:
    machine = prs.load_machine("hexapod")
    page, session = explored(machine)
    assert list(session.page.factors) == ["P"]  # U and S are rigid
    slider(page, "P ×").press("ArrowRight")
    wait_for(lambda: session.solved > 1)
    factor = session.page.factors["P"].value
    expected = machine.replace({"joints.P.stiffness_factor": factor}).modes(8).frequencies
    assert factor > 1.0
    wait_for(lambda: np.allclose(shown(page), expected, rtol=0.0, atol=6e-4))
    page.get_by_role("button", name="As described").click()
    wait_for(lambda: np.allclose(shown(page), machine.modes(8).frequencies, rtol=0.0, atol=6e-4))


def picture(page: Any) -> np.ndarray:
    """The machine (h, w, 4), away from the controls."""
    image = pytest.importorskip("PIL.Image")
    shot = page.screenshot(clip={"x": 0, "y": 220, "width": 480, "height": 450})
    return np.asarray(image.open(BytesIO(shot)).convert("RGBA"))


def still_picture(page: Any) -> np.ndarray:
    """Once two in a row are the same."""
    pictures = [picture(page)]

    def settled() -> bool:
        pictures.append(picture(page))
        return np.array_equal(pictures[-2], pictures[-1])

    wait_for(settled)
    return pictures[-1]


def test_the_mode_is_animated_and_paused(explored: Callable[..., Page]) -> None:
    page, session = explored(prs.load_machine("hexapod"))
    first = picture(page)
    wait_for(lambda: not np.array_equal(picture(page), first))
    page.get_by_label("animate").uncheck()
    wait_for(lambda: not session.page.animate.value)
    deformed = still_picture(page)
    assert len(np.unique(deformed.reshape(-1, 4), axis=0)) > 20  # not blank
    slider(page, "amplitude [%]").press("Home")
    wait_for(lambda: session.page.share(0.0) == 0.0)
    at_rest = still_picture(page)
    assert not np.array_equal(deformed, at_rest)
    slider(page, "amplitude [%]").press("End")
    slider(page, "mode number").press("End")
    wait_for(lambda: session.page.mode_drawn(6) == 5)
    assert not np.array_equal(still_picture(page), deformed)
