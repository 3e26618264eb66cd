"""One localized run: from a folder that replay wrote, or from a bag with a recorded estimate."""
import csv
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

import numpy as np

from . import EvaluationError, bag
from .trajectory import Trajectory, compare, parse_stamp, poses_at, read_tum, wrap

TRUTH_TOPIC = "/ground_truth/odom"
# Covariance columns of updates.csv, row by row.
_COVARIANCE = ("cov_xx", "cov_xy", "cov_xyaw", "cov_xy", "cov_yy", "cov_yyaw", "cov_xyaw", "cov_yyaw",
               "cov_yawyaw")
_WORDS = ("outcome", "verdict", "reason")


@dataclass
class TrueUpdates:
    """The updates at which there is a truth, each standing for the time since the one before."""
    stamps: np.ndarray     # ns
    errors: np.ndarray     # m, of the position
    durations: np.ndarray  # s
    driven: np.ndarray     # m, since the first
    verdict: np.ndarray


@dataclass
class Updates:
    """A row per scan that left an estimate. Columns that a source does not have are missing."""
    stamps: np.ndarray       # ns
    poses: np.ndarray        # x, y, yaw
    covariances: np.ndarray  # (N, 3, 3)
    columns: dict            # everything else by its name in updates.csv

    def __len__(self):
        return len(self.stamps)

    def column(self, name):
        """A column, or None where there is none."""
        return self.columns.get(name)

    def against(self, truth):
        """TrueUpdates, however far apart the truth's poses lie; None where there is no truth."""
        true, there = poses_at(truth, self.stamps, np.inf)
        if not there.any():
            return None
        true, stamps = true[there, :2], self.stamps[there]
        return TrueUpdates(
            stamps, np.hypot(*(self.poses[there, :2] - true).T),
            np.diff(stamps, prepend=stamps[0]) * 1e-9,
            np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(true, axis=0).T)))),
            self.column("verdict")[there])


@dataclass
class Run:
    name: str
    source: Path
    trajectory: Trajectory
    updates: Updates
    summary: Optional[dict] = None       # replay's; None of a recorded estimate
    truth: Optional[Trajectory] = None
    errors: Optional[object] = None      # Errors, where there is a truth

    @property
    def beam_order(self):
        """1 where beams were taken in the order in which scans list them, -1 where in reverse."""
        return -1 if self.summary and self.summary.get("sweep_order") == "reversed" else 1

    @property
    def start(self):
        """ns, what all times in figures count from."""
        return self.trajectory.stamps[0]

    def set_truth(self, truth, max_gap):
        self.truth = truth
        self.errors = compare(self.trajectory, truth, max_gap)
        if self.errors is None:
            raise EvaluationError(f"{self.source}: the truth and the estimate share no time: "
                                  f"{seconds_text(truth)} and {seconds_text(self.trajectory)}")

    def update_errors(self, max_gap):
        """(x, y, yaw) errors at the updates, with their covariances; and which updates these are:
        those used for an estimate at which there is a truth."""
        truth, there = poses_at(self.truth, self.updates.stamps, max_gap)
        outcome = self.updates.column("outcome")
        if outcome is not None:
            there = there & (outcome != "parked")
        difference = self.updates.poses - truth
        difference[:, 2] = wrap(difference[:, 2])
        return difference[there], self.updates.covariances[there], there


def seconds_text(trajectory):
    return f"[{trajectory.stamps[0] * 1e-9:.3f}, {trajectory.stamps[-1] * 1e-9:.3f}] s"


def read_updates(path):
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError) as error:
        raise EvaluationError(f"{path}: cannot be read: {error}") from error
    if not rows:
        return Updates(np.empty(0, np.int64), np.empty((0, 3)), np.empty((0, 3, 3)), {})
    try:
        stamps = np.array([parse_stamp(row["stamp"]) for row in rows], dtype=np.int64)
        columns = {name: np.array([row[name] if name in _WORDS else float(row[name]) for row in rows])
                   for name in rows[0] if name != "stamp"}
        poses = np.column_stack([columns.pop(name) for name in ("x", "y", "yaw")])
        covariances = np.column_stack([columns[name] for name in _COVARIANCE]).reshape(-1, 3, 3)
    except (KeyError, TypeError, ValueError) as error:
        raise EvaluationError(f"{path}: is no updates.csv of replay: {error!r}") from error
    return Updates(stamps, poses, covariances, columns)


def load_folder(folder, name=None):
    """What replay left in its --out."""
    folder = Path(folder)
    for file in ("trajectory.tum", "updates.csv", "summary.json"):
        if not (folder / file).is_file():
            raise EvaluationError(f"{folder}: holds no {file}; expected a folder that replay wrote, or "
                                  "a bag")
    try:
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise EvaluationError(f"{folder / 'summary.json'}: cannot be read: {error}") from error
    return Run(name or folder.resolve().name, folder, read_tum(folder / "trajectory.tum"),
               read_updates(folder / "updates.csv"), summary)


def load_recorded(path, topic, name=None):
    """An estimate that was recorded as nav_msgs/Odometry."""
    path = Path(path)
    recorded = bag.read_odometry(path, topic)
    updates = Updates(recorded.trajectory.stamps, recorded.trajectory.poses, recorded.covariances, {})
    return Run(name or path.stem, path, recorded.trajectory, updates)


def recorded_truth(path, topic=TRUTH_TOPIC):
    """The truth in a bag, or None."""
    if not bag.has_topic(path, topic, "nav_msgs/Odometry"):
        return None
    return bag.read_odometry(path, topic).trajectory
