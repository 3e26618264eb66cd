"""Whether protection levels hold: the bounds that errors exceed with at most a chosen probability."""
from dataclasses import dataclass

import numpy as np

AXES = ("along", "across", "heading")
RISK = 1e-3  # share of updates whose error may exceed the level, by default
ALARM_LIMIT = 0.5  # m; a greater level says that the position is not to be used


@dataclass
class Protection:
    """A row per update with a truth: along and across the estimated car (m), and heading (rad)."""
    stamps: np.ndarray     # ns
    errors: np.ndarray     # (N, 3), without sign
    levels: np.ndarray     # (N, 3), infinite where nothing is known
    localized: np.ndarray  # (N,), whether the verdict said so

    def share_above(self, axis):
        """Of the updates, those with an error above the level."""
        return float((self.errors[:, axis] > self.levels[:, axis]).mean())

    def share_above_while_localized(self, axis):
        above = (self.errors[:, axis] > self.levels[:, axis])[self.localized]
        return float(above.mean()) if len(above) else None

    def medians_while_localized(self, axis):
        """Of level and error; None where the run was never localized."""
        if not self.localized.any():
            return None
        return (float(np.median(self.levels[self.localized, axis])),
                float(np.median(self.errors[self.localized, axis])))

    def regions(self, axis):
        """Shares of updates by what the level did for them: it held, it was exceeded, or it was too
        great to be of use. Levels of the heading are never too great."""
        error, level = self.errors[:, axis], self.levels[:, axis]
        misleading = error > level
        unavailable = ~misleading & (level > alarm_limit(axis))
        return {"nominal": float((~misleading & ~unavailable).mean()),
                "misleading": float(misleading.mean()), "unavailable": float(unavailable.mean())}


def alarm_limit(axis):
    return np.inf if AXES[axis] == "heading" else ALARM_LIMIT


def levels_of(updates):
    """(N, 3), or None of a run that has none."""
    columns = [updates.column(f"level_{axis}") for axis in AXES]
    return None if any(column is None for column in columns) else np.column_stack(columns)


def measure(run, max_gap):
    """None where no update has a truth or there are no levels."""
    levels, verdict = levels_of(run.updates), run.updates.column("verdict")
    if levels is None or verdict is None:
        return None
    errors, _, chosen = run.update_errors(max_gap)
    if len(errors) == 0:
        return None
    yaw = run.updates.poses[chosen, 2]
    cos, sin = np.cos(yaw), np.sin(yaw)
    of_car = np.column_stack((errors[:, 0] * cos + errors[:, 1] * sin,
                              errors[:, 1] * cos - errors[:, 0] * sin, errors[:, 2]))
    return Protection(run.updates.stamps[chosen], np.abs(of_car), levels[chosen],
                      verdict[chosen] == "localized")
