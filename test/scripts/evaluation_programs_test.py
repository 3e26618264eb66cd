#!/usr/bin/python3
"""scripts/evaluate and scripts/experiments over a simulated drive: agreement with replay, and their reports."""
import csv
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import rosunit

from racecar_mcl_eval import (EvaluationError, assessment, evaluate, grid_map, programs, scan_match,
                              trajectory)
from racecar_mcl_eval.columns import BEAM_ORDER, REVERSED
from racecar_mcl_eval.experiments import fault_injection
from racecar_mcl_eval.run import load_folder


class OnADrive(unittest.TestCase):
    """The programs over a short drive."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        cls.map = programs.ROOT / "maps/corridor.yaml"
        cls.wrong_map = programs.ROOT / "maps/track.yaml"
        cls.bag, cls.tum = cls.folder / "drive.bag", cls.folder / "truth.tum"
        programs.run("simulate_bag", ["--map", cls.map, "--out", cls.bag, "--truth", cls.tum,
                                      "--duration", 5, "--seed", 3])
        cls.replay("good", "--initial-pose-from-truth")
        # In another corridor, with the opposite heading.
        cls.replay("bad", "--initial-pose", "5 11.5 0")
        cls.replay("elsewhere", "--initial-pose-from-truth", map_yaml=cls.wrong_map)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def replay(cls, name, *start, map_yaml=None):
        # Without recovery a lost car stays lost.
        programs.run("replay", ["--bag", cls.bag, "--map", map_yaml or cls.map, "--truth", cls.tum, *start,
                                "--set", "relocalization:=start", "--out", cls.folder / name])

    def evaluate(self, *arguments):
        """The text of the report."""
        page = self.folder / "page"
        self.assertEqual(evaluate.main([*map(str, arguments), "--out", str(page)]), 0)
        return (page / "index.html").read_text(encoding="utf-8")

    def testErrorsEqualThoseOfReplay(self):
        for name in ("good", "bad"):
            run = load_folder(self.folder / name)
            run.set_truth(trajectory.read_tum(self.tum), 0.5)
            ours = run.errors.summary()
            self.assertGreater(ours["truth_stamps_used"], 100)
            for key, value in ours.items():
                if isinstance(value, dict):
                    for part, number in value.items():
                        self.assertAlmostEqual(number, run.summary[key][part], delta=1e-7)
                else:
                    self.assertEqual(value, run.summary[key])

    def testBannersShowWhichRunsAreLost(self):
        text = self.evaluate(*(self.folder / name for name in ("good", "bad", "elsewhere")),
                             "--map", self.map, "--bag", self.bag)
        banners = text.split('class="banner ')[1:]
        self.assertEqual([banner.split('"')[0] for banner in banners], ["good", "bad", "bad"])
        for banner in banners[1:]:
            self.assertIn("NOT LOCALIZED", banner)
        self.assertEqual(text.count("data:image/png;base64,"), len(list((self.folder / "page").glob("*.png"))))
        self.assertNotIn("src=\"http", text)

    def testAssessesByTheScanMatchWithoutATruth(self):
        walls = grid_map.load_map(self.map)
        near = {}
        for name in ("good", "bad"):
            run = load_folder(self.folder / name)
            match = scan_match.measure(run, walls, [self.bag], "/scan", "base_link", None, 0.5)
            near[name] = match.inlier_ratio
            self.assertEqual(assessment.assess(run, None, match, 0.5).level, name)
        self.assertGreater(near["good"], 0.95)
        self.assertLess(near["bad"], 0.75)

    def testPlacesBeamsInTheEstimatedOrder(self):
        run = load_folder(self.folder / "good")
        self.assertEqual(run.summary[BEAM_ORDER], "listed")

        def mean_distance():
            return scan_match.measure(run, grid_map.load_map(self.map), [self.bag], "/scan", "base_link",
                                      None, 0.5).mean_distance
        listed = mean_distance()
        run.summary[BEAM_ORDER] = REVERSED
        self.assertGreater(mean_distance(), 1.5 * listed)

    def testScanMatchDetectsTheWrongMap(self):
        run = load_folder(self.folder / "elsewhere")
        match = scan_match.measure(run, grid_map.load_map(self.wrong_map), [self.bag], "/scan", "base_link",
                                   None, 0.5)
        self.assertEqual(assessment.assess(run, None, match, 0.5).level, "bad")

    def testReadsARecordedEstimateFromABag(self):
        text = self.evaluate(self.bag, "--estimate-topic", "ground_truth/odom", "--map", self.map)
        self.assertIn('banner good', text)

    def testMissingInputIsReported(self):
        for arguments, words in (
                ([self.folder], "trajectory.tum"),
                ([self.bag], "/pf/pose/odom"),
                ([self.folder / "good", "--bag", self.folder / "none.bag"], "none.bag"),
                ([self.folder / "good", "--map", self.tum], "map"),
                ([self.folder / "good", "--truth", self.tum, "--truth", self.tum], "--truth")):
            page = self.folder / "none"
            result = subprocess.run([str(programs.ROOT / "scripts/evaluate"), *map(str, arguments), "--out", str(page)],
                                    stderr=subprocess.PIPE, check=False)
            self.assertEqual(result.returncode, 1)
            self.assertRegex(result.stderr.decode(), f"^evaluate: error: .*{words}")
            self.assertFalse(page.exists())


class Experiments(unittest.TestCase):
    def testSelectedExperimentsAreInTheReport(self):
        with tempfile.TemporaryDirectory() as folder:
            result = subprocess.run([str(programs.ROOT / "scripts/experiments"), "--quick", "--only", "noise", "table",
                                     "particles", "--out", folder], stdout=subprocess.PIPE, check=False)
            self.assertEqual(result.returncode, 0)
            names = {path.name for path in Path(folder).iterdir()}
            self.assertEqual(names, {
                "index.html", "fig-1-beam-table.png", "fig-2-3-particles.png", "fig-6-trajectory.png",
                "fig-7-no-noise.png", "fig-8-noise.png", "cross-track.png"})
            text = (Path(folder) / "index.html").read_text(encoding="utf-8")
        self.assertEqual(text.count("data:image/png;base64,"), len(names) - 1)
        self.assertEqual(text.count('class="banner '), 2)
        for words in ("simulate_bag --map maps/corridor.yaml", "--seed 1", "26.2, 27.0, 26.6 cm", "±5°"):
            self.assertIn(words, text)

    def testTableHasARowPerFailureScenario(self):
        with tempfile.TemporaryDirectory() as folder:
            table = Path(folder) / "drives.csv"
            arguments = ["--map", programs.ROOT / "maps/corridor.yaml", "--fault", "kidnap", "--drives", 2,
                         "--before", 1, "--after", 2]
            programs.run("evaluate_scenarios", [*arguments, "--out", table])
            with open(table, newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual([(row["fault"], row["seed"]) for row in rows],
                             [("kidnap", "1"), ("kidnap", "2")])
            # Every kidnapped car is localized again after some time.
            self.assertTrue(all(0.0 < seconds < 2.0 for seconds in fault_injection.seconds_until_localized(table)))
            with self.assertRaisesRegex(EvaluationError, "none/drives.csv: cannot be written"):
                programs.run("evaluate_scenarios", [*arguments, "--out", Path(folder) / "none/drives.csv"])

    def testTableOfMapFaultsHasTheErrorsAndMapsAreKept(self):
        with tempfile.TemporaryDirectory() as folder:
            table, maps = Path(folder) / "drives.csv", Path(folder) / "maps"
            programs.run("evaluate_scenarios",
                         ["--map", programs.ROOT / "maps/track.yaml", "--fault", "none", "opponent", "--map-fault",
                          "none", "distorted", "--drives", 1, "--before", 0.5, "--after", 1, "--out", table,
                          "--write-map", maps])
            with open(table, newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual([(row["map_fault"], row["fault"]) for row in rows],
                             [(map_fault, fault) for map_fault in ("none", "distorted")
                              for fault in ("none", "opponent")])
            for row in rows:
                self.assertLessEqual(float(row["mean_error"]), float(row["p99_error"]))
                self.assertLessEqual(float(row["p99_error"]), float(row["max_error"]))
                self.assertEqual(row["mean_error"], row["mean_error_where_mapped"])
                self.assertEqual((row["wrong_share"], row["ever_far_off"]), ("0.000", "0"))
            self.assertEqual(sorted(path.name for path in maps.iterdir()),
                             [f"track_{fault}_1.{kind}" for fault in ("distorted", "none") for kind in ("pgm", "yaml")])


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "evaluation_programs_test", "__main__", sysargs=sys.argv)
