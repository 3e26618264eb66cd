#!/usr/bin/python3
"""scripts/sweep: jobs, hashes and the store against hand-made cases, and the program over simulated drives."""
import contextlib
import io
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

import rosunit
from sweep_fixture import JobsFolder, contents_of, has_module, summary

from racecar_mcl_eval import EvaluationError, programs, sweep
from racecar_mcl_eval.sweep import identity, jobs, parameters, run
from racecar_mcl_eval.sweep.store import Store

WITH_DASK = unittest.skipUnless(has_module("distributed", "python3-distributed"), "python3-distributed is missing")


class Jobs(JobsFolder):
    def assertRefused(self, *words, **values):
        """The error names the file and has these words."""
        self.write_jobs(**values)
        with self.assertRaises(EvaluationError) as caught:
            jobs.read(self.jobs_file)
        for word in (str(self.jobs_file), *words):
            self.assertIn(word, str(caught.exception))

    def testAreBagsByMapsBySettingsBySeeds(self):
        self.write_jobs(maps=["m1.yaml", "m2.yaml"], seeds=[4, 7], settings={"few": {"num_particles": 50}})
        found = [(job.setting, job.drive.name, job.drive.map_name, job.seed)
                 for job in jobs.read(self.jobs_file).jobs()]
        self.assertEqual(found, [(setting, bag, plan, seed) for setting in ("defaults", "few")
                                 for bag in ("b1.bag", "b2.bag") for plan in ("m1.yaml", "m2.yaml") for seed in (4, 7)])

    def testABagMayHaveItsOwnMapTruthAndTopics(self):
        self.write_jobs(bags=["b[12].bag", {"bag": "b3.bag", "map": "m2.yaml", "truth": "b1_gt.tum", "duration": 5,
                                            "initial_pose": "1 2 0"}], odom_topic="/odom", initial_pose="global")
        first, second, own = jobs.read(self.jobs_file).drives
        self.assertEqual((first.name, second.name), ("b1.bag", "b2.bag"))
        self.assertEqual(first.truth, self.folder / "b1_gt.tum")
        self.assertEqual(first.options, ("--odom-topic", "/odom", "--global"))
        self.assertEqual((own.map_name, own.truth), ("m2.yaml", self.folder / "b1_gt.tum"))
        self.assertEqual(own.options, ("--odom-topic", "/odom", "--duration", "5", "--initial-pose", "1 2 0"))

    def testParametersAreDefaultsThenConfigThenSetting(self):
        self.write("car.yaml", "num_particles: 300\nexpert: {range_bias: 0.02}\n")
        self.write_jobs(config="car.yaml", settings={"few": {"num_particles": 50, "field_scale": "2e-2"}})
        few = jobs.read(self.jobs_file).settings["few"]
        self.assertEqual((few["num_particles"], few["expert/range_bias"], few["field_scale"]), (50, 0.02, 0.02))
        self.assertEqual(few["num_beams_per_particle"], 240)
        self.assertEqual(set(few), set(parameters.defaults()))

    def testErrorsNameFileKeyAndWhatIsExpected(self):
        self.assertRefused("no key 'bag_files'", "bags, held_apart", bag_files=[])
        self.assertRefused("bags is []", "a list of bags", bags=[])
        self.assertRefused("bags, entry 1: bag is 'none.bag'", "existing file", bags=["none.bag"])
        self.assertRefused("bags, entry 1: bag is 'n*.bag'", "pattern of existing files", bags=["n*.bag"])
        self.assertRefused("bags, entry 1: there is no key 'file'", "truth", bags=[{"file": "b1.bag"}])
        self.assertRefused("bags is 'b1.bag'", "once", bags=["b1.bag", "b*.bag"])
        self.assertRefused("bags, entry 1: no map for b1.bag", "maps", maps=[])
        self.assertRefused("initial_pose is 'start'", "truth, global", initial_pose="start")
        self.assertRefused("seeds is [1, 1]", "different numbers", seeds=[1, 1])
        self.assertRefused("lost_cost is -1", "above 0", lost_cost=-1)
        self.assertRefused("settings: few: there is no parameter 'num_particle'", "'num_particles'",
                           settings={"few": {"num_particle": 50}})
        self.assertRefused("settings: few: num_particles is 'many'", "a number",
                           settings={"few": {"num_particles": "many"}})
        self.assertRefused("settings: none: relocalization is False", "in quotes",
                           settings={"none": {"relocalization": False}})
        self.assertRefused("settings is 'defaults'", "another name", settings={"defaults": {}})
        self.assertRefused("held_apart has b2.bag", "b2.bag in bags", held_apart=["b2.bag"])

    def testAFileThatIsNoMappingIsRefused(self):
        for text in ("- b1.bag\n", "bags: [\n", ""):
            self.write("jobs.yaml", text)
            with self.assertRaisesRegex(EvaluationError, f"^{self.jobs_file}: "):
                jobs.read(self.jobs_file)

    def testShardsArePartsOfAllJobs(self):
        keys = [f"{index:02d}" for index in range(11)]
        for count in (1, 2, 3, 11, 20):
            parts = [jobs.shard(keys, part, count) for part in range(1, count + 1)]
            self.assertEqual(sorted(sum(parts, [])), keys)
            sizes = [len(part) for part in parts]
            self.assertLessEqual(max(sizes) - min(sizes), 1)


