#!/usr/bin/python3
"""scripts/plot_calibration: figures of the calibration programs' output, and error messages."""
import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path

import rosunit

from racecar_mcl_eval import calibration_figures, programs

PNG = b"\x89PNG"


class PlotCalibration(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def plot(self, folder):
        """Exit status and stderr."""
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
            code = calibration_figures.main([str(folder)])
        return code, errors.getvalue()

    def testPlotsTheOutputOfBothPrograms(self):
        bag, tum, out = (self.folder / name for name in ("drive.bag", "truth.tum", "calibration"))
        corridor = programs.ROOT / "maps/corridor.yaml"
        programs.run("simulate_bag", ["--map", corridor, "--out", bag, "--truth", tum, "--duration", 25])
        programs.run("calibrate_beam_model", ["--bag", bag, "--map", corridor, "--trajectory", tum, "--out", out])
        programs.run("calibrate_motion_noise", ["--bag", bag, "--trajectory", tum, "--out", out])
        self.assertEqual(self.plot(out), (0, ""))
        for name in ("beam_model.png", "motion_noise.png"):
            self.assertEqual((out / name).read_bytes()[:4], PNG, name)

    def testReportsMissingAndInvalidTables(self):
        code, errors = self.plot(self.folder)
        self.assertEqual(code, 1)
        self.assertIn("neither beam_model.csv nor motion_noise.csv", errors)
        for text in ("", "expected_from,expected_to\n", "no,table\n1\n2,3\n", "a,b\n1,2\n3,4\n"):
            (self.folder / "beam_model.csv").write_text(text, encoding="utf-8")
            code, errors = self.plot(self.folder)
            self.assertEqual(code, 1, text)
            self.assertIn("beam_model.csv", errors)
        self.assertFalse((self.folder / "beam_model.png").exists())


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "calibration_figures_test", PlotCalibration, sysargs=sys.argv)
