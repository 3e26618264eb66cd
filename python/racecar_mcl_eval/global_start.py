"""Outcome of a global localization: whether the car was localized, and whether the status was correct."""
from dataclasses import dataclass

import numpy as np

from .columns import DEGRADED, LOCALIZED, LOST

MAX_ERROR = 0.5  # m; an estimate with a larger error is wrong
HELD_FRACTION = 0.98  # of the scans from the first correct one on that must be correct
MAX_DISTANCE = 15.0  # m driven until the first correct scan


@dataclass
class GlobalStart:
    """Durations in s; each scan counts for the time since the previous one."""
    held: bool          # localized within MAX_DISTANCE and not lost again
    time: float         # in all
    misleading: float   # status localized, but wrong
    correct: float
    false_alarm: float  # status degraded or lost, but correct


def first_held(correct):
    """Index of the first correct scan from which on at least HELD_FRACTION of the scans are correct, or None."""
    correct = np.asarray(correct, dtype=bool)
    fraction = np.cumsum(correct[::-1])[::-1] / np.arange(len(correct), 0, -1)
    held = np.flatnonzero(correct & (fraction >= HELD_FRACTION))
    return int(held[0]) if len(held) > 0 else None


def measure(updates, truth):
    """The GlobalStart of a run's updates, over the scans with a truth; None if there are none."""
    compared = updates.against(truth)
    if compared is None:
        return None
    correct = compared.errors < MAX_ERROR
    alarm = np.isin(compared.status, (DEGRADED, LOST))
    first = first_held(correct)

    def seconds(flags):
        return float(compared.durations[flags].sum())
    return GlobalStart(first is not None and bool(compared.driven[first] <= MAX_DISTANCE),
                       float(compared.durations.sum()), seconds(~correct & (compared.status == LOCALIZED)),
                       seconds(correct), seconds(correct & alarm))