class Keys(JobsFolder):
    def key(self, **values):
        self.write_jobs(**{"bags": ["b1.bag"], **values})
        return identity.key_of(jobs.read(self.jobs_file).jobs()[-1])

    def testChangeWithAllThatMakesAResult(self):
        original = self.key()
        changed = [self.key(seeds=[2]), self.key(initial_pose="global"), self.key(maps=["m2.yaml"]),
                   self.key(bags=["b2.bag"]), self.key(settings={"few": {"num_particles": 50}})]
        for name in ("b1.bag", "b1_gt.tum", "m1.yaml", "m1.pgm", "replay"):
            path = self.folder / name
            text = path.read_text(encoding="utf-8")
            self.write(name, text + "\n")
            changed.append(self.key())
            self.write(name, text)
        self.assertEqual(len({original, *changed}), 1 + len(changed))
        self.assertEqual(self.key(), original)

    def testDoNotChangeWithNamesNorWithSpelling(self):
        original = self.key()
        self.assertEqual(self.key(settings={"same": {"num_particles": 200.0}}), original)
        for old, new in (("b1.bag", "c.bag"), ("b1_gt.tum", "c_gt.tum"), ("m1.yaml", "plan.yaml")):
            os.replace(str(self.folder / old), str(self.folder / new))
        self.assertEqual(self.key(bags=["c.bag"], maps=["plan.yaml"]), original)


