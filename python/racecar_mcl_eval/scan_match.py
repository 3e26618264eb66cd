"""Match between recorded scans and the map at the estimated poses; needs no ground truth."""
from dataclasses import dataclass

import numpy as np

from . import bag
from .trajectory import poses_at

INLIER_DISTANCE = 0.2  # m, from an inlier's end point to the nearest wall


@dataclass
class ScanMatch:
    """One row per scan, and the end points of all scans."""
    stamps: np.ndarray          # ns
    mean_distances: np.ndarray  # m, from a scan's end points to the nearest walls
    inlier_ratios: np.ndarray   # fraction of a scan's end points within INLIER_DISTANCE of a wall
    points: np.ndarray          # (N, 2), end points in the map frame
    distances: np.ndarray       # (N,), m, from them to the nearest walls

    @property
    def mean_distance(self):
        return float(self.distances.mean())

    @property
    def inlier_ratio(self):
        return float((self.distances <= INLIER_DISTANCE).mean())


@dataclass
class PlacedScan:
    stamp: int           # ns
    origins: np.ndarray  # (N, 2), position of the lidar at each beam's time, map frame
    points: np.ndarray   # (N, 2), end points of the beams, map frame


def place(scans, mount, trajectory, beam_order, max_gap):
    """Yields PlacedScans: each beam is transformed with the pose at its own time (deskewed). Scans outside the
    trajectory, or in a gap longer than `max_gap` seconds, are skipped."""
    first, last = trajectory.stamps[[0, -1]]
    for scan in scans:
        if len(scan.points) == 0 or not first <= scan.stamp <= last:
            continue
        times = np.clip(scan.stamp + beam_order * scan.times, first, last)
        poses, valid = poses_at(trajectory, times, max_gap)
        if not valid.all():
            continue
        cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])

        def in_map(in_base):
            return poses[:, :2] + np.column_stack((in_base[:, 0] * cos - in_base[:, 1] * sin,
                                                   in_base[:, 0] * sin + in_base[:, 1] * cos))
        yield PlacedScan(scan.stamp, in_map(mount[None, :2, 3]),
                         in_map(scan.points @ mount[:2, :2].T + mount[:2, 3]))


def measure(run, grid_map, bags, scan_topic, base_frame, laser_pose, max_gap):
    """The ScanMatch of the bags' scans at the run's poses; None if no scan lies within the run."""
    placed = []
    for path in bags:
        scans, frame = bag.read_scans(path, scan_topic)
        mount = (bag.laser_mount(path, frame, base_frame) if laser_pose is None
                 else bag.matrix_of_pose(*laser_pose))
        placed += place(scans, mount, run.trajectory, run.beam_order, max_gap)
    return match(sorted(placed, key=lambda scan: scan.stamp), grid_map)


def match(placed, grid_map):
    """The ScanMatch of PlacedScans; None if there are none."""
    if not placed:
        return None
    distances = [grid_map.wall_distances(scan.points) for scan in placed]
    return ScanMatch(np.array([scan.stamp for scan in placed]),
                     np.array([of_scan.mean() for of_scan in distances]),
                     np.array([(of_scan <= INLIER_DISTANCE).mean() for of_scan in distances]),
                     np.concatenate([scan.points for scan in placed]), np.concatenate(distances))
