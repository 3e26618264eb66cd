"""A localization run, loaded from an output folder of replay or from a bag with a recorded estimate."""
import csv
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

import numpy as np

from . import EvaluationError, bag
from .columns import BEAM_ORDER, OUTCOME, REVERSED, STATIONARY, STATUS
from .trajectory import Trajectory, compare, parse_stamp, poses_at, read_tum, wrap

TRUTH_TOPIC = "/ground_truth/odom"
# Covariance columns of updates.csv, row-major.
_COVARIANCE = ("cov_xx", "cov_xy", "cov_xyaw", "cov_xy", "cov_yy", "cov_yyaw", "cov_xyaw", "cov_yyaw",
               "cov_yawyaw")
_TEXT_COLUMNS = (OUTCOME, STATUS, "reason")


@dataclass
class ComparedUpdates:
    """The updates with a truth; each counts for the time since the previous one."""
    stamps: np.ndarray     # ns
    errors: np.ndarray     # m, position
    durations: np.ndarray  # s
    driven: np.ndarray     # m, true distance since the first
    status: np.ndarray


@dataclass
class Updates:
    """One row per scan with an estimate. The set of columns depends on the source."""
    stamps: np.ndarray       # ns
    poses: np.ndarray        # x, y, yaw
    covariances: np.ndarray  # (N, 3, 3)
    columns: dict            # the other columns, by their names in updates.csv

    def __len__(self):
        return len(self.stamps)

    def column(self, name):
        """The column, or None if it is missing."""
        return self.columns.get(name)

    def against(self, truth):
        """ComparedUpdates, interpolating the truth across any gap; None if no update has a truth."""
        true, valid = poses_at(truth, self.stamps, np.inf)
        if not valid.any():
            return None
        true, stamps = true[valid, :2], self.stamps[valid]
        return ComparedUpdates(
            stamps, np.hypot(*(self.poses[valid, :2] - true).T),
            np.diff(stamps, prepend=stamps[0]) * 1e-9,
            np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(true, axis=0).T)))),
            self.column(STATUS)[valid])


@dataclass
class Run:
    name: str
    source: Path
    trajectory: Trajectory
    updates: Updates
    summary: Optional[dict] = None       # replay's summary.json; None for a recorded estimate
    truth: Optional[Trajectory] = None
    errors: Optional[object] = None      # Errors, if there is a truth

    @property
    def beam_order(self):
        """1 if the scans list their beams in acquisition order, -1 if in reverse."""
        return -1 if self.summary and self.summary.get(BEAM_ORDER) == REVERSED else 1

    @property
    def start(self):
        """ns, time zero of the figures."""
        return self.trajectory.stamps[0]

    def set_truth(self, truth, max_gap):
        self.truth = truth
        self.errors = compare(self.trajectory, truth, max_gap)
        if self.errors is None:
            raise EvaluationError(f"{self.source}: the truth and the estimate have no time in common: "
                                  f"{seconds_text(truth)} and {seconds_text(self.trajectory)}")

    def update_errors(self, max_gap):
        """(x, y, yaw) errors and covariances of the updates with a truth, and the mask of these updates.
        Updates of a stationary car are left out."""
        truth, selected = poses_at(self.truth, self.updates.stamps, max_gap)
        outcome = self.updates.column(OUTCOME)
        if outcome is not None:
            selected = selected & (outcome != STATIONARY)
        difference = self.updates.poses - truth
        difference[:, 2] = wrap(difference[:, 2])
        return difference[selected], self.updates.covariances[selected], selected


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
        columns = {name: np.array([row[name] if name in _TEXT_COLUMNS else float(row[name]) for row in rows])
                   for name in rows[0] if name != "stamp"}
        poses = np.column_stack([columns.pop(name) for name in ("x", "y", "yaw")])
        covariances = np.column_stack([columns[name] for name in _COVARIANCE]).reshape(-1, 3, 3)
    except (KeyError, TypeError, ValueError) as error:
        raise EvaluationError(f"{path}: not an updates.csv of replay: {error!r}") from error
    return Updates(stamps, poses, covariances, columns)


def load_folder(folder, name=None):
    """A Run from the --out folder of replay."""
    folder = Path(folder)
    for file in ("trajectory.tum", "updates.csv", "summary.json"):
        if not (folder / file).is_file():
            raise EvaluationError(f"{folder}: has no {file}; expected an output folder of replay, "
                                  "or a bag")
    try:
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise EvaluationError(f"{folder / 'summary.json'}: cannot be read: {error}") from error
    return Run(name or folder.resolve().name, folder, read_tum(folder / "trajectory.tum"),
               read_updates(folder / "updates.csv"), summary)


def load_recorded(path, topic, name=None):
    """A Run from a bag with an estimate recorded as nav_msgs/Odometry."""
    path = Path(path)
    recorded = bag.read_odometry(path, topic)
    updates = Updates(recorded.trajectory.stamps, recorded.trajectory.poses, recorded.covariances, {})
    return Run(name or path.stem, path, recorded.trajectory, updates)


def recorded_truth(path, topic=TRUTH_TOPIC):
    """The ground truth in a bag, or None."""
    if not bag.has_topic(path, topic, "nav_msgs/Odometry"):
        return None
    return bag.read_odometry(path, topic).trajectory
