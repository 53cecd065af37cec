"""The dataset of a sweep: its names and units, and files that hold all of it."""

from __future__ import annotations

import csv
import re

import numpy as np
import pytest

from prs_model import load_machine
from prs_model.errors import PrsError, UnknownNameError
from prs_model.sweep.dataset import to_dataset
from prs_model.sweep.drawn.picture import draw
from prs_model.sweep.files import check_file, save
from prs_model.sweep.poses import poses_of
from prs_model.sweep.quantities import blank, labels
from prs_model.sweep.reasons import reason_codes
from prs_model.sweep.request import Request
from prs_model.sweep.truth import at_pose

REQUEST = Request(n_modes=3, quantities=("static_compliance", "kinetic_energy", "identity"))


@pytest.fixture(scope="module")
def hexapod():
    return load_machine("hexapod")


def _block(machine, poses):
    """The truth at every pose, NaN where there is none."""
    found = machine.kinematics.solve_batch(poses.block(0, poses.size))
    there = {i: at_pose(machine, found[i], REQUEST) for i in range(poses.size) if found.reachable[i]}
    first = next(iter(there.values()))
    missing = {name: np.full_like(values, np.nan) for name, values in first.items() if values.dtype.kind == "f"}
    missing |= blank(REQUEST, labels(machine, REQUEST), 1)
    every = [there.get(i, missing) for i in range(poses.size)]
    block = {name: np.concatenate([each[name] for each in every]) for name in first}
    return block | {"reason": reason_codes(machine.kinematics.reach, found.q)}


@pytest.fixture(scope="module")
def grid(hexapod):
    poses = poses_of(hexapod, {"x": np.linspace(-0.002, 0.002, 5), "z": [0.089, 0.09, 0.091, 0.12]})
    return to_dataset(hexapod, poses, REQUEST, _block(hexapod, poses), {"how": "dense", "poses": poses.size})


def test_coordinates_have_names_and_units_and_values_are_where_they_belong(hexapod, grid):
    assert grid["frequency"].dims == ("x", "z", "mode")
    assert grid["x"].attrs["units"] == "m"
    assert grid["rx"].dims == ()
    assert grid["rx"].attrs["units"] == "rad"
    there = grid.sel(x=0.001, z=0.091, method="nearest")
    modes = hexapod.modes(3, x=0.001, z=0.091)
    np.testing.assert_allclose(there["frequency"], modes.frequencies)
    np.testing.assert_allclose(there["kinetic_energy"].sel(body="platform"), modes.kinetic_energy()["platform"])
    np.testing.assert_allclose(
        there["static_compliance"].sel(response="w", excitation="u"), modes.static_compliance()[2, 0]
    )
    assert str(there["static_compliance_unit"].sel(response="rw", excitation="v").values) == "rad/N"


def test_unreachable_poses_are_marked_with_their_reason(grid):
    far = grid.sel(z=0.12)
    assert np.isnan(far["frequency"]).all()
    codes = dict(zip(grid["reason"].attrs["flag_values"], grid["reason"].attrs["flag_meanings"].split(), strict=True))
    for code in np.unique(far["reason"]):
        assert re.fullmatch(r"strut_\d_above_its_upper_limit_110_mm", codes[int(code)])
    assert sum(grid["reason"].attrs["flag_counts"]) == grid["reason"].size
    assert (grid["identity"].sel(z=0.12) == 0).all()


def test_identities_are_named_by_their_character(grid):
    assert "platform" in str(grid["character"].values[0])
    np.testing.assert_array_equal(np.sort(grid["tracked_frequency"].sel(z=0.09)), grid["frequency"].sel(z=0.09))


def test_a_list_of_poses_has_one_dimension(hexapod):
    points = np.tile(list(hexapod.reference_pose.values()), (3, 1))
    points[:, 0] = [0.0, 0.001, 0.002]
    poses = poses_of(hexapod, {}, points)
    data = to_dataset(hexapod, poses, REQUEST, _block(hexapod, poses))
    assert data["frequency"].dims == ("pose", "mode")
    assert data["x"].values.tolist() == [0.0, 0.001, 0.002]


@pytest.mark.parametrize("suffix", [".nc", ".zarr"])
def test_what_is_written_is_read_back(grid, tmp_path, suffix):
    import xarray

    path = tmp_path / f"map{suffix}"
    for _ in range(2):  # the second time in place of the first
        save(grid, path)
    read = xarray.open_dataset(path, engine="h5netcdf") if suffix == ".nc" else xarray.open_zarr(path)
    with read:
        xarray.testing.assert_equal(read.load(), grid)
        assert read.attrs["certificate_how"] == "dense"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_csv_has_a_line_each_pose(grid, tmp_path):
    save(grid, tmp_path / "map.csv")
    rows = list(csv.DictReader((tmp_path / "map.csv").read_text().splitlines()))
    assert len(rows) == grid["reason"].size
    assert float(rows[1]["frequency 2 [Hz]"]) == float(grid["frequency"][0, 1, 1])
    assert float(rows[1]["z [m]"]) == 0.09
    assert float(rows[1]["static_compliance u w [m/N]"]) == float(grid["static_compliance"][0, 1, 0, 2])


def test_pictures_of_maps_curves_and_compliances(grid, tmp_path):
    for k, (data, quantity) in enumerate(
        ((grid, "frequency"), (grid.isel(x=2), "tracked_frequency"), (grid, "static_compliance"))
    ):
        draw(data, tmp_path / f"{k}.png", quantity)
        assert (tmp_path / f"{k}.png").stat().st_size > 10_000
    with pytest.raises(UnknownNameError, match="quantity to draw 'phase'; known: frequency"):
        draw(grid, tmp_path / "no.png", "phase")
    with pytest.raises(PrsError, match="the map has no frf_peak; ask for the quantity frf_peak"):
        draw(grid, tmp_path / "no.png", "frf_peak")
    with pytest.raises(PrsError, match="no pose has a value of frequency"):
        draw(grid.sel(z=0.12), tmp_path / "no.png")


def test_files_that_cannot_be_written_are_told_before_the_work(tmp_path):
    with pytest.raises(PrsError, match=r"found a name ending in '.mat', expected one of .nc, .zarr"):
        check_file(tmp_path / "map.mat")
    (tmp_path / "mine.zarr").mkdir()
    with pytest.raises(PrsError, match="exists and is no Zarr store"):
        check_file(tmp_path / "mine.zarr")
    with pytest.raises(PrsError, match="cannot be written"):
        check_file(tmp_path / "nowhere" / "map.nc")
