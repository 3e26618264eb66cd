"""The file jobs.yaml: bags, maps, settings and seeds, and the jobs that they make."""
import glob
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Optional

from .. import EvaluationError
from ..recordings import find_map, find_truth
from . import identity, parameters

DEFAULTS = "defaults"  # name of the setting that the others are compared with
# Keys of the file, or of one bag, that are options of replay.
REPLAY_OPTIONS = ("scan_topic", "odom_topic", "imu_topic", "base_frame", "odom_frame", "laser_pose", "start",
                  "duration", "max_gap")
_BAG_KEYS = ("bag", "map", "maps", "truth", "initial_pose", *REPLAY_OPTIONS)
_FILE_KEYS = ("bags", "held_apart", "maps", "settings", "seeds", "config", "lost_error", "lost_cost", "tune",
              "initial_pose", *REPLAY_OPTIONS)


@dataclass(frozen=True)
class Limits:
    """When a run is lost, and what it counts then."""
    error: float = 0.5  # m; the 95th percentile of the position error, or the error at the end, is above it
    cost: float = 1.0   # m; error of a lost or failed run, and the largest of any run


@dataclass(frozen=True)
class Drive:
    """A recording on one map."""
    name: str               # of the bag, from the folder of jobs.yaml
    map_name: str
    bag: Path
    map: Path
    truth: Optional[Path]   # None: the one in the bag
    options: tuple          # of replay, besides those of Job


@dataclass(frozen=True)
class Job:
    """One run of replay."""
    drive: Drive
    setting: str
    parameters: dict        # all of them
    seed: int

    def words(self, config, folder):
        """The arguments of replay, with a file of the parameters and the output folder."""
        drive = self.drive
        words = ["--bag", drive.bag, "--map", drive.map, *drive.options, "--seed", self.seed, "--config", config,
                 "--out", folder]
        return words + (["--truth", drive.truth] if drive.truth else [])


@dataclass
class JobsFile:
    path: Path
    drives: list             # Drives to compare settings and to tune on
    held_apart: list         # Drives for the evaluation of what was tuned
    settings: dict           # effective parameters by name; DEFAULTS is the first
    seeds: list
    limits: Limits
    tune: dict = field(default_factory=dict)

    @property
    def defaults(self):
        return self.settings[DEFAULTS]

    def jobs(self):
        """All jobs of a sweep: bags x maps x settings x seeds. Their order is that of the file."""
        return [job for name in self.settings for job in self.jobs_of(name, self.settings[name], self.drives)]

    def jobs_of(self, name, values, drives):
        """The jobs of one setting with all parameters `values`."""
        return [Job(drive, name, values, seed) for drive in drives for seed in self.seeds]


def shard(keys, part, count):
    """The keys of part `part` (1 to `count`); the parts are disjoint, together they are all keys."""
    return [key for index, key in enumerate(keys) if index % count == part - 1]


