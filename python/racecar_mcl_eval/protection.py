"""Evaluation of the protection levels: bounds that the error exceeds with at most a given probability."""
from dataclasses import dataclass

import numpy as np

from .columns import LOCALIZED, STATUS

AXES = ("along", "across", "heading")
RISK = 1e-3  # default probability that an error exceeds its level
ALARM_LIMIT = 0.5  # m; above this level the position is declared unavailable


@dataclass
class Protection:
    """One row per update with a truth: along and across the estimated heading (m), and heading (rad)."""
    stamps: np.ndarray     # ns
    errors: np.ndarray     # (N, 3), absolute
    levels: np.ndarray     # (N, 3), infinite if unknown
    localized: np.ndarray  # (N,), whether the status was localized

    def fraction_above(self, axis):
        """Fraction of updates with an error above the level."""
        return float((self.errors[:, axis] > self.levels[:, axis]).mean())

    def fraction_above_while_localized(self, axis):
        """The same of the localized updates; None if there are none."""
        above = (self.errors[:, axis] > self.levels[:, axis])[self.localized]
        return float(above.mean()) if len(above) else None

    def medians_while_localized(self, axis):
        """Median level and median error; None if the run was never localized."""
        if not self.localized.any():
            return None
        return (float(np.median(self.levels[self.localized, axis])),
                float(np.median(self.errors[self.localized, axis])))

    def regions(self, axis):
        """Fractions of updates in the regions of the Stanford diagram: nominal, misleading (error above the
        level) and unavailable (level above the alarm limit; never for the heading)."""
        error, level = self.errors[:, axis], self.levels[:, axis]
        misleading = error > level
        unavailable = ~misleading & (level > alarm_limit(axis))
        return {"nominal": float((~misleading & ~unavailable).mean()),
                "misleading": float(misleading.mean()), "unavailable": float(unavailable.mean())}


def alarm_limit(axis):
    return np.inf if AXES[axis] == "heading" else ALARM_LIMIT


def levels_of(updates):
    """(N, 3), or None if the updates have no levels."""
    columns = [updates.column(f"level_{axis}") for axis in AXES]
    return None if any(column is None for column in columns) else np.column_stack(columns)


def measure(run, max_gap):
    """The Protection of a run with a truth; None if no update has a truth, or there are no levels."""
    levels, status = levels_of(run.updates), run.updates.column(STATUS)
    if levels is None or status is None:
        return None
    errors, _, selected = run.update_errors(max_gap)
    if len(errors) == 0:
        return None
    yaw = run.updates.poses[selected, 2]
    cos, sin = np.cos(yaw), np.sin(yaw)
    in_base = np.column_stack((errors[:, 0] * cos + errors[:, 1] * sin,
                               errors[:, 1] * cos - errors[:, 0] * sin, errors[:, 2]))
    return Protection(run.updates.stamps[selected], np.abs(in_base), levels[selected],
                      status[selected] == LOCALIZED)
