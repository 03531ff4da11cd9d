"""Measured surfaces, where SurfaceTopography is installed."""

from __future__ import annotations

from pathlib import Path

import numpy
import pytest

import mpjr

SurfaceTopography = pytest.importorskip("SurfaceTopography")


def test_a_line_scan_becomes_an_indenter(scene: mpjr.Scene, tmp_path: Path) -> None:
    """Micrometres become metres; the scene takes what is written."""
    x = numpy.linspace(0.0, 2.0e6, 101)
    line = SurfaceTopography.NonuniformLineScan(x, 500.0 * numpy.cos(2e-6 * numpy.pi * x), unit="µm")
    profile = mpjr.surface(line)
    assert isinstance(profile, mpjr.Profile)
    assert profile.x[-1] == pytest.approx(2.0) and profile.z[0] == pytest.approx(5e-4)
    scene["indenter"] = profile.indenter(tmp_path / "scan.txt", extend="periodic", period=1.0)
    scene["layer.width"] = 2.0
    scene["indenter.period"] = 2.0
    assert scene.check().steps == 8


def test_a_map_is_cut(tmp_path: Path) -> None:
    heights = numpy.outer(numpy.arange(4.0), numpy.ones(3))
    found = mpjr.surface(SurfaceTopography.Topography(heights, (4.0, 3.0), unit="mm"))
    assert isinstance(found, mpjr.Map)
    assert found.z.shape == (4, 3) and found.z[2, 1] == pytest.approx(2e-3)
    assert numpy.allclose(found.cut(1e-3).z, found.z[:, 1])
