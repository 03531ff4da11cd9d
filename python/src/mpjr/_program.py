"""Finds the program, starts it, and makes exceptions and warnings of what it says."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import threading
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

#: Seconds that ranks have for a checkpoint when they are interrupted, before they are ended.
GRACE = 5.0


class MpjrError(Exception):
    """What the program refused or could not do; the text is its own.

    Attributes:
        exit_code: that of the program.
    """

    exit_code: int

    def __init__(self, text: str, exit_code: int = 1) -> None:
        super().__init__(text)
        self.exit_code = exit_code


class SceneError(MpjrError):
    """The scene or the command line is wrong; nothing was written."""


class ConvergenceError(MpjrError):
    """The solver could not converge; results up to the last accepted step are kept."""


class FileError(MpjrError):
    """A file could not be read or written."""


class StoppedError(MpjrError):
    """Stopped by a signal; results and a checkpoint are kept."""


class DoubtfulError(MpjrError):
    """There are warnings, and they were denied; results are kept."""


class MpjrWarning(UserWarning):
    """What makes a result doubtful."""


_ERRORS: dict[int, type[MpjrError]] = {
    2: SceneError,
    3: ConvergenceError,
    4: FileError,
    5: StoppedError,
    6: DoubtfulError,
}


def program() -> str:
    """The path of the program: the environment variable ``MPJR``, or what is on the ``PATH``."""
    found = os.environ.get("MPJR") or shutil.which("mpjr")
    if found is None:
        raise FileNotFoundError("mpjr is not on the PATH; install it, or set the environment variable MPJR")
    return found


def call(arguments: Sequence[str], cwd: Path | None = None) -> str:
    """Runs a command that solves nothing; its standard output."""
    done = subprocess.run([program(), *arguments], cwd=cwd, capture_output=True, text=True, check=False)
    _judge(done.returncode, done.stderr)
    return done.stdout


def solve(
    arguments: Sequence[str],
    ranks: int,
    told: Callable[[str], None],
    launcher: Sequence[str] = ("mpirun", "-n"),
) -> None:
    """Runs a command on so many ranks and hands each line of its output to ``told``; ends the ranks when interrupted."""
    if ranks < 1:
        raise ValueError(f"ranks must be at least 1, got {ranks}")
    start = [*launcher, str(ranks)] if ranks > 1 else []
    process = subprocess.Popen(
        [*start, program(), *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A group of its own: an interrupt reaches it through `_end` alone.
        start_new_session=True,
    )
    assert process.stdout is not None and process.stderr is not None
    said: list[str] = []
    stderr = process.stderr
    listener = threading.Thread(target=lambda: said.extend(stderr), daemon=True)
    listener.start()
    try:
        for line in process.stdout:
            told(line.rstrip("\n"))
        code = process.wait()
    except BaseException:
        _end(process)
        raise
    finally:
        listener.join(GRACE)
        process.stdout.close()
        process.stderr.close()
    _judge(code, "".join(said))


def _end(process: subprocess.Popen[str]) -> None:
    """Ends a launcher with its ranks; they have a moment for a checkpoint."""
    for ending in (signal.SIGUSR1, signal.SIGTERM, signal.SIGKILL):
        try:
            # The launcher passes signals on to its ranks; what is left goes with the group.
            if ending == signal.SIGKILL:
                os.killpg(process.pid, ending)
            else:
                process.send_signal(ending)
            process.wait(GRACE)
            return
        except ProcessLookupError:
            return
        except subprocess.TimeoutExpired:
            continue


def _judge(code: int, stderr: str) -> None:
    """Warnings of the program become warnings, an exit code other than 0 an exception."""
    lines = stderr.splitlines()
    for line in lines:
        if line.startswith("warning: "):
            warnings.warn(line.removeprefix("warning: "), MpjrWarning, stacklevel=4)
    if code == 0:
        return
    own = [line.removeprefix("mpjr: ") for line in lines if line.startswith("mpjr: ")]
    # Launchers have exit codes of their own: the kind is told by what the program said.
    text = "\n".join(own) or stderr.strip() or f"mpjr ended with exit code {code}"
    if code not in _ERRORS and re.search(r"stopped by a signal", text):
        code = 5
    raise _ERRORS.get(code, MpjrError)(text, code)
