"""Runs and sweeps of the built program."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
import time
from pathlib import Path

import numpy
import pytest
import xarray

import mpjr


def test_results_are_a_tree_with_units(run: xarray.DataTree) -> None:
    """Coulomb's law holds: Q = 0.2 N where all slips; 4 + 4 steps and the unloaded state."""
    history = run["history"]
    assert history.sizes["time"] == 9 and history["normal_force"].attrs["units"] == "N/m"
    last = history.isel(time=-1)
    assert float(last["tangential_force"]) == pytest.approx(0.2 * float(last["normal_force"]), rel=1e-6)
    pressure = run["interface/pressure"]
    assert pressure.dims == ("time", "x") and pressure.sizes["x"] == 16
    assert run["bulk/stress"].dims == ("time", "node", "component")
    assert list(run["bulk/component"].values) == ["xx", "zz", "yy", "xz"]
    assert run.attrs["status"] == "complete"
    # N is the integral of the pressure: 16 equal parts of the period.
    assert float(pressure.isel(time=-1).sum() / 16) == pytest.approx(float(last["normal_force"]), rel=1e-6)


def test_ranks_give_the_same(scene: mpjr.Scene, tmp_path: Path, run: xarray.DataTree) -> None:
    other = mpjr.run(scene, tmp_path / "two.h5", ranks=2, progress=False)
    difference = numpy.abs(other["history/normal_force"].values - run["history/normal_force"].values).max()
    assert difference < 1e-9


def test_a_wrong_scene_is_refused(scene: mpjr.Scene, tmp_path: Path) -> None:
    scene["friction.coefficient"] = -1.0
    with pytest.raises(mpjr.SceneError, match="friction.coefficient: must be a friction coefficient, at least 0"):
        mpjr.run(scene, tmp_path / "run.h5", progress=False)
    assert not (tmp_path / "run.h5").exists()
    with pytest.raises(mpjr.FileError, match="does not exist"):
        del scene["friction"]
        mpjr.run(scene, tmp_path / "none" / "run.h5", progress=False)


def test_warnings_are_warnings(scene: mpjr.Scene, tmp_path: Path) -> None:
    scene["material.poisson_ratio"] = 0.49
    with pytest.warns(mpjr.MpjrWarning, match="layer.element"):
        mpjr.run(scene, tmp_path / "run.h5", progress=False)


def test_an_interrupt_ends_the_ranks(scene: mpjr.Scene, tmp_path: Path) -> None:
    scene["phase.slide.steps"] = 200_000
    out = tmp_path / "long.h5"

    def interrupt() -> None:
        while not out.exists():
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt, daemon=True).start()
    with pytest.raises(KeyboardInterrupt):
        mpjr.run(scene, out, ranks=2, progress=False)
    time.sleep(0.5)
    left = subprocess.run(["pgrep", "-f", str(out)], capture_output=True, text=True, check=False).stdout
    assert left == "", "ranks are left"
    with mpjr.open(out) as stopped:
        assert stopped.attrs["status"] == "stopped"


def test_a_sweep_has_a_summary_and_its_cases(scene: mpjr.Scene, tmp_path: Path) -> None:
    found = mpjr.sweep(
        scene,
        {"friction.coefficient": [0.1, 0.2], "phase.slide.velocity": [0.01, 0.02]},
        tmp_path / "cases",
        ranks=2,
        progress=False,
    )
    assert len(found) == 4 and set(found.summary["status"].values) == {"complete"}
    ratio = found.summary["tangential_force"] / found.summary["normal_force"]
    assert numpy.allclose(ratio, [0.1, 0.1, 0.2, 0.2], rtol=1e-6)
    with found[-1] as case:
        assert float(case["history/sliding"][-1]) == pytest.approx(1.0)
    # What is complete is not solved again.
    before = (tmp_path / "cases" / "case-0000.h5").stat().st_mtime_ns
    mpjr.sweep(scene, {key: list(dict.fromkeys(found.summary[key].values.tolist())) for key in found.keys}, tmp_path / "cases", progress=False)
    assert (tmp_path / "cases" / "case-0000.h5").stat().st_mtime_ns == before


def test_other_files_are_refused(tmp_path: Path) -> None:
    xarray.Dataset({"a": 1}).to_netcdf(tmp_path / "other.h5", engine="h5netcdf")
    with pytest.raises(ValueError, match="not one that mpjr wrote"):
        mpjr.open(tmp_path / "other.h5")
