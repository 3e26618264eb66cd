"""Draws maps from scans whose places are known: log odds of each cell, hits against passing beams."""
import numpy as np

from .grid_map import FREE, OCCUPIED, UNKNOWN, GridMap

HIT, PASSED, GREATEST = 0.85, -0.4, 4.0  # log odds: of one scan, and where they stop growing
SURE = 0.5  # log odds from which on a cell is occupied, below its negative free
FARTHEST = 25.0  # m; beams that end farther away are left out
STEP = 0.5  # cells between the points at which a beam is followed
SHORT_OF_WALL = 0.75  # cells before its end at which it stops to say that cells are free


class Drawing:
    """What each scan says of the cells of a map like `like` is worked out once, for any number of
    maps drawn from some of the scans."""

    def __init__(self, scans, like):
        self._like = like
        self._touched = np.zeros(like.cells.size, dtype=bool)
        self._stamps = np.array([scan.stamp for scan in scans])
        self._cells = [self._cells_of(scan) for scan in scans]

    def _inside(self, grid):
        """Indices of the cells at continuous grid coordinates, those off the map left out."""
        height, width = self._like.cells.shape
        column, row = np.floor(grid).astype(np.int64).T
        on_map = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        return row[on_map] * width + column[on_map]

    def _cells_of(self, scan):
        """The cells that the scan's beams passed, and those where they ended; each once."""
        ends, starts = self._like.to_grid(scan.points), self._like.to_grid(scan.origins)
        lengths = np.hypot(*(ends - starts).T)
        near = (lengths > 0.0) & (lengths < FARTHEST / self._like.resolution)
        ends, starts, lengths = ends[near], starts[near], lengths[near]
        counts = np.maximum(0, np.ceil((lengths - SHORT_OF_WALL) / STEP)).astype(int)
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
        """The map that lacks what only the scans in these windows saw: (begin, end) as shares of the
        time from the first scan to the last."""
        seen = self._stamps - self._stamps[0]
        share = seen / max(1, seen[-1])
        left_out = np.any([(share >= begin) & (share < end) for begin, end in windows], axis=0)
        odds = np.zeros(self._like.cells.size, np.float32)
        for index in np.flatnonzero(~np.broadcast_to(left_out, share.shape)):
            passed, ended = self._cells[index]
            odds[passed] = np.maximum(odds[passed] + PASSED, -GREATEST)
            odds[ended] = np.minimum(odds[ended] + HIT, GREATEST)
        cells = np.full(odds.shape, UNKNOWN, np.uint8)
        cells[odds > SURE] = OCCUPIED
        cells[odds < -SURE] = FREE
        return GridMap(f"{self._like.name}, drawn in part", cells.reshape(self._like.cells.shape),
                       self._like.resolution, self._like.origin)
