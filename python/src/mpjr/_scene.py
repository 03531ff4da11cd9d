"""Scenes: built, edited, checked and written."""

from __future__ import annotations

import copy
import json
import os
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

from ._program import call


@dataclass(frozen=True)
class Check:
    """What a run of a scene would do.

    Attributes:
        warnings: what would make its results doubtful, each as ``KEY: what``.
        unknowns: of the problem.
        steps: of the whole history.
        duration: of the history, s.
        seconds: an estimate of the run's, on one rank.
        memory_bytes: an estimate.
    """

    warnings: tuple[str, ...]
    unknowns: int
    steps: int
    duration: float
    seconds: float
    memory_bytes: float


class Scene:
    """A scene as a table of keys.

    Keys are reached by their paths, as with ``--set``: ``scene["layer.depth"]``, ``scene["phase.slide.velocity"]`` (a phase by
    its name or its index), ``scene["material.arms.0.time"]``. Files that a scene names are looked for in ``directory``.
    """

    def __init__(self, table: dict[str, Any], directory: str | os.PathLike[str] = ".") -> None:
        self.table = copy.deepcopy(table)
        self.directory = Path(directory)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scene:
        """Reads a scene file; it is checked only by :meth:`check` or a run."""
        path = Path(path)
        return cls(tomllib.loads(path.read_text(encoding="utf-8")), path.parent)

    @classmethod
    def parse(cls, text: str, directory: str | os.PathLike[str] = ".") -> Scene:
        """The scene of a TOML text."""
        return cls(tomllib.loads(text), directory)

    @classmethod
    def like(cls, kind: str = "layer") -> Scene:
        """A first scene, as ``mpjr new --like KIND``: ``layer``, ``wheel``, ``rough``, ``laminate`` or ``space``."""
        with tempfile.TemporaryDirectory() as directory:
            path = Path(directory) / "scene.toml"
            call(["new", str(path), "--like", kind])
            return cls(tomllib.loads(path.read_text(encoding="utf-8")))

    def copy(self) -> Scene:
        """A scene that changes without this one."""
        return Scene(self.table, self.directory)

    def __getitem__(self, path: str) -> Any:
        target: Any = self.table
        before = ""
        for key in path.split("."):
            target = target[_index(target, before, key)]
            before = key
        return target

    def __setitem__(self, path: str, value: Any) -> None:
        *parents, last = path.split(".")
        target: Any = self.table
        before = ""
        for key in parents:
            if isinstance(target, dict):
                target.setdefault(key, {})
            target = target[_index(target, before, key)]
            before = key
        if not isinstance(target, (dict, list)):
            raise KeyError(f"{path}: {before} is {target!r}, which has no keys")
        target[_index(target, before, last)] = value

    def __delitem__(self, path: str) -> None:
        *parents, last = path.split(".")
        target = self[".".join(parents)] if parents else self.table
        del target[_index(target, parents[-1] if parents else "", last)]

    def __contains__(self, path: str) -> bool:
        try:
            self[path]
        except (KeyError, IndexError, TypeError):
            return False
        return True

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self.table == other.table

    def __repr__(self) -> str:
        return f"Scene({self.table.get('title', 'without a title')!r})"

    def to_toml(self) -> str:
        """The scene as TOML."""
        return tomli_w.dumps(self.table)

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Writes the scene; paths of other files in it stay as they are, relative to its directory."""
        path = Path(path)
        path.write_text(self.to_toml(), encoding="utf-8")
        return path

    def check(self) -> Check:
        """Has the program read and check the scene; nothing is solved.

        Raises:
            SceneError: with the program's text, which names the key, the reason and what would be accepted.
        """
        with self.as_file() as path:
            found = json.loads(call(["check", str(path), "--json"]))
        return Check(
            warnings=tuple(found["warnings"]),
            unknowns=int(found["unknowns"]),
            steps=int(found["steps"]),
            duration=float(found["duration"]),
            seconds=float(found["seconds"]),
            memory_bytes=float(found["memory_bytes"]),
        )

    def as_file(self) -> _SceneFile:
        """The scene as a file beside those that it names, for as long as a ``with`` block."""
        return _SceneFile(self)


class _SceneFile:
    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def __enter__(self) -> Path:
        handle, name = tempfile.mkstemp(".toml", "scene-", self._scene.directory)
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(self._scene.to_toml())
        self._path = Path(name)
        return self._path

    def __exit__(self, *_: object) -> None:
        self._path.unlink(missing_ok=True)


def _index(target: Any, before: str, key: str) -> Any:
    """What ``key`` is in ``target``: itself in a table; of an array the position of the element of that name, or a number."""
    if not isinstance(target, list):
        return key
    for position, element in enumerate(target):
        name = element.get("name", element.get("region")) if isinstance(element, dict) else None
        if name == key or (name is None and before == "phase" and key == f"phase-{position + 1}"):
            return position
    if key.isdigit() and int(key) < len(target):
        return int(key)
    raise KeyError(f"{before} has no {key!r}")