class Results(JobsFolder):
    """The program with a replaced replay."""

    def sweep(self, *options, out=None):
        """The exit status and what is printed."""
        with contextlib.redirect_stdout(io.StringIO()) as text, contextlib.redirect_stderr(text):
            status = sweep.main([str(self.jobs_file), "--out", str(out or self.out), "--jobs", "2", *options])
        return status, text.getvalue()

    def assertSucceeds(self, *options, out=None):
        status, text = self.sweep(*options, out=out)
        self.assertEqual(status, 0, text)
        return text

    def testFinishedJobsAreNotRunAgain(self):
        self.write_jobs(settings={"few": {"num_particles": 50}, "same": {}})
        self.assertIn("few: better", self.assertSucceeds())
        self.assertEqual(len(self.replays), 4)
        before = contents_of(self.out)
        self.assertIn("4 of them with a result, 0 to run", self.assertSucceeds())
        self.assertEqual(len(self.replays), 4)
        self.write_jobs(settings={"few": {"num_particles": 50}, "same": {}}, seeds=2)
        self.assertSucceeds()
        self.assertEqual(len(self.replays), 8)
        self.assertLess({name for name in before if name.startswith("results")}, set(contents_of(self.out)))

    def testDamagedResultsAreRunAgain(self):
        self.write_jobs(seeds=3)
        self.assertSucceeds()
        before = contents_of(self.out)
        for damage in (lambda text: "", lambda text: text[:-20], lambda text: text.replace("0.011", "0.001"),
                       lambda text: text.replace('"seed": 1', '"seed": 9'), lambda text: "[]"):
            file = next(path for path in sorted((self.out / "results").rglob("result.json"))
                        if "0.011" in path.read_text(encoding="utf-8"))
            file.write_text(damage(file.read_text(encoding="utf-8")), encoding="utf-8")
            self.assertIn("5 of them with a result, 1 to run", self.assertSucceeds())
            self.assertEqual(contents_of(self.out), before)

    def testShardsGiveTheSameBytesInOneFolderAndMerged(self):
        self.write_jobs(seeds=3, settings={"few": {"num_particles": 50}})
        self.assertSucceeds()
        parts = self.folder / "parts"
        self.assertIn("other parts have no result yet", self.assertSucceeds("--shard", "1/2", out=parts))
        self.assertFalse((parts / "index.html").exists())
        self.assertSucceeds("--shard", "2/2", out=parts)
        self.assertEqual(contents_of(parts), contents_of(self.out))
        self.assertEqual(len(self.replays), 24)

    def testLeftOverFilesOfAKilledProcessAreRemoved(self):
        self.write_jobs()
        self.assertSucceeds()
        file = next((self.out / "results").rglob("result.json"))
        before = contents_of(self.out)
        file.unlink()
        (file.parent / "abc.tmp").write_text("{", encoding="utf-8")
        self.assertSucceeds()
        self.assertEqual(contents_of(self.out), before)

    def testAFailureIsAResultAndMayBeRetried(self):
        self.write_jobs()
        error = programs.ProgramError(f"replay: error: {self.folder}/b1.bag has no scans", 1)
        with mock.patch.object(self, "summary_of", side_effect=error):
            self.assertSucceeds()
        text = (self.out / "runs.csv").read_text(encoding="utf-8")
        self.assertEqual(text.count("failed"), 2)
        self.assertIn(",replay: error: b1.bag has no scans\n", text)
        self.assertIn("0 to run", self.assertSucceeds())
        self.assertIn("2 to run", self.assertSucceeds("--retry-failed"))
        self.assertNotIn("failed", (self.out / "runs.csv").read_text(encoding="utf-8"))

    def testAReplayThatWasEndedHasNoResult(self):
        self.write_jobs()
        with mock.patch.object(self, "summary_of", side_effect=programs.ProgramError("replay: ended", -9)):
            status, text = self.sweep()
        self.assertEqual(status, 1)
        self.assertIn("2 of 2 runs were not finished", text)
        self.assertEqual(contents_of(self.out), {})
        self.assertIn("2 to run", self.assertSucceeds())

    def testASettingOutOfRangeStopsBeforeTheRuns(self):
        self.write_jobs(settings={"none": {"num_particles": 0}})

        def refuse(name, arguments):
            raise programs.ProgramError("replay: error: num_particles is 0; it must be between 1 and 10000000", 1)
        with mock.patch.object(programs, "run", refuse):
            status, text = self.sweep()
        self.assertEqual(status, 1)
        self.assertRegex(text, r"jobs.yaml: settings: \w+: replay: error: num_particles is 0")
        self.assertFalse(self.out.exists())

    def testAJobIsNotRunWithOtherFilesThanItWasMadeFor(self):
        self.write_jobs()
        job = jobs.read(self.jobs_file).jobs()[0]
        key = identity.key_of(job)
        self.write("b1.bag", "another bag")
        with self.assertRaisesRegex(EvaluationError, "b1.bag: .* not the same here"):
            run.run_job(job, key)

    def testAWrongShardIsRefused(self):
        for text in ("0/2", "3/2", "1", "a/b"):
            with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()) as error:
                sweep.parse([str(self.jobs_file), "--out", "out", "--shard", text])
            self.assertIn("expected i/n", error.getvalue())

    def testMissingDaskIsReported(self):
        self.write_jobs()
        with mock.patch.dict(sys.modules, {"distributed": None}):
            status, text = self.sweep("--dask", "tcp://127.0.0.1:1")
        self.assertEqual(status, 1)
        self.assertIn("apt install python3-distributed", text)

    def testAPageSaysWhichSettingIsBetter(self):
        self.write_jobs(seeds=2, settings={"few": {"num_particles": 50}, "many": {"num_particles": 400},
                                           "even": {"expert/beam_layout": "even"}})
        self.assertSucceeds()
        page = (self.out / "index.html").read_text(encoding="utf-8")
        for words in ('<td class="good">better</td>', '<td class="bad">clearly worse</td>',
                      "<td>no difference shown</td>", "<td>num_particles: 400</td>", "use at least 6", "Confirm a result on other bags"):
            self.assertIn(words, page)
        rows = (self.out / "settings.csv").read_text(encoding="utf-8").splitlines()
        self.assertEqual(rows[2], "few,num_particles: 50,4,0,0,0.004,0.004,0.0045,1,100,-0.0075,-0.0075,-0.0075,better")


