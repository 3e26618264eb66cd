#!/usr/bin/python3
"""scripts/plot_learned: figures of what the learning programs wrote, and of what it cannot draw."""
import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path

import rosunit

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))
from racecar_mcl_eval import learned_figures, programs  # noqa: E402

PNG = b"\x89PNG"


class PlotLearned(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def plot(self, folder):
        """Exit code, and what was printed as errors."""
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
            code = learned_figures.main([str(folder)])
        return code, errors.getvalue()

    def testDrawsWhatBothProgramsWrite(self):
        bag, tum, out = (self.folder / name for name in ("drive.bag", "truth.tum", "learned"))
        corridor = programs.ROOT / "maps/corridor.yaml"
        programs.run("simulate_bag", ["--map", corridor, "--out", bag, "--truth", tum, "--duration", 25])
        programs.run("learn_sensor_model", ["--bag", bag, "--map", corridor, "--trajectory", tum, "--out", out])
        programs.run("learn_motion_noise", ["--bag", bag, "--trajectory", tum, "--out", out])
        self.assertEqual(self.plot(out), (0, ""))
        for name in ("sensor_fit.png", "motion_fit.png"):
            self.assertEqual((out / name).read_bytes()[:4], PNG, name)

    def testSaysWhatIsMissingOrBroken(self):
        code, errors = self.plot(self.folder)
        self.assertEqual(code, 1)
        self.assertIn("neither sensor_fit.csv nor motion_fit.csv", errors)
        for text in ("", "expected_from,expected_to\n", "no,table\n1\n2,3\n", "a,b\n1,2\n3,4\n"):
            (self.folder / "sensor_fit.csv").write_text(text, encoding="utf-8")
            code, errors = self.plot(self.folder)
            self.assertEqual(code, 1, text)
            self.assertIn("sensor_fit.csv", errors)
        self.assertFalse((self.folder / "sensor_fit.png").exists())


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "learned_figures_test", PlotLearned, sysargs=sys.argv)
