"""A folder with jobs of small files in place of bags, and a replay in place of the program."""
import hashlib
import importlib.util
import json
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import yaml

from racecar_mcl_eval import programs


def summary(error, **changes):
    """A summary.json of replay with this position error (m) everywhere."""
    position = dict.fromkeys(("mean", "median", "p95", "max", "rmse", "final"), error)
    return {"position_error_m": position, "heading_error_deg": {"mean": 1.0, "p95": 1.0, "max": 1.0},
            "truth_stamps_used": 100, "truth_stamps_skipped": 0, "status_percent": {"localized": 100.0},
            "scans_seen": 40, "scans_used": 40, "duration_s": 1.0, "update_ms": {"mean": 0.5}, **changes}


class JobsFolder(unittest.TestCase):
    """`bags` b1.bag, b2.bag, ... with a truth beside each, the maps m1.yaml and m2.yaml, and jobs.yaml."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name).resolve()
        self.jobs_file, self.out = self.folder / "jobs.yaml", self.folder / "out"
        for index in range(1, 5):
            self.write(f"b{index}.bag", f"bag {index}")
            self.write(f"b{index}_gt.tum", f"{index} 0 0 0 0 0 0 1\n")
        for name in ("m1", "m2"):
            self.write(f"{name}.pgm", f"image of {name}")
            self.write(f"{name}.yaml", f"image: {name}.pgm\n")
        self.program = self.write("replay", "program 1")
        self.replays = []  # the arguments of each replay
        for patch in (mock.patch.object(programs, "file_of", lambda name: self.program),
                      mock.patch.object(programs, "run", self.replay)):
            patch.start()
            self.addCleanup(patch.stop)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def write_jobs(self, **values):
        """Writes jobs.yaml: two bags on one map with one seed, changed by `values`."""
        values = {"bags": ["b1.bag", "b2.bag"], "maps": ["m1.yaml"], "seeds": 1, **values}
        self.write("jobs.yaml", yaml.safe_dump(values, sort_keys=False))

    def summary_of(self, bag, seed, parameters):
        """The summary.json of a replay: an error of 0.01 m per 200 particles, and 0.001 m more for each seed."""
        return summary(0.01 * parameters["num_particles"] / 200 + 0.001 * seed)

    def replay(self, name, arguments):
        """Replaces programs.run: writes what summary_of says."""
        self.assertEqual(name, "replay")
        words = [str(word) for word in arguments]
        options = {word: words[index + 1] for index, word in enumerate(words[:-1]) if word.startswith("--")}
        if not Path(options["--bag"]).exists():
            raise programs.ProgramError(f"replay: error: bag '{options['--bag']}' cannot be opened", 1)
        self.replays.append(words)
        parameters = yaml.safe_load(Path(options["--config"]).read_text(encoding="utf-8"))
        result = self.summary_of(Path(options["--bag"]).stem, int(options["--seed"]), parameters)
        folder = Path(options["--out"])
        folder.mkdir()
        (folder / "summary.json").write_text(json.dumps(result), encoding="utf-8")
        (folder / "trajectory.tum").write_text("0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", encoding="utf-8")


def has_module(name, package):
    """Whether a Python module is installed; prints that its tests are skipped if not, as rosunit does not."""
    if importlib.util.find_spec(name):
        return True
    print(f"skipped: {package} is missing")
    return False


def contents_of(folder):
    """Hashes of all files below a folder, by their names."""
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(Path(folder).rglob("*")) if path.is_file()}
