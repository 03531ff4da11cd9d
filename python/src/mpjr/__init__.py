"""Scenes, runs and results of mpjr, a solver for transient viscoelastic contact with friction.

All quantities are SI numbers. The program itself is found on the ``PATH``, or by the environment variable ``MPJR``.
"""

from . import plot
from ._program import (
    ConvergenceError,
    DoubtfulError,
    FileError,
    MpjrError,
    MpjrWarning,
    SceneError,
    StoppedError,
    program,
)
from ._results import open, scene_of
from ._run import Sweep, run, sweep
from ._scene import Check, Scene
from ._surface import Map, Profile, surface

__version__ = "0.1.0"

__all__ = [
    "Check",
    "ConvergenceError",
    "DoubtfulError",
    "FileError",
    "Map",
    "MpjrError",
    "MpjrWarning",
    "Profile",
    "Scene",
    "SceneError",
    "StoppedError",
    "Sweep",
    "open",
    "plot",
    "program",
    "run",
    "scene_of",
    "surface",
    "sweep",
]