class _Reader:
    """Reads one jobs.yaml. Errors name the file, the key and what is expected."""

    def __init__(self, path):
        self.path = Path(path)
        self.values = parameters.read_yaml(self.path, "jobs")
        self.known(self.values, _FILE_KEYS, "")

    def fail(self, key, value, expected):
        raise EvaluationError(f"{self.path}: {key} is {value!r}; expected {expected}")

    def known(self, values, keys, where):
        for key in values:
            if key not in keys:
                raise EvaluationError(f"{self.path}: {where}there is no key '{key}'; expected one of "
                                      f"{', '.join(keys)}")

    def file(self, key, text):
        """The existing file `text`, from the folder of jobs.yaml."""
        if not isinstance(text, str) or not (self.path.parent / text).is_file():
            self.fail(key, text, "the name of an existing file, from the folder of this file")
        return (self.path.parent / text).resolve()

    def files(self, key, text):
        """The files that a name with or without wildcards stands for, sorted."""
        if isinstance(text, str) and glob.has_magic(text):
            found = sorted(glob.glob(str(self.path.parent / text), recursive=True))
            if not found:
                self.fail(key, text, "a pattern of existing files, from the folder of this file")
            return [Path(name).resolve() for name in found]
        return [self.file(key, text)]

    def name(self, file):
        return os.path.relpath(str(file), str(self.path.parent.resolve()))

    def list(self, values, key):
        """A list from a list or from one value; empty if the key is missing."""
        value = values.get(key, [])
        return value if isinstance(value, list) else [value]

    def number(self, key, default):
        value = self.values.get(key, default)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 < value < float("inf"):
            self.fail(key, value, "a number above 0 (m)")
        return float(value)

    def options(self, values, where):
        """Options of replay, from keys of the file and of a bag."""
        words = []
        for key in REPLAY_OPTIONS:
            if key in values:
                if isinstance(values[key], bool) or not isinstance(values[key], (str, int, float)):
                    self.fail(where + key, values[key], f"one value, as for --{key.replace('_', '-')} of replay")
                words += ["--" + key.replace("_", "-"), str(values[key])]
        return words + self.initial_pose(values.get("initial_pose", "truth"), where)

    def initial_pose(self, value, where):
        if value == "truth":
            return ["--initial-pose-from-truth"]
        if value == "global":
            return ["--global"]
        try:
            x, y, yaw = map(float, value.split())
        except (AttributeError, ValueError):
            self.fail(where + "initial_pose", value, 'truth, global or "x y yaw" (m, m, rad)')
        return ["--initial-pose", f"{x:g} {y:g} {yaw:g}"]

    def drives(self, key):
        """The Drives of a list of bags."""
        found = []
        for index, entry in enumerate(self.list(self.values, key), 1):
            where = f"{key}, entry {index}: "
            if not isinstance(entry, dict):
                entry = {"bag": entry}
            self.known(entry, _BAG_KEYS, where)
            inherited = {name: self.values[name] for name in ("maps", "initial_pose", *REPLAY_OPTIONS)
                         if name in self.values}
            found += self.drives_of({**inherited, **entry}, where)
        if len(set(found)) != len(found):
            repeated = next(drive for drive in found if found.count(drive) > 1)
            self.fail(key, repeated.name, "each bag once per map, start and duration")
        return found

    def drives_of(self, entry, where):
        options = tuple(self.options(entry, where))
        found = []
        for bag in self.files(where + "bag", entry.get("bag")):
            truth = self.file(where + "truth", entry["truth"]) if "truth" in entry else find_truth(bag)
            for plan in self.maps_of(bag, entry, where):
                found.append(Drive(self.name(bag), self.name(plan), bag, plan, truth, options))
        return found

    def maps_of(self, bag, entry, where):
        """The maps of one bag: its own, those of the file, or the one beside the bag."""
        maps = self.list(entry, "map") or self.list(entry, "maps")
        if maps:
            return [file for text in maps for file in self.files(where + "map", text)]
        beside = find_map(bag)
        if beside in (None, self.path.resolve()):
            raise EvaluationError(f"{self.path}: {where}no map for {self.name(bag)}; expected the key map or maps, or "
                                  f"{bag.stem}.yaml beside the bag")
        return [beside]

    def settings(self):
        """Effective parameters of each setting; the first is DEFAULTS."""
        base = parameters.read_file(self.file("config", self.values["config"])) if "config" in self.values else {}
        named = self.values.get("settings", {})
        if not isinstance(named, dict):
            self.fail("settings", named, "a mapping of names to parameters")
        result = {DEFAULTS: parameters.effective(base)}
        for name, values in named.items():
            if str(name) == DEFAULTS:
                self.fail("settings", str(name), "another name: this is the one of the parameters in config")
            own = parameters.checked(values, f"{self.path}: settings: {name}")
            result[str(name)] = parameters.effective(base, own)
        return result

    def seeds(self):
        seeds = self.values.get("seeds", 3)
        is_count = isinstance(seeds, int) and not isinstance(seeds, bool)
        listed = list(range(1, seeds + 1)) if is_count else seeds
        valid = isinstance(listed, list) and listed and len(set(map(str, listed))) == len(listed) and all(
            isinstance(seed, int) and not isinstance(seed, bool) and seed >= 0 for seed in listed)
        if not valid:
            self.fail("seeds", seeds, "the number of seeds, or a list of different numbers of 0 or more")
        return listed


def _require_apart(path, drives, held_apart):
    """Raises EvaluationError if a recording is in both."""
    training = {identity.contents(drive.bag): drive.name for drive in drives}
    for drive in held_apart:
        same = training.get(identity.contents(drive.bag))
        if same:
            raise EvaluationError(f"{path}: held_apart has {drive.name}, with the contents of {same} in bags; expected "
                                  "other recordings")


def read(path):
    """The JobsFile at `path`. Raises EvaluationError."""
    reader = _Reader(path)
    drives, held_apart = reader.drives("bags"), reader.drives("held_apart")
    if not drives:
        reader.fail("bags", reader.values.get("bags"), "a list of bags")
    _require_apart(reader.path, drives, held_apart)
    tune = reader.values.get("tune", {})
    if not isinstance(tune, dict):
        reader.fail("tune", tune, "a mapping with the keys parameters, trials and seed")
    limits = Limits(reader.number("lost_error", Limits.error), reader.number("lost_cost", Limits.cost))
    return JobsFile(reader.path, drives, held_apart, reader.settings(), reader.seeds(), limits, tune)
