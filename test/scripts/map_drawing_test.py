#!/usr/bin/python3
"""Occupancy grid mapping on small grids."""
import sys
import tempfile
import unittest
from pathlib import Path

import numpy
import rosunit

from racecar_mcl_eval import grid_map, map_drawing, scan_match, trajectory
from racecar_mcl_eval.bag import RecordedScan, matrix_of_pose
from racecar_mcl_eval.grid_map import FREE, OCCUPIED, UNKNOWN

SECOND = 10**9  # ns


def map_like(rows, columns, origin=(0.0, 0.0, 0.0)):
    return grid_map.GridMap("like", numpy.full((rows, columns), UNKNOWN, numpy.uint8), 0.1, origin)


def scan(second, origin, *ends):
    return scan_match.PlacedScan(second * SECOND, numpy.array([origin] * len(ends), dtype=float),
                                 numpy.array(ends, dtype=float))


class Drawing(unittest.TestCase):
    def testBeamsFreePassedCellsAndOccupyTheirLast(self):
        seen = [scan(second, (0.05, 0.05), (0.55, 0.05)) for second in range(3)]
        drawn = map_drawing.Drawing(seen, map_like(2, 8)).without([])
        self.assertEqual(drawn.cells[0].tolist(), [FREE] * 5 + [OCCUPIED] + [UNKNOWN] * 2)
        self.assertEqual(drawn.cells[1].tolist(), [UNKNOWN] * 8)

    def testUsesTheGeometryOfTheGivenMap(self):
        # Its columns run along the map frame's y, its rows along -x.
        like = map_like(2, 8, (1.0, 2.0, numpy.pi / 2))
        drawn = map_drawing.Drawing([scan(second, (0.95, 2.05), (0.95, 2.55)) for second in range(3)],
                                    like).without([])
        self.assertEqual(drawn.cells[0].tolist(), [FREE] * 5 + [OCCUPIED] + [UNKNOWN] * 2)
        self.assertEqual((drawn.origin, drawn.resolution), (like.origin, like.resolution))

    def testCellsObservedOnlyInTheWindowsStayUnknown(self):
        right = [scan(second, (0.45, 0.05), (0.75, 0.05)) for second in (0, 1, 2)]
        left = [scan(second, (0.45, 0.05), (0.05, 0.05)) for second in (3, 4, 5)]
        both = [scan(second, (0.45, 0.15), (0.75, 0.15)) for second in (6, 7, 8, 9, 10)]
        drawing = map_drawing.Drawing(right + left + both, map_like(2, 8))
        cells = drawing.without([(0.3, 0.6), (0.8, 0.9)]).cells
        self.assertEqual(cells[0].tolist(), [UNKNOWN] * 4 + [FREE] * 3 + [OCCUPIED])
        self.assertEqual(cells[1].tolist(), [UNKNOWN] * 4 + [FREE] * 3 + [OCCUPIED])
        self.assertTrue((drawing.without([(0.0, 1.1)]).cells == UNKNOWN).all())

    def testASingleHitAmongManyPassingBeamsIsFree(self):
        seen = [scan(second, (0.05, 0.05), (0.75, 0.05)) for second in range(9)]
        seen.insert(4, scan(5, (0.05, 0.05), (0.35, 0.05)))
        cells = map_drawing.Drawing(seen, map_like(1, 8)).without([]).cells
        self.assertEqual(cells[0].tolist(), [FREE] * 7 + [OCCUPIED])

    def testIgnoresLongBeamsAndCellsOutsideTheMap(self):
        seen = [scan(second, (0.05, 0.05), (0.05, 30.0), (-0.35, 0.05)) for second in range(3)]
        cells = map_drawing.Drawing(seen, map_like(2, 3)).without([]).cells
        self.assertEqual(cells.tolist(), [[FREE, UNKNOWN, UNKNOWN], [UNKNOWN] * 3])

    def testWrittenMapsAreReadBack(self):
        cells = numpy.array([[FREE, OCCUPIED, UNKNOWN], [UNKNOWN, FREE, FREE]], numpy.uint8)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.yaml"
            grid_map.write_map(grid_map.GridMap("a", cells, 0.05, (1.5, -2.25, 3.14)), path)
            read = grid_map.load_map(path)
        numpy.testing.assert_array_equal(read.cells, cells)
        self.assertEqual((read.resolution, read.origin), (0.05, (1.5, -2.25, 3.14)))


class Placing(unittest.TestCase):
    def testPlacesEachBeamAtItsTime(self):
        driven = trajectory.Trajectory(numpy.array([0, 2 * SECOND]),
                                       numpy.array([(0.0, 0.0, numpy.pi / 2), (0.0, 2.0, numpy.pi / 2)]))
        beams = RecordedScan(0, numpy.array([0, SECOND]), numpy.array([(1.0, 0.0), (1.0, 0.0)]))
        placed = list(scan_match.place([beams], matrix_of_pose(0.25, 0.0, 0.0), driven, 1, numpy.inf))
        self.assertEqual(len(placed), 1)
        numpy.testing.assert_allclose(placed[0].origins, [(0.0, 0.25), (0.0, 1.25)], atol=1e-12)
        numpy.testing.assert_allclose(placed[0].points, [(0.0, 1.25), (0.0, 2.25)], atol=1e-12)

    def testSkipsScansOutsideTheTrajectory(self):
        driven = trajectory.Trajectory(numpy.array([0, SECOND]), numpy.zeros((2, 3)))
        late = RecordedScan(2 * SECOND, numpy.array([0]), numpy.array([(1.0, 0.0)]))
        empty = RecordedScan(0, numpy.empty(0, int), numpy.empty((0, 2)))
        self.assertEqual(list(scan_match.place([late, empty], numpy.eye(4), driven, 1, 9.0)), [])


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "map_drawing_test", "__main__", sysargs=sys.argv)
