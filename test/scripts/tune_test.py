#!/usr/bin/python3
"""scripts/tune: search space, objective, held-apart bags and continuation with a replay whose optimum is known."""
import contextlib
import io
import math
import sys
import unittest
from unittest import mock

import rosunit
import yaml
from sweep_fixture import JobsFolder, contents_of, has_module, summary

from racecar_mcl_eval import EvaluationError, programs, tune
from racecar_mcl_eval.sweep import parameters, search_space

WITH_OPTUNA = unittest.skipUnless(has_module("optuna", "python3-optuna"), "python3-optuna is missing")
SPACE = {"field_scale": {"low": 0.01, "high": 1.0, "log": True}}


class SearchSpace(unittest.TestCase):
    def testEachPublicParameterIsTunedOrHasAReason(self):
        public = {name for name in parameters.defaults() if "/" not in name}
        beam = {**parameters.defaults(), "sensor_model": "beam"}
        tuned = set(search_space.default_space(parameters.defaults())) | set(search_space.default_space(beam))
        self.assertEqual(tuned | set(search_space.NOT_TUNED), public)
        self.assertFalse(tuned & set(search_space.NOT_TUNED))

    def testParametersOfOtherModelsAreNotTuned(self):
        self.assertNotIn("sigma_hit", search_space.default_space(parameters.defaults()))
        constant = {**parameters.defaults(), "motion_model": "constant", "sensor_model": "beam"}
        self.assertEqual(set(search_space.default_space(constant)), {"effective_beams", "sigma_hit", "distance_filter"})

    def testWrongRangesAreRefused(self):
        for values, words in (({}, "mapping of parameters"), ({"field_scal": [1, 2]}, "'field_scale'"),
                              ({"field_scale": 3}, "low: NUMBER"), ({"field_scale": [3]}, "at least two"),
                              ({"field_scale": {"low": 2, "high": 1}}, "low below high"),
                              ({"field_scale": {"low": 0, "high": 1, "log": True}}, "above 0"),
                              ({"field_scale": {"low": "a", "high": 1}}, "a number"),
                              ({"deskew": {"low": False, "high": True}}, "low: NUMBER")):
            with self.assertRaisesRegex(EvaluationError, f"^F: tune.*{words}"):
                search_space.read_space(values, "F: tune")


