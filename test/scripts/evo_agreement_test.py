#!/usr/bin/python3
"""Errors of scripts/evaluate against those of evo (https://github.com/MichaelGrupp/evo), an independent trajectory
evaluation. Skipped if evo is not installed."""
import json
import math
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

import numpy
import rosunit

from racecar_mcl_eval import programs, trajectory

NOT_INSTALLED = "evo is not installed: there is no evo_ape on the PATH"


class EvoAgreement(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        cls.truth, cls.estimate = cls.folder / "truth.tum", cls.folder / "run/trajectory.tum"
        walls, bag = programs.ROOT / "maps/corridor.yaml", cls.folder / "drive.bag"
        programs.run("simulate_bag", ["--map", walls, "--out", bag, "--truth", cls.truth, "--duration", 5,
                                      "--odom-noise", 0.1, "--seed", 3])
        programs.run("replay", ["--bag", bag, "--map", walls, "--initial-pose-from-truth", "--truth",
                                cls.truth, "--out", cls.folder / "run"])

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def evos(self, relation):
        """evo's statistics of the absolute pose error, without alignment, at common stamps."""
        results = self.folder / f"{relation}.zip"
        subprocess.run(["evo_ape", "tum", str(self.truth), str(self.estimate), "--pose_relation", relation,
                        "--t_max_diff", "1e-6", "--save_results", str(results), "--no_warnings"],
                       check=True, stdout=subprocess.DEVNULL, timeout=60)
        with zipfile.ZipFile(results) as archive:
            return json.loads(archive.read("stats.json"))

    def ours(self):
        estimate, truth = trajectory.read_tum(self.estimate), trajectory.read_tum(self.truth)
        shared = numpy.isin(truth.stamps, estimate.stamps)
        self.assertGreater(shared.sum(), 100)
        return trajectory.compare(estimate, trajectory.Trajectory(truth.stamps[shared],
                                                                  truth.poses[shared]))

    def testErrorsEqualThoseOfEvoAtCommonStamps(self):
        errors = self.ours()
        for relation, ours in (("trans_part", errors.position),
                               ("angle_deg", numpy.degrees(numpy.abs(errors.heading)))):
            evos = self.evos(relation)
            self.assertAlmostEqual(evos["rmse"], math.sqrt((ours**2).mean()), delta=1e-6)
            self.assertAlmostEqual(evos["mean"], ours.mean(), delta=1e-6)
            self.assertAlmostEqual(evos["max"], ours.max(), delta=1e-6)


def report_skipped(arguments):
    """rosunit would count a skipped test as passed."""
    print(f"skipped: {NOT_INSTALLED}")
    for argument in arguments:
        if argument.startswith("--gtest_output=xml:"):
            path = Path(argument.split(":", 1)[1])
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(
                '<testsuite name="evo_agreement_test" tests="1" errors="0" failures="0"><testcase '
                'classname="EvoAgreement" name="testErrorsEqualThoseOfEvoAtCommonStamps"><skipped message='
                f'"{NOT_INSTALLED}"/></testcase></testsuite>\n', encoding="utf-8")


if __name__ == "__main__":
    if shutil.which("evo_ape") is None:
        report_skipped(sys.argv)
    else:
        rosunit.unitrun("racecar_mcl", "evo_agreement_test", "__main__", sysargs=sys.argv)
