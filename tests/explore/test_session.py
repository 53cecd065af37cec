"""A session without a browser: its sliders are moved from here."""

import socket
from collections.abc import Callable
from time import monotonic, sleep

import numpy as np
import pytest

import prs_model as prs
from prs_model.explore.following import origins
from prs_model.explore.server import check_port, serving
from prs_model.explore.session import Session
from tests.explore.conftest import Serve


def wait_for(condition: Callable[[], bool]) -> None:
    end = monotonic() + 60.0
    while not condition():
        assert monotonic() < end
        sleep(0.01)


def settle(session: Session, solved: int) -> None:
    """Ask for an answer and wait until there are so many, or the machine has refused."""
    session.asked.set()
    end = monotonic() + 30.0
    while session.solved < solved and "stays at" not in session.page.status.content:
        assert monotonic() < end
        sleep(0.01)


def test_out_of_reach_is_said_and_the_last_pose_kept(serve: Serve) -> None:
    machine = prs.load_machine("hexapod").replace({"task.workspace.z": [0.087, 0.3]})
    session = serve(machine)
    session.page.pose["z"].move(0.091)
    settle(session, 2)
    kept = session.found
    session.page.pose["z"].move(0.3)
    settle(session, 3)
    assert session.found is kept
    assert kept.modes.frequencies == pytest.approx(machine.modes(8, z=0.091).frequencies, rel=1e-12)
    with pytest.raises(prs.UnreachablePoseError) as reason:
        machine.configuration(z=0.3)
    assert str(reason.value) in session.page.status.content
    assert "z 91 mm" in session.page.status.content


def test_response_is_that_of_the_library_with_a_stand_in_for_damping_that_is_not_stated(serve: Serve) -> None:
    machine = prs.load_machine("hexapod")
    session = serve(machine, count=3)
    response = session.found.response
    assert response is not None
    assert response.values == pytest.approx(machine.modes(6).frf(response.frequencies, 0.01), rel=1e-6, abs=1e-15)
    frequencies, *curves = session.page.plot.data  # type: ignore[union-attr]
    assert np.array(curves) == pytest.approx(1e6 * np.abs(response.values[:, range(3), range(3)].T))
    assert set(machine.modes(3).frequencies) <= set(frequencies)


def test_parts_follow_their_joints(serve: Serve) -> None:
    machine = prs.load_machine("head_3prs")
    session = serve(machine, count=4)
    session.page.factors["P"].value = 4.0
    session.asked.set()
    expected = machine.replace({"joints.P.stiffness_factor": 4.0}).modes(4).frequencies
    at_once = []
    end = monotonic() + 60.0
    while not (session.solved > 2 and "rebuilt" not in session.page.status.content):
        assert monotonic() < end
        if session.solved == 2:
            at_once.append(session.found.modes.frequencies)
        sleep(0.01)
    assert session.found.modes.frequencies == pytest.approx(expected, rel=1e-9)
    assert at_once[-1] == pytest.approx(expected, rel=0.01)
    assert not np.allclose(at_once[-1], expected, rtol=1e-6)


