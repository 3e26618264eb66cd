"""Trajectories, TUM files, and errors of an estimate against the ground truth.

Same rules as `replay`: no alignment; one error per truth stamp within the estimate's time span; the estimate
is interpolated linearly between its two neighbours (yaw along the shorter arc) across at most `max_gap`
seconds.
"""
from dataclasses import dataclass

import numpy as np

from . import EvaluationError


def wrap(angle):
    """An angle normalised to [-pi, pi)."""
    return (np.asarray(angle) + np.pi) % (2.0 * np.pi) - np.pi


@dataclass
class Trajectory:
    """Poses (x, y, yaw: m, m, rad; one per row) at increasing stamps (int64 ns: a double in seconds resolves
    Unix times to 0.2 us only)."""
    stamps: np.ndarray
    poses: np.ndarray

    def __len__(self):
        return len(self.stamps)

    def seconds(self, start=None):
        """Stamps as seconds since `start` (ns), by default since the first."""
        first = self.stamps[0] if start is None else start
        return (self.stamps - first) * 1e-9

    def length(self):
        """Distance driven, m."""
        return float(np.hypot(*np.diff(self.poses[:, :2], axis=0).T).sum())

    def rate(self):
        """Poses per second."""
        return (len(self) - 1) / self.seconds()[-1] if len(self) > 1 else 0.0


def in_order(stamps, poses):
    """A Trajectory sorted by stamp; of equal stamps the first is kept."""
    stamps, poses = np.asarray(stamps, dtype=np.int64), np.asarray(poses, dtype=float)
    kept, first = np.unique(stamps, return_index=True)
    return Trajectory(kept, poses[first])


def parse_stamp(text):
    """Decimal seconds as ns, without rounding."""
    whole, _, fraction = text.partition(".")
    if whole.isdigit() and (fraction.isdigit() or not fraction):
        return int(whole) * 10**9 + int((fraction + "0" * 9)[:9])
    return int(round(float(text) * 1e9))


def format_stamp(stamp):
    sign = "-" if stamp < 0 else ""
    return f"{sign}{abs(int(stamp)) // 10**9}.{abs(int(stamp)) % 10**9:09d}"


def yaw_of(x, y, z, w):
    return np.arctan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def read_tum(path):
    """Reads `t x y z qx qy qz qw` lines; empty lines and those that start with # are skipped."""
    stamps, rows = [], []
    try:
        with open(path, encoding="utf-8") as file:
            for number, line in enumerate(file, 1):
                words = line.split()
                if not words or words[0].startswith("#"):
                    continue
                try:
                    stamp = parse_stamp(words[0])
                    x, y, _, qx, qy, qz, qw = map(float, words[1:8])
                except ValueError:
                    raise EvaluationError(f"{path}, line {number}: '{line.strip()[:80]}' is not a pose; "
                                          "expected 't x y z qx qy qz qw'") from None
                stamps.append(stamp)
                rows.append((x, y, yaw_of(qx, qy, qz, qw)))
    except (OSError, UnicodeDecodeError) as error:
        raise EvaluationError(f"{path}: the trajectory cannot be read: {error}") from error
    if not rows:
        raise EvaluationError(f"{path}: no poses; expected lines of 't x y z qx qy qz qw'")
    if not np.isfinite(rows).all():
        raise EvaluationError(f"{path}: a pose is not finite")
    return in_order(stamps, rows)


def write_tum(trajectory, path):
    with open(path, "w", encoding="utf-8") as file:
        for stamp, (x, y, yaw) in zip(trajectory.stamps, trajectory.poses):
            file.write(f"{format_stamp(stamp)} {x:.9f} {y:.9f} 0 0 0 {np.sin(yaw / 2):.12f} "
                       f"{np.cos(yaw / 2):.12f}\n")


def poses_at(trajectory, stamps, max_gap):
    """Interpolated poses at `stamps`, and a mask of the valid ones: those within the trajectory and not in a
    gap longer than `max_gap` seconds."""
    stamps = np.asarray(stamps, dtype=np.int64)
    known = trajectory.stamps
    after = np.clip(np.searchsorted(known, stamps), 0, len(known) - 1)
    exact = known[after] == stamps
    before = np.maximum(after - 1, 0)
    gap = (known[after] - known[before]) * 1e-9
    inside = (stamps >= known[0]) & (stamps <= known[-1])
    valid = inside & (exact | (gap <= max_gap))
    weight = np.where(exact, 1.0, (stamps - known[before]) * 1e-9 / np.where(gap > 0.0, gap, 1.0))
    start, step = trajectory.poses[before], trajectory.poses[after] - trajectory.poses[before]
    step[:, 2] = wrap(step[:, 2])
    poses = start + weight[:, None] * step
    poses[:, 2] = wrap(poses[:, 2])
    poses[exact] = trajectory.poses[after[exact]]
    return poses, valid


@dataclass
class Errors:
    """One row per truth stamp used."""
    stamps: np.ndarray    # ns
    estimate: np.ndarray  # x, y, yaw
    truth: np.ndarray     # x, y, yaw
    skipped: int          # truth stamps within the run but in a gap of the estimate

    @property
    def difference(self):
        return self.estimate[:, :2] - self.truth[:, :2]

    @property
    def position(self):
        """m"""
        return np.hypot(*self.difference.T)

    @property
    def heading(self):
        """rad, positive: estimate rotated to the left."""
        return wrap(self.estimate[:, 2] - self.truth[:, 2])

    @property
    def along_track(self):
        """m, positive: estimate ahead of the car."""
        yaw = self.truth[:, 2]
        return self.difference[:, 0] * np.cos(yaw) + self.difference[:, 1] * np.sin(yaw)

    @property
    def cross_track(self):
        """m, positive: estimate left of the car."""
        yaw = self.truth[:, 2]
        return self.difference[:, 1] * np.cos(yaw) - self.difference[:, 0] * np.sin(yaw)

    def seconds(self, start):
        return (self.stamps - start) * 1e-9

    def summary(self):
        """With the keys of replay's summary.json."""
        position, heading = self.position, np.degrees(np.abs(self.heading))
        return {
            "position_error_m": {
                "mean": position.mean(), "median": np.median(position),
                "p95": np.percentile(position, 95), "max": position.max(),
                "rmse": np.sqrt((position**2).mean()), "final": position[-1]},
            "heading_error_deg": {
                "mean": heading.mean(), "p95": np.percentile(heading, 95), "max": heading.max()},
            "truth_stamps_used": len(position), "truth_stamps_skipped": self.skipped}


def compare(estimate, truth, max_gap=0.5):
    """The Errors of an estimate; None if no truth stamp lies within it."""
    inside = (truth.stamps >= estimate.stamps[0]) & (truth.stamps <= estimate.stamps[-1])
    poses, valid = poses_at(estimate, truth.stamps[inside], max_gap)
    if not valid.any():
        return None
    return Errors(truth.stamps[inside][valid], poses[valid], truth.poses[inside][valid],
                  int((~valid).sum()))


def spans(stamps, flags):
    """Intervals (first, last stamp) of consecutive true `flags`."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], np.asarray(flags, dtype=int), [0]))))
    return [(stamps[first], stamps[end - 1]) for first, end in zip(edges[::2], edges[1::2])]


def fraction_of_time(stamps, flags):
    """Fraction of the time with true `flags`; each holds until the next stamp."""
    if len(stamps) < 2:
        return float(np.mean(flags))
    durations = np.diff(stamps)
    return float(durations[np.asarray(flags)[:-1]].sum() / durations.sum())
