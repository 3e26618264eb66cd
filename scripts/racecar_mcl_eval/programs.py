"""The package's programs, where a build has left them."""
import shutil
import subprocess
from pathlib import Path

from . import EvaluationError

ROOT = Path(__file__).resolve().parents[2]


def find(name):
    """The words that start a program."""
    built = ROOT / "build/devel/lib/racecar_mcl" / name
    if built.exists():
        return [str(built)]
    if shutil.which("rosrun"):
        return ["rosrun", "racecar_mcl", name]
    raise EvaluationError(f"there is no program {name}: scripts/setup builds it")


def run(name, arguments):
    """Runs a program to its end; its complaint becomes the error's text. Returns what it printed."""
    result = subprocess.run(find(name) + [str(word) for word in arguments], stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if result.returncode != 0:
        complaint = result.stderr.decode(errors="replace").strip()
        raise EvaluationError(complaint or f"{name} ended with {result.returncode}")
    return result.stdout.decode()