def test_parts_that_cannot_be_rebuilt_end_nothing(
    serve: Serve, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """They keep their shapes, which is said as long as it is so; other factors are tried anew."""
    machine = prs.load_machine("head_3prs")
    with monkeypatch.context() as broken:
        broken.setattr("prs_model.explore.reshaping.parts_under", _breaks)
        session = serve(machine, count=2)
        session.page.factors["P"].value = 4.0
        session.asked.set()
        wait_for(lambda: "no such shape" in session.page.status.content)
        assert "no such shape" in caplog.text
        session.page.pose["z"].move(1.26)
        session.asked.set()
        wait_for(lambda: "could not be rebuilt" in session.page.status.content)
        assert "z 1260 mm" in session.page.status.content
    session.page.factors["P"].value = 2.0
    session.asked.set()
    expected = machine.replace({"joints.P.stiffness_factor": 2.0}).modes(2, z=1.26).frequencies
    wait_for(lambda: np.allclose(session.found.modes.frequencies, expected, rtol=1e-9))
    wait_for(lambda: "rebuilt" not in session.page.status.content)


def _breaks(*_: object) -> None:
    raise RuntimeError("no such shape")


@pytest.mark.parametrize(
    ("damping", "note"),
    [
        ({"rayleigh": {"alpha": 0.0, "beta": 0.0}}, "damping ratio 0.01"),
        ({"modal": 0.0}, "damping ratio 0.01"),
        ({"joints": {"U": {"viscous": 1e-3}}}, "damping ratio 0.01"),  # wholly rigid
        ({"modal": [0.01, 0.0]}, "damping as described"),  # the undamped modes' peaks have no end
        ({"joints": {"P": {"viscous": 1e-5}}}, "damping as described"),
    ],
)
def test_damping_is_stood_in_for_where_nothing_is_damped(serve: Serve, damping: dict[str, object], note: str) -> None:
    session = serve(prs.load_machine("hexapod").replace({"damping": damping}), count=4)
    response = session.found.response
    assert response is not None
    assert np.all(np.isfinite(response.values))
    assert note in session.page.plot.title  # type: ignore[operator,union-attr]


def test_modes_are_known_by_their_shapes(serve: Serve) -> None:
    """On soft drives the head's motion along w comes down past two others."""
    session = serve(prs.load_machine("head_3prs"), count=4)
    start = session.scope.start
    assert [each.number for each in origins(start, session.found.modes) if each] == [1, 2, 3, 4]
    session.page.factors["P"].value = 0.1
    session.asked.set()
    wait_for(lambda: "</td><td>5</td>" in session.page.table.content)
    third = origins(start, session.found.modes)[2]
    assert third is not None
    assert third.number == 5
    assert third.change == pytest.approx(session.found.modes.frequencies[2] / start.frequencies[4] - 1.0)
    assert -0.7 < third.change < -0.5


def test_a_busy_port_is_refused() -> None:
    pytest.importorskip("viser")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(prs.PrsError, match=f"port {port} of 127.0.0.1 cannot be had .*choose another, or 0"):
            check_port(port)
    for wrong in (-1, 65536):
        with pytest.raises(prs.PrsError, match="expected one from 1 to 65535"):
            check_port(wrong)


def test_the_page_is_on_the_loopback_address_and_gone_afterwards(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("viser")
    with serving(prs.load_machine("hexapod"), port=0) as session:
        port = session.server.get_port()
        assert session.address == f"http://127.0.0.1:{port}"
        with pytest.raises(prs.PrsError):
            check_port(port)
        assert session.server.request_share_url() is None
    check_port(port)
    assert capsys.readouterr().out == ""


def test_a_coordinate_without_freedom_has_no_slider(serve: Serve) -> None:
    machine = prs.load_machine("hexapod").replace({"task.workspace.x": [0.0, 0.0]})
    session = serve(machine)
    assert list(session.page.pose) == ["y", "z", "rx", "ry", "rz"]
    assert session.page.question().pose == machine.reference_pose


def test_only_its_own_page_may_connect(serve: Serve) -> None:
    """A page from elsewhere, or from here under another name, could otherwise move the sliders."""
    viser = pytest.importorskip("viser")
    client = pytest.importorskip("websockets.sync.client")
    refused = pytest.importorskip("websockets.exceptions").InvalidStatus
    session = serve(prs.load_machine("hexapod"))
    port = session.server.get_port()
    how = {"subprotocols": [f"viser-v{viser.__version__}"], "open_timeout": 10.0}
    for origin in (None, "http://127.0.0.1:1", f"http://rebound.example:{port}", "null"):
        with pytest.raises(refused, match="HTTP 403"):
            client.connect(f"ws://127.0.0.1:{port}", origin=origin, **how)
    with client.connect(f"ws://127.0.0.1:{port}", origin=session.address, **how) as connection:
        assert connection.recv(timeout=10.0)
