"""Figures: each draws what the results hold."""

from __future__ import annotations

import subprocess
from pathlib import Path

import matplotlib.pyplot as pyplot
import numpy
import pytest
import xarray

import mpjr
from mpjr import plot


def test_every_figure_of_a_run(run: xarray.DataTree, tmp_path: Path) -> None:
    for name in ("history", "energy", "tractions", "profile", "stick_slip", "stress"):
        axes = getattr(plot, name)(run)
        axes.figure.savefig(tmp_path / f"{name}.png")
        assert axes.get_xlabel()
        pyplot.close(axes.figure)


def test_curves_are_the_columns(run: xarray.DataTree) -> None:
    axes = plot.history(run)
    assert [line.get_label() for line in axes.lines] == ["N", "Q", "hysteretic"]
    assert numpy.array_equal(axes.lines[1].get_ydata(), run["history/tangential_force"])
    pyplot.close(axes.figure)
    axes = plot.tractions(run, time=10.0)
    assert numpy.array_equal(axes.lines[0].get_ydata(), run["interface/pressure"].sel(time=10.0))
    pyplot.close(axes.figure)


def test_stick_is_what_the_program_counts(scene: mpjr.Scene, tmp_path: Path) -> None:
    """The share of the contact that is drawn as sticking is the stick_fraction of the history, with each law."""
    laws = [
        {"law": "coulomb_elastic_slip", "coefficient": 0.2, "elastic_slip": 1e-5},
        {"law": "coulomb_tanh", "coefficient": 0.2, "regularisation": 1e-5},
        {"law": "coulomb", "coefficient": 0.2},
        {"law": "coulomb", "coefficient": "0.2 + 0.1*exp(-v/1e-3)"},
    ]
    scene["layer.cells"] = [64, 16]
    scene["phase.slide.distance"] = 2e-4
    for number, law in enumerate(laws):
        scene["friction"] = law
        run = mpjr.run(scene, tmp_path / f"{number}.h5", progress=False)
        state = plot.stick_slip(run).collections[0].get_array().reshape(64, -1)
        contact, stick = (state > 0).sum(0), (state == 1).sum(0)
        history = run["history"].to_dataset().sel(time=run["interface/time"].values)
        numpy.testing.assert_allclose(stick / contact.clip(1), history["stick_fraction"], atol=1e-12, err_msg=str(law))
        assert 0 < stick.sum() < contact.sum(), f"{law}: {stick} of {contact}"
        pyplot.close("all")


def test_figures_of_a_sweep(scene: mpjr.Scene, tmp_path: Path) -> None:
    """Total friction less the hysteretic is Coulomb's coefficient, 0.2; as `mpjr plot` has it, over the end of sliding."""
    vary = {"layer.depth": [0.5, 1.0], "phase.slide.velocity": [1e-3, 1e-1]}
    found = mpjr.sweep(scene, vary, tmp_path / "cases", progress=False)
    axes = plot.friction(found)
    assert axes.get_xscale() == "log" and len(axes.lines) == 4
    for hysteretic, total in [axes.lines[:2], axes.lines[2:]]:
        assert numpy.array_equal(total.get_xdata(), [1e-3, 1e-1])
        numpy.testing.assert_allclose(total.get_ydata() - hysteretic.get_ydata(), 0.2, rtol=1e-6)
    with found[0] as case:
        last = case["history"].to_dataset().isel(time=-1)
        # One step is a quarter of the phase, longer than the end that is averaged.
        expected = float(last["hysteretic_force"] / last["normal_force"])
        assert axes.lines[0].get_ydata()[0] == pytest.approx(expected, rel=1e-12)
    axes = plot.onset(found)
    assert len(axes.lines) == 4 and "mm" in axes.get_xlabel()
    # 1 m in all, from the last row before the indenter moves on.
    displacement = axes.lines[0].get_xdata()
    assert displacement[0] == 0.0 and displacement[-1] == pytest.approx(1e3)
    pyplot.close("all")


def test_names_are_those_of_the_program() -> None:
    """Each figure has the name that it has for ``mpjr plot``."""
    told = subprocess.run([mpjr.program(), "plot", "--help"], capture_output=True, text=True, check=True).stdout
    names = {line.split()[0] for line in told.splitlines() if line.startswith("  ") and line.split()}
    assert {name.replace("_", "-") for name in plot.__all__} <= names


def test_figures_in_space(tmp_path: Path) -> None:
    scene = mpjr.Scene.like("space")
    scene.directory = tmp_path
    scene["layer.cells"] = [6, 8, 2]
    scene["phase.drag.steps"] = 2
    run = mpjr.run(scene, tmp_path / "space.h5", progress=False)
    assert [line.get_label() for line in plot.history(run).lines] == ["N", "Q x", "Q y", "hysteretic x", "hysteretic y"]
    for name in ("energy", "pressure", "shear", "gap", "stick_slip", "tractions", "profile"):
        axes = getattr(plot, name)(run)
        axes.figure.savefig(tmp_path / f"{name}.png")
        assert axes.get_xlabel()
    pressure = numpy.asarray(run["interface/pressure"])[-1].reshape(7, 9)
    i, j = numpy.unravel_index(pressure.argmax(), pressure.shape)
    assert numpy.array_equal(plot.tractions(run).lines[0].get_ydata(), pressure[:, j])
    assert numpy.array_equal(plot.tractions(run, along="y").lines[0].get_ydata(), pressure[i])
    drawn = plot.pressure(run).collections[0].get_array()
    assert numpy.allclose(numpy.ma.filled(drawn, 0.0).reshape(9, 7), pressure.T)
    with pytest.raises(ValueError, match="left to mpjr plot"):
        plot.stress(run)
    pyplot.close("all")


def test_what_is_seen_from_above_is_refused_in_the_plane(run: xarray.DataTree) -> None:
    with pytest.raises(ValueError, match="in space"):
        plot.pressure(run)
    pyplot.close("all")