class Tune(JobsFolder):
    def setUp(self):
        super().setUp()
        self.failing = lambda values: False

    def summary_of(self, bag, seed, parameters):
        """The error is least at a field_scale of 0.2. Far from there a run is lost or fails, but with a small error."""
        off = abs(math.log(parameters["field_scale"] / 0.2))
        if self.failing(parameters):
            raise programs.ProgramError("replay: error: no scan was used", 1)
        result = summary(0.01 + 0.05 * off + 0.001 * seed)
        if off > 2.0:
            result["position_error_m"].update(mean=1e-6, final=5.0)
        return result

    def write_jobs(self, **values):
        super().write_jobs(**{"held_apart": ["b3.bag", "b4.bag"],
                              "tune": {"parameters": SPACE, "trials": 25, "seed": 3}, **values})

    def tune(self, *options, out=None):
        """The exit status and what is printed."""
        with contextlib.redirect_stdout(io.StringIO()) as text, contextlib.redirect_stderr(text):
            status = tune.main([str(self.jobs_file), "--out", str(out or self.out), "--jobs", "1", *options])
        return status, text.getvalue()

    def assertSucceeds(self, *options, out=None):
        status, text = self.tune(*options, out=out)
        self.assertEqual(status, 0, text)
        return text

    def best(self):
        return yaml.safe_load((self.out / "best.yaml").read_text(encoding="utf-8"))

    @WITH_OPTUNA
    def testFindsTheOptimumAndWritesItAsConfig(self):
        self.write_jobs()
        text = self.assertSucceeds()
        self.assertIn("seed 3", text)
        self.assertAlmostEqual(self.best()["field_scale"], 0.2, delta=0.05)
        self.assertEqual(parameters.read_file(self.out / "best.yaml"), self.best())
        self.assertRegex(text, "held-apart bags: .*: better")

    @WITH_OPTUNA
    def testHeldApartBagsAreReplayedForDefaultsAndWinnerOnly(self):
        self.write_jobs()
        self.assertSucceeds()
        held_apart = [words for words in self.replays if str(self.folder / "b3.bag") in words]
        self.assertEqual(len(held_apart), 2)
        training = [words for words in self.replays if str(self.folder / "b1.bag") in words]
        self.assertEqual(len(training), 26)
        self.assertGreater(self.replays.index(held_apart[0]), self.replays.index(training[-1]))
        page = (self.out / "index.html").read_text(encoding="utf-8")
        self.assertLess(page.index("<h2>Held-apart bags"), page.index("<h2>Training bags"))

    @WITH_OPTUNA
    def testWarnsIfNoBagIsHeldApart(self):
        self.write_jobs(held_apart=[])
        self.assertIn("warning: no bag is held apart", self.assertSucceeds("--trials", "2"))
        self.assertIn("No bag is held apart", (self.out / "index.html").read_text(encoding="utf-8"))

    @WITH_OPTUNA
    def testALostOrFailedRunIsNoSuccess(self):
        self.failing = lambda values: values["field_scale"] < 0.04
        self.write_jobs(lost_cost=0.7)
        self.assertSucceeds()
        rows = [line.split(",") for line in (self.out / "trials.csv").read_text(encoding="utf-8").splitlines()[1:]]
        bad = [float(error) for _, error, value in rows if abs(math.log(float(value) / 0.2)) > 2.0]
        failed = [float(error) for _, error, value in rows if float(value) < 0.04]
        self.assertTrue(bad and failed)
        self.assertEqual(set(bad + failed), {0.7})

    @WITH_OPTUNA
    def testKeepsTheDefaultsIfNoTrialIsBetter(self):
        self.write("car.yaml", "field_scale: 0.2\n")
        self.write_jobs(config="car.yaml", tune={"parameters": {"field_scale": {"low": 0.7, "high": 0.9}}, "trials": 2})
        self.assertIn("no trial was better than the defaults", self.assertSucceeds())
        self.assertEqual(self.best(), {"field_scale": 0.2})

    @WITH_OPTUNA
    def testAnEndedSearchContinuesToTheSameResult(self):
        self.write_jobs()
        self.assertSucceeds()
        ended, runs = self.folder / "ended", len(self.replays)

        def end_later(values):
            if len(self.replays) == runs + 30:
                raise programs.ProgramError("replay: ended", -15)
            return False
        self.failing = end_later
        status, text = self.tune(out=ended)
        self.assertEqual(status, 1)
        self.assertIn("Start the program again to continue", text)
        self.assertSucceeds(out=ended)
        same, whole = contents_of(ended), contents_of(self.out)
        del same["study.db"], whole["study.db"]
        self.assertEqual(same, whole)

    @WITH_OPTUNA
    def testAStudyOfOtherJobsIsRefused(self):
        self.write_jobs()
        study = ("--study", str(self.folder / "study.db"))
        self.assertSucceeds("--trials", "1", *study)
        self.assertSucceeds("--trials", "2", *study)
        self.write_jobs(seeds=[9])
        status, text = self.tune("--trials", "2", *study)
        self.assertEqual(status, 1)
        self.assertIn("its trials are of other bags", text)
        self.write("study.db", "no database")
        self.assertIn("cannot be read as a study", self.tune("--trials", "2", *study)[1])

    @WITH_OPTUNA
    def testWrongKeysAreRefused(self):
        for values, words in (({"trial": 3}, "no key 'trial'"), ({"trials": 0}, "trials is 0; expected a whole number"),
                              ({"seed": "a"}, "seed is 'a'"), ([], "tune is []")):
            self.write_jobs(tune=values)
            status, text = self.tune()
            self.assertEqual(status, 1)
            self.assertIn(f"tune: error: {self.jobs_file}: ", text)
            self.assertIn(words, text)

    def testMissingOptunaIsReported(self):
        self.write_jobs()
        with mock.patch.dict(sys.modules, {"optuna": None}):
            status, text = self.tune()
        self.assertEqual(status, 1)
        self.assertIn("apt install python3-optuna", text)


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "tune_test", "__main__", sysargs=sys.argv)
