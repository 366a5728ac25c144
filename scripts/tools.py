"""Where the built programs are, and how scripts run them."""

import fcntl
import functools
import hashlib
import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
WORKSPACE = ROOT / ".build" / "ws"
LIBRARIES = WORKSPACE / "devel" / "lib"
PROGRAMS = LIBRARIES / "flight_corridor"
AS_BUILT = "FLIGHT_CORRIDOR_AS_BUILT"  # where this variable is set, nothing is built


class ToolError(Exception):
    """A program failed; the text is what it said last."""


@functools.lru_cache(maxsize=None)
def find_tool(name):
    """A program, built from the code that is there: figures of an older one would pass for this one's."""
    if not (PROGRAMS / name if AS_BUILT in os.environ else WORKSPACE / "build" / "CMakeCache.txt").exists():
        raise ToolError(f"{PROGRAMS / name} is not built: run ./scripts/setup")
    if AS_BUILT in os.environ:
        return PROGRAMS / name
    with open(WORKSPACE / "build" / "scripts.lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # two at once would spoil each other's files
        done = subprocess.run(["cmake", "--build", WORKSPACE / "build", "-j", str(os.cpu_count()), "--target", name],
                              capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ToolError(f"{name} does not build:\n{(done.stdout + done.stderr).strip()}")
    return PROGRAMS / name


def run_tool(name, *arguments):
    """Runs a program quietly.  @return what it printed."""
    done = subprocess.run([str(find_tool(name)), *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        if done.returncode < 0:
            raise ToolError(f"{name}: ended by signal {-done.returncode}")
        _, found, said = done.stderr.rpartition(f"{name}: ")
        raise ToolError(f"{name}: {said.strip()}" if found else f"{name}: exit code {done.returncode}")
    return done.stdout


def digest(*parts):
    """A short name for texts and the bytes of files: it changes when any of them does."""
    sha = hashlib.sha256()
    for part in parts:
        data = part.read_bytes() if isinstance(part, pathlib.Path) else str(part).encode()
        sha.update(len(data).to_bytes(8, "big") + data)
    return sha.hexdigest()[:16]


@functools.lru_cache(maxsize=None)
def tool_digest(name, *libraries):
    """A short name for a program as it is built, and for those libraries of ours that decide what it does."""
    files = [LIBRARIES / f"lib{library}.so" for library in libraries]
    return digest(find_tool(name), *[file for file in files if file.exists()])  # a static one is in the program
