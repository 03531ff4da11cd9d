"""Scenes: keys by their paths, files, and what the program says of them."""

from __future__ import annotations

from pathlib import Path

import pytest

import mpjr


def test_keys_are_reached_by_their_paths(scene: mpjr.Scene) -> None:
    assert scene["phase.slide.velocity"] == scene["phase.1.velocity"] == 0.02
    scene["material.arms.0.time"] = 2.0
    scene["solver.tolerance"] = 1e-9
    assert scene.table["material"]["arms"][0]["time"] == 2.0 and scene.table["solver"] == {"tolerance": 1e-9}
    assert "friction.coefficient" in scene
    other = scene.copy()
    del other["friction"]
    assert "friction" in scene and "friction" not in other and other != scene
    with pytest.raises(KeyError, match="no 'drag'"):
        scene["phase.drag.velocity"]


def test_a_scene_comes_back_from_its_file(scene: mpjr.Scene, tmp_path: Path) -> None:
    assert mpjr.Scene.load(scene.write(tmp_path / "scene.toml")) == scene
    assert mpjr.Scene.parse(scene.to_toml()) == scene


def test_a_check_says_what_a_run_would_do(scene: mpjr.Scene) -> None:
    """16 x 9 nodes of two displacements, periodic; 8 steps."""
    found = scene.check()
    assert found.steps == 8 and len(found.warnings) == 1 and found.warnings[0].startswith("phase.slide.steps: ")
    assert 200 < found.unknowns < 400 and found.duration == pytest.approx(10.0 + 1.0 / 0.02)


def test_errors_keep_the_program_s_text(scene: mpjr.Scene, tmp_path: Path) -> None:
    scene["layer.depht"] = 1.0
    with pytest.raises(mpjr.SceneError, match=r'layer\.depht: unknown key; did you mean "depth"\?') as error:
        scene.check()
    assert error.value.exit_code == 2
    assert not list(tmp_path.glob("scene-*")), "the file of the scene is left"


@pytest.mark.parametrize("kind", ["layer", "wheel", "rough", "laminate", "space"])
def test_first_scenes_are_valid(kind: str) -> None:
    assert mpjr.Scene.like(kind).check().warnings == ()
