"""Measured surfaces, by SurfaceTopography."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy
from numpy.typing import NDArray

#: Metres in a unit of length.
_METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "µm": 1e-6, "um": 1e-6, "nm": 1e-9, "Å": 1e-10, "A": 1e-10, "pm": 1e-12}


@dataclass(frozen=True)
class Profile:
    """Elevations along a line, m."""

    x: NDArray[numpy.float64]
    z: NDArray[numpy.float64]

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Writes two columns, which the profile ``"sampled"`` of a scene reads."""
        path = Path(path)
        numpy.savetxt(path, numpy.column_stack([self.x, self.z]), header="x (m)  z (m)")
        return path

    def indenter(self, path: str | os.PathLike[str], **keys: Any) -> dict[str, Any]:
        """Writes the points and gives the ``[indenter]`` table that reads them.

        A surface that was measured from above has its peaks up: ``invert`` turns them towards the face.
        """
        return {
            "profile": "sampled",
            "file": str(self.write(path).absolute()),
            "extend": "error",
            "invert": True,
            "detrend": "mean",
            **keys,
        }


@dataclass(frozen=True)
class Map:
    """Elevations over a rectangle, m: ``z[i, j]`` at ``x[i]``, ``y[j]``."""

    x: NDArray[numpy.float64]
    y: NDArray[numpy.float64]
    z: NDArray[numpy.float64]

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Writes the heights as an array, ``[i, j]`` at ``x[i]``, ``y[j]``, which the profile ``"map"`` of a scene reads."""
        path = Path(path)
        if path.suffix != ".npy":
            raise ValueError(f"the name of an array must end in .npy, got {path}")
        numpy.save(path, numpy.ascontiguousarray(self.z, dtype=float))
        return path

    def indenter(self, path: str | os.PathLike[str], **keys: Any) -> dict[str, Any]:
        """Writes the heights and gives the ``[indenter]`` table, of a scene in space, that reads them.

        A surface that was measured from above has its peaks up: ``invert`` turns them towards the face.
        """
        return {
            "profile": "map",
            "file": str(self.write(path).absolute()),
            "spacing": [_spacing(self.x), _spacing(self.y)],
            "origin": [float(self.x[0]), float(self.y[0])],
            "extend": "error",
            "invert": True,
            "detrend": "mean",
            **keys,
        }

    def cut(self, y: float) -> Profile:
        """The line along x that is nearest to ``y``."""
        return Profile(self.x, self.z[:, int(numpy.abs(self.y - y).argmin())])


def surface(source: str | os.PathLike[str] | Any, *, channel: int | None = None) -> Profile | Map:
    """Reads a file of an instrument, or takes a topography of SurfaceTopography.

    Needs the extra ``mpjr[surface]``. Lengths become metres by the unit of the file, and are taken as metres where it has none.
    """
    try:
        import SurfaceTopography
    except ImportError as error:
        raise ImportError("mpjr.surface needs SurfaceTopography: pip install 'mpjr[surface]'") from error
    topography: Any = source
    if isinstance(source, (str, os.PathLike)):
        reader: Any = SurfaceTopography.open_topography(os.fspath(source))
        topography = reader.topography() if channel is None else reader.topography(channel_index=channel)
    metres = _METRES[topography.unit or "m"]
    if topography.dim == 1:
        x, z = topography.positions_and_heights()
        return Profile(numpy.asarray(x, float) * metres, _whole(z) * metres)
    x, y, z = topography.positions_and_heights()
    return Map(numpy.asarray(x, float)[:, 0] * metres, numpy.asarray(y, float)[0] * metres, _whole(z) * metres)


def _spacing(places: NDArray[numpy.float64]) -> float:
    """The distance of equally spaced places."""
    steps = numpy.diff(places)
    spacing = float((places[-1] - places[0]) / (len(places) - 1))
    if not numpy.allclose(steps, spacing, rtol=1e-6, atol=0.0):
        raise ValueError("the places of a map are not equally spaced; interpolate it to a grid first")
    return spacing


def _whole(heights: Any) -> NDArray[numpy.float64]:
    if numpy.ma.is_masked(heights):
        raise ValueError("the surface has points without a value; fill them, as by topography.interpolate_undefined_data()")
    return numpy.asarray(heights, float)
