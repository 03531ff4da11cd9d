"""Figures: each draws what the results hold."""

from __future__ import annotations

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


def test_figures_of_a_sweep(scene: mpjr.Scene, tmp_path: Path) -> None:
    found = mpjr.sweep(scene, {"phase.slide.velocity": [1e-3, 1e-1]}, tmp_path / "cases", progress=False)
    axes = plot.friction(found)
    assert axes.get_xscale() == "log" and numpy.allclose(axes.lines[0].get_ydata(), 0.2, rtol=1e-6)
    assert len(plot.onset(found).lines) == 2
    pyplot.close("all")


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
