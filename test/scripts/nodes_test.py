#!/usr/bin/python3
"""nodes/teleop and nodes/error_monitor."""
import math
import os
import pty
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

import rosunit
from program_module import load_program

TELEOP = str(Path(__file__).resolve().parents[2] / "nodes/teleop")

teleop = load_program("nodes/teleop")
error_monitor = load_program("nodes/error_monitor")


class Teleop(unittest.TestCase):
    def testKeepsTheSpeedAndStraightensTheWheels(self):
        drive = teleop.Drive(top_speed=4.0, top_curvature=1.0)
        drive.press("up")
        drive.press("up")
        drive.press("left")
        self.assertAlmostEqual(drive.speed, 0.5)
        self.assertGreater(drive.turn_rate, 0.0)
        for _ in range(100):
            drive.wait(0.05)
        self.assertAlmostEqual(drive.speed, 0.5)
        self.assertEqual(drive.turn_rate, 0.0)
        drive.press("stop")
        self.assertEqual(drive.speed, 0.0)

    def testStaysWithinItsLimits(self):
        drive = teleop.Drive(top_speed=1.0, top_curvature=0.5)
        for _ in range(50):
            drive.press("down")
            drive.press("right")
        self.assertEqual((drive.speed, drive.curvature), (-1.0, -0.5))
        drive.wait(1000.0)
        self.assertEqual(drive.curvature, 0.0)

    def testParsesSequencesOfKeys(self):
        self.assertEqual(teleop.actions_of("w\x1b[A\x1b[D q"), ["up", "up", "left", "stop", "end"])
        self.assertEqual(teleop.actions_of("\x1b[ZxW"), [])

    def testRequiresATerminal(self):
        result = subprocess.run([TELEOP], stdin=subprocess.DEVNULL, check=False,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual(result.returncode, 1)
        self.assertIn(b"not a terminal", result.stderr)

    def testRestoresTheTerminal(self):
        # Immediately, and with the threads of the node running.
        for delay in (0.0, 1.0):
            for number in (signal.SIGINT, signal.SIGTERM):
                with self.subTest(delay=delay, signal=number):
                    self.end(number, delay)

    def end(self, number, delay):
        master, slave = pty.openpty()
        before = teleop.termios.tcgetattr(slave)
        # Without a master it waits for one, already in raw mode; a signal ends it.
        environment = dict(os.environ, ROS_MASTER_URI="http://127.0.0.1:1")
        with subprocess.Popen([TELEOP], stdin=slave, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, env=environment) as process:
            end = time.monotonic() + 20.0
            while teleop.termios.tcgetattr(slave) == before and time.monotonic() < end:
                time.sleep(0.05)
            raw = teleop.termios.tcgetattr(slave)
            time.sleep(delay)
            process.send_signal(number)
            try:
                process.wait(20.0)
            finally:
                process.kill()
        self.assertNotEqual(raw, before)
        self.assertEqual(teleop.termios.tcgetattr(slave), before)
        os.close(master)
        os.close(slave)


class ErrorMonitor(unittest.TestCase):
    def testInterpolatesYawAlongTheShorterArc(self):
        truth = error_monitor.Truth()
        truth.add(1.0, 0.0, 0.0, math.pi - 0.1)
        truth.add(2.0, 1.0, 2.0, -math.pi + 0.1)
        x, y, yaw = truth.at(1.5)
        self.assertAlmostEqual(x, 0.5)
        self.assertAlmostEqual(y, 1.0)
        self.assertAlmostEqual(abs(yaw), math.pi)
        self.assertEqual(truth.at(2.0)[:2], (1.0, 2.0))
        self.assertIsNone(truth.at(0.9))
        self.assertIsNone(truth.at(2.1))

    def testDropsOldPosesAndRestartsIfTimeJumpsBack(self):
        truth = error_monitor.Truth()
        for k in range(1000):
            truth.add(0.01 * k, 0.0, 0.0, 0.0)
        self.assertLess(len(truth.stamps), 250)
        truth.add(1.0, 5.0, 0.0, 0.0)
        self.assertEqual(truth.at(1.0), (5.0, 0.0, 0.0))
        self.assertIsNone(truth.at(9.0))

    def testSummarizesErrors(self):
        text = error_monitor.summary([(0.01, 0.0), (0.03, math.radians(-2.0))])
        self.assertIn("mean 2.0 cm", text)
        self.assertIn("max 3.0 cm", text)
        self.assertIn("heading: mean 1.00 deg", text)


class Nodes(unittest.TestSuite):
    def __init__(self):
        loader = unittest.defaultTestLoader
        super().__init__([loader.loadTestsFromTestCase(Teleop),
                          loader.loadTestsFromTestCase(ErrorMonitor)])


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "nodes_test", "__main__.Nodes",
                    sysargs=sys.argv)
