"""Outcome of a run on a map that lacks a part of the building."""
from dataclasses import dataclass
from typing import Optional

import numpy as np

from . import protection
from .columns import LOCALIZED, LOST
from .trajectory import spans

WRONG_ERROR, GROSS_ERROR = 0.5, 2.0  # m
RECOVERED_ERROR = 0.15  # m
MIN_MAPPED = 0.75  # inlier ratio at the true pose from which on a scan counts as mapped
MIN_UNMAPPED_DISTANCE = 3.0  # m driven; shorter unmapped stretches are ignored


@dataclass
class Outcome:
    """Fractions of time, weighted by scan; those above the levels are fractions of updates."""
    rmse: float                     # m
    max_error: float                # m
    unmapped: float                 # the map does not explain the scan at the true pose
    wrong: float                    # error above WRONG_ERROR
    gross: float                    # error above GROSS_ERROR
    misleading: float               # status localized, but wrong
    false_alarm: float              # status lost, but not wrong
    recoveries: list                # m, as `recovery_distances` returns them
    above_level: Optional[tuple]    # per axis; None if the run has no levels


def recovery_distances(driven, mapped, errors):
    """For each unmapped stretch: the distance driven over mapped scans after it until the error is below
    RECOVERED_ERROR; infinite if it never is. A stretch at the end of the run is ignored."""
    found = []
    for first, last in spans(np.arange(len(driven)), ~mapped):
        if last + 1 == len(driven) or driven[last] - driven[first] < MIN_UNMAPPED_DISTANCE:
            continue
        recovered = np.flatnonzero(errors[last + 1:] < RECOVERED_ERROR)
        if len(recovered) == 0:
            found.append(np.inf)
            continue
        way = slice(last + 2, last + 2 + recovered[0])
        found.append(float(np.diff(driven)[way.start - 1:way.stop - 1][mapped[way]].sum()))
    return found


def measure(run, match):
    """The Outcome of a run with a truth; `match`: the ScanMatch of the scans at the true poses. None if the
    two have no time in common."""
    compared = run.updates.against(run.truth)
    if compared is None:
        return None
    # The last scan up to each update, whose stamp is that of its own scan.
    scan = np.maximum(0, np.searchsorted(match.stamps, compared.stamps, side="right") - 1)
    mapped = match.inlier_ratios[scan] >= MIN_MAPPED
    wrong = compared.errors > WRONG_ERROR

    def fraction(flags):
        return float(compared.durations[flags].sum() / max(1e-9, compared.durations.sum()))
    levels = protection.measure(run, np.inf)
    position = run.errors.summary()["position_error_m"]
    return Outcome(float(position["rmse"]), float(position["max"]), fraction(~mapped), fraction(wrong),
                   fraction(compared.errors > GROSS_ERROR), fraction(wrong & (compared.status == LOCALIZED)),
                   fraction(~wrong & (compared.status == LOST)),
                   recovery_distances(compared.driven, mapped, compared.errors),
                   levels and tuple(levels.fraction_above(axis) for axis in range(len(protection.AXES))))
