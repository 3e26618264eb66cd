"""How well recorded scans lie on the map from where the estimate says they were taken: the judgement
that needs no truth."""
from dataclasses import dataclass

import numpy as np

from . import bag
from .trajectory import poses_at

NEAR = 0.2  # m


@dataclass
class ScanFit:
    """Per scan, and all points for drawing."""
    stamps: np.ndarray       # ns
    mean_distance: np.ndarray  # m, from the scan's points to the nearest wall
    near_share: np.ndarray   # share of points within NEAR of a wall
    points: np.ndarray       # (N, 2), map frame
    distances: np.ndarray    # (N,), m

    @property
    def mean(self):
        return float(self.distances.mean())

    @property
    def near(self):
        return float((self.distances <= NEAR).mean())


@dataclass
class PlacedScan:
    stamp: int           # ns
    origins: np.ndarray  # (N, 2), where the lidar was when it took each beam, map frame
    points: np.ndarray   # (N, 2), where the beams ended, map frame


def place(scans, mount, trajectory, beam_order, max_gap):
    """The scans of which the trajectory tells the place. Every beam is placed at its own time."""
    first, last = trajectory.stamps[[0, -1]]
    for scan in scans:
        if len(scan.points) == 0 or not first <= scan.stamp <= last:
            continue
        times = np.clip(scan.stamp + beam_order * scan.times, first, last)
        poses, there = poses_at(trajectory, times, max_gap)
        if not there.all():
            continue
        cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])

        def in_map(in_base):
            return poses[:, :2] + np.column_stack((in_base[:, 0] * cos - in_base[:, 1] * sin,
                                                   in_base[:, 0] * sin + in_base[:, 1] * cos))
        yield PlacedScan(scan.stamp, in_map(mount[None, :2, 3]),
                         in_map(scan.points @ mount[:2, :2].T + mount[:2, 3]))


def measure(run, grid_map, bags, scan_topic, base_frame, laser_pose, max_gap):
    """None where no scan falls into the run."""
    placed = []
    for path in bags:
        scans, frame = bag.read_scans(path, scan_topic)
        mount = (bag.laser_mount(path, frame, base_frame) if laser_pose is None
                 else bag.matrix_of_pose(*laser_pose))
        placed += place(scans, mount, run.trajectory, run.beam_order, max_gap)
    return of_placed(sorted(placed, key=lambda scan: scan.stamp), grid_map)


def of_placed(placed, grid_map):
    """None of no scan."""
    if not placed:
        return None
    distances = [grid_map.wall_distances(scan.points) for scan in placed]
    return ScanFit(np.array([scan.stamp for scan in placed]),
                   np.array([of_one.mean() for of_one in distances]),
                   np.array([(of_one <= NEAR).mean() for of_one in distances]),
                   np.concatenate([scan.points for scan in placed]), np.concatenate(distances))