class OnADrive(unittest.TestCase):
    """The program over a simulated drive, with two jobs."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        plan = programs.ROOT / "maps/corridor.yaml"
        programs.run("simulate_bag", ["--map", plan, "--duration", 3, "--out", cls.folder / "drive.bag"])
        # So many particles that a run takes a second.
        (cls.folder / "car.yaml").write_text("num_particles: 3000\n", encoding="utf-8")
        (cls.folder / "jobs.yaml").write_text(
            f"bags: drive.bag\nmaps: {plan}\nseeds: 2\nconfig: car.yaml\n", encoding="utf-8")
        result = cls.start("whole").communicate()
        cls.whole = contents_of(cls.folder / "whole")
        assert "index.html" in cls.whole, result

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def start(cls, out, *options):
        return subprocess.Popen([str(programs.ROOT / "scripts/sweep"), str(cls.folder / "jobs.yaml"), "--out",
                                 str(cls.folder / out), "--jobs", "1", *options], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE)

    def waitForAResult(self, out):
        deadline = time.monotonic() + 60.0
        while not list((self.folder / out).rglob("result.json")) and time.monotonic() < deadline:
            time.sleep(0.002)

    def assertSameAsTheWhole(self, out):
        self.assertEqual(contents_of(self.folder / out), self.whole)

    def testResultsHaveErrorsAndStatusAndNoTimes(self):
        for file in sorted((self.folder / "whole/results").rglob("result.json")):
            saved = json.loads(file.read_text(encoding="utf-8"))
            self.assertLess(saved["result"]["position_error_m"]["mean"], 0.1)
            self.assertAlmostEqual(saved["result"]["status_percent"]["localized"], 100.0)
            self.assertGreater(saved["result"]["coverage"], 0.95)
            self.assertNotIn("update_ms", saved["result"])
            self.assertEqual(Store(self.folder / "whole/results").read(file.parent.name), saved["result"])

    def testKeysIncludeTheLibrariesOfTheProgram(self):
        names = {path.name for path in identity._files_of(programs.file_of("replay"))}
        self.assertIn("replay", names)
        self.assertTrue(any(name.startswith("libracecar_mcl_core") for name in names), names)

    def testKilledAndResumedGivesTheSameBytes(self):
        for number, name in ((signal.SIGKILL, "killed"), (signal.SIGTERM, "terminated")):
            with self.subTest(signal=name):
                process = self.start(name)
                self.waitForAResult(name)
                process.send_signal(number)
                process.communicate()
                self.assertNotEqual(process.returncode, 0)
                self.assertFalse((self.folder / name / "index.html").exists())
                resumed = self.start(name).communicate()
                self.assertRegex(resumed[0].decode(), "[12] of them with a result")
                self.assertSameAsTheWhole(name)

    @WITH_DASK
    def testADaskClusterGivesTheSameBytesAlsoIfAWorkerIsKilled(self):
        from distributed import LocalCluster
        with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None,
                          host="127.0.0.1") as cluster:
            process = self.start("dask", "--dask", cluster.scheduler_address)
            deadline = time.monotonic() + 60.0
            while not self.busy(cluster) and time.monotonic() < deadline:
                time.sleep(0.01)
            killed = self.busy(cluster)
            os.kill(killed.pid, signal.SIGKILL)
            output = process.communicate()
            self.assertEqual(process.returncode, 0, output)
        self.assertSameAsTheWhole("dask")

    @staticmethod
    def busy(cluster):
        """A worker that runs a job, or None."""
        running = [address for address, state in cluster.scheduler.workers.items() if state.processing]
        return next((worker for worker in cluster.workers.values() if worker.worker_address in running), None)

    @WITH_DASK
    def testNoSchedulerIsReported(self):
        with mock.patch.object(run, "CONNECT_TIMEOUT", 0.2):
            with self.assertRaisesRegex(EvaluationError, "no scheduler answers"):
                next(run.run_on_cluster({}, "tcp://127.0.0.1:1"))

    def testMissingTruthIsReported(self):
        with mock.patch.object(run, "TRUTH_TOPIC", "/none"), \
                self.assertRaisesRegex(EvaluationError, "drive.bag has no ground truth; expected .*drive_gt.tum"):
            run.check(jobs.read(self.folder / "jobs.yaml").jobs(), "jobs.yaml")


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "sweep_test", "__main__", sysargs=sys.argv)
