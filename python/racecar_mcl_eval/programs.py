"""Locates and runs the package's C++ programs."""
import shutil
import subprocess
from pathlib import Path

from . import EvaluationError


def _package_folder():
    """The folder with maps/ and config/: the source tree, or share/racecar_mcl of an installation."""
    source = Path(__file__).resolve().parents[2]
    if (source / "package.xml").exists():
        return source
    import rospkg  # of an installation only
    return Path(rospkg.RosPack().get_path("racecar_mcl"))


ROOT = _package_folder()


def find(name):
    """The command that starts a program, as a list of words."""
    built = ROOT / "build/devel/lib/racecar_mcl" / name
    if built.exists():
        return [str(built)]
    if shutil.which("rosrun"):
        return ["rosrun", "racecar_mcl", name]
    raise EvaluationError(f"program {name} not found: scripts/setup builds it")


def run(name, arguments):
    """Runs a program and returns its stdout. Raises EvaluationError with its stderr if it fails."""
    result = subprocess.run(find(name) + [str(word) for word in arguments], stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if result.returncode != 0:
        message = result.stderr.decode(errors="replace").strip()
        raise EvaluationError(message or f"{name} exited with status {result.returncode}")
    return result.stdout.decode()
