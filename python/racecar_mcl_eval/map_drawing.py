"""Occupancy grid mapping with known poses: log odds of each cell from hits and passing beams. Maps that lack
walls."""
from dataclasses import replace

import cv2
import numpy as np

from .grid_map import FREE, OCCUPIED, UNKNOWN, GridMap

HIT, PASSED, MAX_LOG_ODDS = 0.85, -0.4, 4.0  # log odds: increments of one scan, and their limit
KNOWN = 0.5  # log odds above which a cell is occupied; below its negative: free
MAX_RANGE = 25.0  # m; longer beams are left out
STEP = 0.5  # cells between the samples along a beam
END_MARGIN = 0.75  # cells before its end from which on a beam marks nothing free


class Drawing:
    """Ray-traces scans into a grid with the geometry of `like` once, to draw any number of maps from subsets
    of the scans."""

    def __init__(self, scans, like):
        self._like = like
        self._touched = np.zeros(like.cells.size, dtype=bool)
        self._stamps = np.array([scan.stamp for scan in scans])
        self._cells = [self._cells_of(scan) for scan in scans]

    def _inside(self, grid):
        """Indices of the cells at continuous grid coordinates, without those outside the map."""
        height, width = self._like.cells.shape
        column, row = np.floor(grid).astype(np.int64).T
        on_map = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        return row[on_map] * width + column[on_map]

    def _cells_of(self, scan):
        """Unique indices of the cells that the beams of a scan passed, and of those in which they ended."""
        ends, starts = self._like.to_grid(scan.points), self._like.to_grid(scan.origins)
        lengths = np.hypot(*(ends - starts).T)
        near = (lengths > 0.0) & (lengths < MAX_RANGE / self._like.resolution)
        ends, starts, lengths = ends[near], starts[near], lengths[near]
        counts = np.maximum(0, np.ceil((lengths - END_MARGIN) / STEP)).astype(int)
        beam = np.repeat(np.arange(len(lengths)), counts)
        along = STEP * (np.arange(len(beam)) - np.repeat(np.cumsum(counts) - counts, counts))
        passed = starts[beam] + (along / lengths[beam])[:, None] * (ends - starts)[beam]
        ended = np.unique(self._inside(ends))
        cells = self._inside(passed)
        self._touched[cells] = True
        self._touched[ended] = False
        passed = np.flatnonzero(self._touched)
        self._touched[cells] = False
        return passed.astype(np.int32), ended.astype(np.int32)

    def without(self, windows):
        """The map drawn without the scans in these windows: (begin, end) as fractions of the time from the
        first scan to the last."""
        elapsed = self._stamps - self._stamps[0]
        fraction = elapsed / max(1, elapsed[-1])
        left_out = np.any([(fraction >= begin) & (fraction < end) for begin, end in windows], axis=0)
        odds = np.zeros(self._like.cells.size, np.float32)
        for index in np.flatnonzero(~np.broadcast_to(left_out, fraction.shape)):
            passed, ended = self._cells[index]
            odds[passed] = np.maximum(odds[passed] + PASSED, -MAX_LOG_ODDS)
            odds[ended] = np.minimum(odds[ended] + HIT, MAX_LOG_ODDS)
        cells = np.full(odds.shape, UNKNOWN, np.uint8)
        cells[odds > KNOWN] = OCCUPIED
        cells[odds < -KNOWN] = FREE
        return GridMap(f"{self._like.name}, incomplete", cells.reshape(self._like.cells.shape),
                       self._like.resolution, self._like.origin)


def erase_walls(grid_map, fraction, random):
    """The map with the walls in random discs of 0.4 to 1.2 m radius set to unknown, until this fraction of the
    walls' surface is erased."""
    cells = grid_map.cells.copy()
    near_free = cv2.dilate((cells == FREE).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    rows, columns = np.nonzero((cells == OCCUPIED) & near_free)
    y, x = np.ogrid[:cells.shape[0], :cells.shape[1]]
    while np.count_nonzero(cells[rows, columns] == OCCUPIED) > (1.0 - fraction) * len(rows):
        centre = random.integers(len(rows))
        radius = random.uniform(0.4, 1.2) / grid_map.resolution  # cells
        disc = (y - rows[centre])**2 + (x - columns[centre])**2 < radius**2
        cells[disc & (cells == OCCUPIED)] = UNKNOWN
    return replace(grid_map, cells=cells, _distances=None)
