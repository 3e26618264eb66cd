#!/usr/bin/python3
"""tools/benchmark_live: latencies of received messages, CPU time, choice of the best run."""
import math
import os
import struct
import sys
import time
import unittest

import rosunit
from program_module import load_program

from racecar_mcl_eval import live_benchmark

benchmark_live = load_program("tools/benchmark_live")
TOLERANCE = 30000  # us


def drive():
    """Odometry at 0.1, 0.2 and 0.3 s, scans at 0.105 and 0.205 s."""
    sent = live_benchmark.SentMessages()
    for stamp in (100000, 200000, 300000):
        sent.stamps[live_benchmark.ODOMETRY_TOPIC].append(stamp)
        sent.times[live_benchmark.ODOMETRY_TOPIC].append(1e-6 * stamp)
    for stamp in (105000, 205000):
        sent.stamps[live_benchmark.SCAN_TOPIC].append(stamp)
        sent.times[live_benchmark.SCAN_TOPIC].append(1e-6 * stamp)
    return sent


class Latencies(unittest.TestCase):
    def testDistinguishesTransformsOfScansAndOfOdometry(self):
        received = live_benchmark.ReceivedMessages()
        received.transforms = [(0.101, 100000 + TOLERANCE), (0.107, 100001 + TOLERANCE),
                               (0.201, 200000 + TOLERANCE), (0.209, 200001 + TOLERANCE),
                               (0.301, 300000 + TOLERANCE)]
        delays = received.answers_to_scans(drive(), TOLERANCE, 0.0, 1.0)
        self.assertEqual([round(delay, 6) for delay in delays], [0.002, 0.004])

    def testIgnoresMessagesOutsideThePeriod(self):
        received = live_benchmark.ReceivedMessages()
        received.transforms = [(0.107, 100001 + TOLERANCE), (0.209, 200001 + TOLERANCE)]
        self.assertEqual(len(received.answers_to_scans(drive(), TOLERANCE, 0.15, 0.25)), 1)
        self.assertEqual(drive().scans_between(0.15, 0.25), 1)
        self.assertEqual(drive().scans_between(0.0, 1.0), 2)

    def testMeasuresTransportTimes(self):
        received = live_benchmark.ReceivedMessages()
        received.odometry = [(0.1005, 100000), (0.2007, 200000), (0.9, 123)]
        delays = received.odometry_delays(drive(), 0.0, 1.0)
        self.assertEqual([round(delay, 6) for delay in delays], [0.0005, 0.0007])

    def testReadsStampsOfHeadersAndTransforms(self):
        header = struct.pack("<III", 7, 12, 345678000)
        self.assertEqual(live_benchmark.stamp_of(header, live_benchmark.STAMP_OFFSET), 12345678)
        self.assertEqual(live_benchmark.stamp_of(struct.pack("<I", 1) + header, live_benchmark.TF_STAMP_OFFSET),
                         12345678)

    def testQuantilesOfAnEmptyListAreNaN(self):
        self.assertTrue(all(math.isnan(value) for value in live_benchmark.quantiles([])))
        self.assertAlmostEqual(live_benchmark.quantiles([0.001, 0.002, 0.003])[0], 2.0)


class Measuring(unittest.TestCase):
    def testMeasuresTheCpuTimeOfAProcess(self):
        before = benchmark_live.cpu_seconds(os.getpid())
        spent = time.process_time()
        while time.process_time() - spent < 0.3:
            pass
        self.assertAlmostEqual(benchmark_live.cpu_seconds(os.getpid()) - before, 0.3, delta=0.1)

    def testBestRunHasTheLowestLatencyAndCpuTime(self):
        slow = {"cpu": 1.0, "node": (0.3, 1.0), "outside": (0.5, 9.0), "transport": (0.2, 0.4),
                "answered": 0.9}
        fast = {"cpu": 2.0, "node": (0.4, 2.0), "outside": (0.6, 3.0), "transport": (0.1, 0.5),
                "answered": 1.0}
        self.assertEqual(benchmark_live.best([slow, fast]), dict(fast, cpu=1.0))

    def testBestRunWithoutAnswersHasTheLowestTransportTime(self):
        nothing = {"node": (math.nan, math.nan), "outside": (math.nan, math.nan), "answered": 0.0}
        slow, fast = ({"cpu": 1.0, "transport": (0.2, p99), **nothing} for p99 in (0.9, 0.3))
        self.assertIs(benchmark_live.best([slow, fast])["transport"], fast["transport"])


class BenchmarkLive(unittest.TestSuite):
    def __init__(self):
        loader = unittest.defaultTestLoader
        super().__init__([loader.loadTestsFromTestCase(Latencies),
                          loader.loadTestsFromTestCase(Measuring)])


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "benchmark_live_test", "__main__.BenchmarkLive", sysargs=sys.argv)
