"""Trajectories, and how far one lies from another: the definitions `replay` uses.

A trajectory is stamp (s), x (m), y (m), yaw (rad), one row per stamp in rising order.
"""
from dataclasses import dataclass

import numpy
import rosbag


@dataclass
class Trajectory:
    stamp: numpy.ndarray
    x: numpy.ndarray
    y: numpy.ndarray
    yaw: numpy.ndarray

    def __len__(self):
        return len(self.stamp)

    @property
    def length(self):
        """Distance driven, m."""
        return float(numpy.hypot(numpy.diff(self.x), numpy.diff(self.y)).sum())

    @property
    def rate(self):
        """Rows per second."""
        return (len(self) - 1) / float(self.stamp[-1] - self.stamp[0]) if len(self) > 1 else 0.0


def from_rows(rows):
    """From (stamp, x, y, qz, qw) rows in any order; of equal stamps the last row stays."""
    table = {row[0]: row for row in rows}
    ordered = numpy.array([table[stamp] for stamp in sorted(table)], dtype=float).reshape(-1, 5)
    stamp, x, y, qz, qw = ordered.T
    return Trajectory(stamp, x, y, 2.0 * numpy.arctan2(qz, qw))


def read_tum(path):
    rows = numpy.loadtxt(path, ndmin=2)
    return from_rows(rows[:, [0, 1, 2, 6, 7]])


def read_odometry(bag_path, topic):
    """The poses of a nav_msgs/Odometry topic by their header stamps."""
    rows = []
    with rosbag.Bag(str(bag_path)) as bag:
        for _, message, _ in bag.read_messages(topics=[topic]):
            pose = message.pose.pose
            rows.append((message.header.stamp.to_sec(), pose.position.x, pose.position.y,
                         pose.orientation.z, pose.orientation.w))
    return from_rows(rows)


def wrapped(angle):
    return (angle + numpy.pi) % (2.0 * numpy.pi) - numpy.pi


def errors(estimate, truth, max_gap=0.5):
    """Stamps, position errors (m) and absolute heading errors (rad) at the truth's stamps.

    The estimate is interpolated between its two neighbours, never across more than `max_gap` s and
    never beyond its ends; no alignment.
    """
    if len(estimate) < 2:
        return numpy.zeros(0), numpy.zeros(0), numpy.zeros(0)
    inside = (truth.stamp >= estimate.stamp[0]) & (truth.stamp <= estimate.stamp[-1])
    after = numpy.clip(numpy.searchsorted(estimate.stamp, truth.stamp), 1, len(estimate) - 1)
    before = after - 1
    gap = estimate.stamp[after] - estimate.stamp[before]
    kept = inside & (gap <= max_gap)
    after, before, gap = after[kept], before[kept], gap[kept]
    share = (truth.stamp[kept] - estimate.stamp[before]) / gap
    x = estimate.x[before] + share * (estimate.x[after] - estimate.x[before])
    y = estimate.y[before] + share * (estimate.y[after] - estimate.y[before])
    turn = wrapped(estimate.yaw[after] - estimate.yaw[before])
    yaw = estimate.yaw[before] + share * turn
    position = numpy.hypot(x - truth.x[kept], y - truth.y[kept])
    return truth.stamp[kept], position, numpy.abs(wrapped(yaw - truth.yaw[kept]))
