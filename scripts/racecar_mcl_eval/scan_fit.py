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


def measure(run, grid_map, bags, scan_topic, base_frame, laser_pose, max_gap):
    """None where no scan falls into the run. Every beam is placed by the estimate at its own time."""
    stamps, all_points, all_distances = [], [], []
    for path in bags:
        scans, frame = bag.read_scans(path, scan_topic)
        mount = (bag.laser_mount(path, frame, base_frame) if laser_pose is None
                 else bag.matrix_of_pose(*laser_pose))
        for scan in scans:
            if len(scan.points) == 0:
                continue
            times = np.clip(scan.stamp + run.beam_order * scan.times, *run.trajectory.stamps[[0, -1]])
            poses, there = poses_at(run.trajectory, times, max_gap)
            inside = run.trajectory.stamps[0] <= scan.stamp <= run.trajectory.stamps[-1]
            if not (inside and there.all()):
                continue
            in_base = scan.points @ mount[:2, :2].T + mount[:2, 3]
            cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
            points = poses[:, :2] + np.column_stack((in_base[:, 0] * cos - in_base[:, 1] * sin,
                                                     in_base[:, 0] * sin + in_base[:, 1] * cos))
            stamps.append(scan.stamp)
            all_points.append(points)
            all_distances.append(grid_map.wall_distances(points))
    if not stamps:
        return None
    order = np.argsort(stamps)
    means = np.array([distances.mean() for distances in all_distances])
    shares = np.array([(distances <= NEAR).mean() for distances in all_distances])
    return ScanFit(np.array(stamps)[order], means[order], shares[order],
                   np.concatenate(all_points), np.concatenate(all_distances))
