"""Memory and descriptors of a running process, from /proc."""
import os
from collections import namedtuple
from pathlib import Path

from ..ros_graph import descendants_of

# `time`: s after the beginning of the drive; `resident`: MB; `descriptors`: number of open ones.
Sample = namedtuple("Sample", "time resident descriptors")


def resident_megabytes(status):
    """The resident memory (MB) in the text of /proc/PID/status; 0 for a process that has ended."""
    for line in status.splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) / 1024.0
    return 0.0


def resident_of(pid):
    """The resident memory (MB) of a process."""
    return resident_megabytes(Path(f"/proc/{pid}/status").read_text())


def sample(pid, time):
    """The Sample of a process at `time`; None if it does not run."""
    folder = Path(f"/proc/{pid}")
    try:
        resident = resident_of(pid)
        descriptors = len(os.listdir(folder / "fd"))
    except OSError:
        return None
    return Sample(time, resident, descriptors) if resident > 0.0 else None


def find_descendant(pid, name):
    """The process id of the node `name` below `pid`; None if it does not run."""
    for child in descendants_of(pid):
        try:
            words = Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if f"__name:={name}".encode() in words:
            return child
    return None
