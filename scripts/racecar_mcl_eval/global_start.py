"""Whether a run that began anywhere on the map found the car, and whether its verdict told."""
from dataclasses import dataclass

import numpy as np

WRONG = 0.5  # m, an estimate further off is wrong
HELD_SHARE = 0.98  # of all scans from the first good one on that must be good for it to be held
FOUND_WITHIN = 15.0  # m driven


@dataclass
class GlobalStart:
    """Times are in s, each scan standing for the time since the one before."""
    held: bool
    time: float
    trusted_wrong: float  # called localized while wrong
    right: float
    false_alarm: float    # called degraded or lost while right


def first_held(good):
    """The first scan that is good, as nearly all after it are; None where there is none."""
    good = np.asarray(good, dtype=bool)
    share = np.cumsum(good[::-1])[::-1] / np.arange(len(good), 0, -1)
    held = np.flatnonzero(good & (share >= HELD_SHARE))
    return int(held[0]) if len(held) > 0 else None


def measure(updates, truth):
    """Of the updates of one run, at the scans for which there is a truth; None where there is none."""
    true = updates.against(truth)
    if true is None:
        return None
    good = true.errors < WRONG
    alarmed = np.isin(true.verdict, ("degraded", "lost"))
    first = first_held(good)

    def seconds(flags):
        return float(true.durations[flags].sum())
    return GlobalStart(first is not None and bool(true.driven[first] <= FOUND_WITHIN),
                       float(true.durations.sum()), seconds(~good & (true.verdict == "localized")),
                       seconds(good), seconds(good & alarmed))
