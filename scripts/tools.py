"""Where the built programs are, and how scripts run them."""

import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = ROOT / ".build" / "ws" / "devel" / "lib" / "flight_corridor"


class ToolError(Exception):
    """A program failed; the text is what it said last."""


def run_tool(name, *arguments):
    """Runs a program quietly.  @return what it printed."""
    program = PROGRAMS / name
    if not program.exists():
        raise ToolError(f"{program} is not built: run ./scripts/setup")
    done = subprocess.run([str(program), *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        last = done.stderr.strip().splitlines()[-1:] or [f"exit code {done.returncode}"]
        raise ToolError(last[0])
    return done.stdout
