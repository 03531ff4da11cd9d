"""The program that the tests call: the environment variable MPJR, or what is on the PATH."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import pytest

import mpjr

matplotlib.use("Agg")


@pytest.fixture
def scene(tmp_path: Path) -> mpjr.Scene:
    """A layer that is solved in a fraction of a second."""
    scene = mpjr.Scene.like("layer")
    scene.directory = tmp_path
    scene["layer.cells"] = [16, 8]
    scene["phase.indent.steps"] = 4
    scene["phase.slide.steps"] = 4
    return scene


@pytest.fixture
def run(scene: mpjr.Scene, tmp_path: Path) -> object:
    """Its results."""
    return mpjr.run(scene, tmp_path / "run.h5", progress=False)
