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


class ProgramError(EvaluationError):
    """A program that failed. `status`: its exit status, -N if signal N ended it."""

    def __init__(self, message, status):
        super().__init__(message, status)
        self.status = status

    def __str__(self):
        return self.args[0]


def _built(name):
    return ROOT / "build/devel/lib/racecar_mcl" / name


def find(name):
    """The command that starts a program, as a list of words."""
    if _built(name).exists():
        return [str(_built(name))]
    if shutil.which("rosrun"):
        return ["rosrun", "racecar_mcl", name]
    raise EvaluationError(f"program {name} not found: scripts/setup builds it")


def file_of(name):
    """The file of a program."""
    if _built(name).exists():
        return _built(name)
    import roslib.packages  # of an installation only
    found = roslib.packages.find_node("racecar_mcl", name)
    if not found:
        raise EvaluationError(f"program {name} not found: scripts/setup builds it")
    return Path(found[0])


def run(name, arguments):
    """Runs a program and returns its stdout. Raises ProgramError with its stderr if it fails."""
    result = subprocess.run(find(name) + [str(word) for word in arguments], stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if result.returncode != 0:
        message = result.stderr.decode(errors="replace").strip()
        ended = f"{name} exited with status {result.returncode}"
        raise ProgramError(message or ended, result.returncode)
    return result.stdout.decode()
