"""What became of a run on a map that lacks a part of the building."""
from dataclasses import dataclass
from typing import Optional

import numpy as np

from . import protection
from .trajectory import spans

OFF, FAR_OFF = 0.5, 2.0  # m
BACK = 0.15  # m; an error below it is as good as before
MAPPED = 0.75  # share of a scan's beams that the map has to explain for it to be of help
LEAST_LACKED = 3.0  # m driven; shorter stretches that the map does not explain are not counted


@dataclass
class Outcome:
    """Shares are of the time, by scans, but those of the levels: of the updates."""
    rmse: float                     # m
    max_error: float                # m
    lacking: float                  # where the map does not explain what the true pose sees
    off: float                      # more than OFF off
    far_off: float                  # more than FAR_OFF off
    trusted_wrong: float            # called localized while more than OFF off
    alarmed_right: float            # called lost while less off
    returns: list                   # m, as `returns` has them
    above_level: Optional[tuple]    # per axis; None of runs without levels


def returns(driven, mapped, errors):
    """After each stretch that the map lacks: metres driven where it does explain the scans until the
    error is small again; infinite where it never is. A stretch up to the end is left out."""
    found = []
    for first, last in spans(np.arange(len(driven)), ~mapped):
        if last + 1 == len(driven) or driven[last] - driven[first] < LEAST_LACKED:
            continue
        small = np.flatnonzero(errors[last + 1:] < BACK)
        if len(small) == 0:
            found.append(np.inf)
            continue
        way = slice(last + 2, last + 2 + small[0])
        found.append(float(np.diff(driven)[way.start - 1:way.stop - 1][mapped[way]].sum()))
    return found


def measure(run, fit):
    """`run` with its truth; `fit`: how the scans lie on the map from the truth (ScanFit). None where
    the two share no time."""
    true = run.updates.against(run.truth)
    if true is None:
        return None
    # Of the last scan up to the update; an update has the stamp of its scan.
    scan = np.maximum(0, np.searchsorted(fit.stamps, true.stamps, side="right") - 1)
    mapped = fit.near_share[scan] >= MAPPED
    off = true.errors > OFF

    def share(flags):
        return float(true.durations[flags].sum() / max(1e-9, true.durations.sum()))
    levels = protection.measure(run, np.inf)
    position = run.errors.summary()["position_error_m"]
    return Outcome(float(position["rmse"]), float(position["max"]), share(~mapped), share(off),
                   share(true.errors > FAR_OFF), share(off & (true.verdict == "localized")),
                   share(~off & (true.verdict == "lost")), returns(true.driven, mapped, true.errors),
                   levels and tuple(levels.share_above(axis) for axis in range(len(protection.AXES))))
