"""Measured surfaces, where SurfaceTopography is installed."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy
import numpy.typing
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


_SPACE: dict[str, object] = {
    "layer": {"width": [1.0, 0.5], "depth": 0.5, "cells": [8, 5, 2], "sides": "periodic"},
    "material": {"shear_modulus": 1e6, "poisson_ratio": 0.3},
    "contact": {},
    "phase": [{"name": "away", "duration": 1.0, "steps": 1, "approach": 1e-6}],
}


def _gap(tmp_path: Path, indenter: dict[str, object]) -> numpy.typing.NDArray[numpy.float64]:
    """The heights over the nodes of a face that the indenter does not reach, above its lowest: h[i, j] of the solver itself."""
    scene = mpjr.Scene({**_SPACE, "indenter": {"extend": "periodic", "offset": 1.0, **indenter}})
    results = mpjr.run(scene, tmp_path / "gap.h5", progress=False)
    gap = numpy.asarray(results["interface/gap"])[-1].reshape(8, 5)
    return gap - gap.min()


def _topography() -> object:
    x, y = numpy.meshgrid(numpy.arange(8.0), numpy.arange(5.0), indexing="ij")
    return SurfaceTopography.Topography(1e-6 * ((37.0 * x * x + 11.0 * y + 5.0 * x * y) % 97.0), (1.0, 0.5), unit="m", periodic=True)


def test_a_map_is_an_indenter(tmp_path: Path) -> None:
    found = mpjr.surface(_topography())
    assert isinstance(found, mpjr.Map)
    table = found.indenter(tmp_path / "map.npy", invert=False, extend="periodic")
    expected = found.z - found.z.min()
    assert numpy.allclose(_gap(tmp_path, {"offset": 1.0, **table}), expected, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("kind", ["D", "F", "L", "I"])
def test_x3p_as_surface_topography_reads_it(tmp_path: Path, kind: str) -> None:
    file = tmp_path / "map.x3p"
    _topography().to_x3p(file, dtype=kind)  # type: ignore[attr-defined]
    _same(tmp_path, file)


@pytest.mark.parametrize("binary", [True, False])
def test_sdf_as_surface_topography_reads_it(tmp_path: Path, binary: bool) -> None:
    file = tmp_path / "map.sdf"
    heights = numpy.asarray(_topography().heights()).T.ravel()  # type: ignore[attr-defined]
    if binary:
        header = struct.pack("<8s10s12s12sHHddddBBB", b"bISO-1.0", b"", b"", b"", 8, 5, 0.125, 0.1, 1e-6, -1.0, 0, 5, 0)
        file.write_bytes(header + numpy.round(heights * 1e6).astype("<i2").tobytes())
    else:
        names = "NumPoints = 8\nNumProfiles = 5\nXscale = 0.125\nYscale = 0.1\nZscale = 1e-6\nZresolution = -1\nCompression = 0\nDataType = 7"
        file.write_text(f"aISO-1.0\n{names}\nCheckType = 0\n*\n" + " ".join(str(h * 1e6) for h in heights) + "\n")
    _same(tmp_path, file)


def test_npy_as_surface_topography_reads_it(tmp_path: Path) -> None:
    file = tmp_path / "map.npy"
    numpy.save(file, numpy.asarray(_topography().heights()))  # type: ignore[attr-defined]
    _same(tmp_path, file, spacing=[0.125, 0.1])


def _same(tmp_path: Path, file: Path, **keys: object) -> None:
    read = SurfaceTopography.open_topography(str(file)).topography(physical_sizes=(1.0, 0.5) if keys else None)
    metres = 1e-6 if read.unit == "µm" else 1.0
    heights = numpy.asarray(read.heights()) * metres
    assert heights.shape == (8, 5)
    gap = _gap(tmp_path, {"profile": "map", "file": str(file), **keys})
    assert numpy.allclose(gap, heights - heights.min(), rtol=0.0, atol=1e-15)
