"""Runs the simulations and replays of all experiments and holds their results.

Experiments first plan their runs and read the results later, so that runs are shared and executed in parallel
with one progress bar.
"""
import concurrent.futures
import shlex
import sys
from dataclasses import dataclass, field
from pathlib import Path

from tqdm import tqdm

from .. import grid_map, programs
from ..run import load_folder
from ..trajectory import read_tum

# The two parameter sets that are compared: config/NAME.yaml.
REPORT = "report"
DEFAULT = "default"
CONFIG_NAMES = {REPORT: "report parameters", DEFAULT: "default parameters"}


def seeds_text(seeds):
    """Seeds as text: "seed 1", "seeds 1, 2, 3"."""
    return ("seed " if len(seeds) == 1 else "seeds ") + ", ".join(map(str, seeds))


@dataclass(frozen=True)
class Drive:
    """A simulated drive."""
    name: str
    map_yaml: Path
    arguments: tuple
    folder: Path

    @property
    def bag(self):
        return self.folder / f"{self.name}.bag"

    @property
    def truth_file(self):
        return self.folder / f"{self.name}.tum"

    @property
    def words(self):
        return ["--map", self.map_yaml, *self.arguments, "--out", self.bag, "--truth", self.truth_file]


@dataclass(frozen=True)
class Replay:
    """A replay of a drive."""
    drive: Drive
    config: str
    settings: tuple
    start: tuple
    seed: int
    extra: tuple
    folder: Path

    @property
    def words(self):
        words = ["--bag", self.drive.bag, "--map", self.drive.map_yaml, "--truth",
                 self.drive.truth_file, "--config", programs.ROOT / f"config/{self.config}.yaml",
                 *self.start, "--seed", self.seed]
        for setting in self.settings:
            words += ["--set", setting]
        return words + [*self.extra, "--out", self.folder]


@dataclass
class Runner:
    """Plans, executes and loads runs; everything is written to `folder`."""
    folder: Path
    quick: bool = False
    jobs: int = 2
    _drives: dict = field(default_factory=dict)
    _replays: dict = field(default_factory=dict)
    _timed: dict = field(default_factory=dict)
    _programs: list = field(default_factory=list)
    _runs: dict = field(default_factory=dict)
    _truths: dict = field(default_factory=dict)
    _maps: dict = field(default_factory=dict)

    def drive(self, map_yaml, *arguments):
        """Plans a drive with simulate_bag, once."""
        key = (Path(map_yaml), tuple(map(str, arguments)))
        if key not in self._drives:
            name = f"{Path(map_yaml).stem}-{len(self._drives) + 1:02d}"
            self._drives[key] = Drive(name, key[0], key[1], self.folder / "drives")
        return self._drives[key]

    def replay(self, drive, config, settings=(), start=("--initial-pose-from-truth",), seed=1, extra=(),
               timed=False):
        """Plans a replay, once. Timed replays run one at a time, so that their update times are meaningful."""
        planned = self._timed if timed else self._replays
        key = (drive, config, tuple(settings), tuple(start), seed, tuple(map(str, extra)))
        if key not in planned:
            kind = "timed" if timed else "run"
            planned[key] = Replay(*key, self.folder / f"runs/{kind}-{len(planned) + 1:03d}")
        return planned[key]

    def program(self, program, *arguments):
        """Plans a run of another program, after the drives."""
        self._programs.append((program, arguments))
        return program, arguments

    def execute(self):
        """Executes all planned runs."""
        (self.folder / "drives").mkdir(parents=True, exist_ok=True)
        (self.folder / "runs").mkdir(exist_ok=True)
        drives = [("simulate_bag", drive.words) for drive in self._drives.values()]
        parallel = [("replay", replay.words) for replay in self._replays.values()] + self._programs
        sequential = [("replay", replay.words) for replay in self._timed.values()]
        total = len(drives) + len(parallel) + len(sequential)
        with tqdm(total=total, unit="run", disable=None, smoothing=0.05) as bar:
            for stage, tasks, jobs in (("driving", drives, self.jobs), ("timing", sequential, 1),
                                       ("localizing", parallel, self.jobs)):
                bar.set_description(stage)
                if bar.disable and tasks:
                    # Without a terminal, as in a log file.
                    print(f"{stage}: {len(tasks)} of {total} runs", file=sys.stderr, flush=True)
                self._execute(tasks, jobs, bar)

    @staticmethod
    def _execute(tasks, jobs, bar):
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            waiting = [pool.submit(programs.run, *task) for task in tasks]
            try:
                for done in concurrent.futures.as_completed(waiting):
                    done.result()
                    bar.update()
            finally:
                # After a failure or Ctrl-C: skip the remaining runs.
                for task in waiting:
                    task.cancel()

    def truth(self, drive):
        if drive not in self._truths:
            self._truths[drive] = read_tum(drive.truth_file)
        return self._truths[drive]

    def map(self, map_yaml):
        if map_yaml not in self._maps:
            self._maps[map_yaml] = grid_map.load_map(map_yaml)
        return self._maps[map_yaml]

    def run(self, replay):
        """The Run of a replay, with its errors."""
        if replay not in self._runs:
            self._runs[replay] = load_folder(replay.folder)
            self._runs[replay].set_truth(self.truth(replay.drive), 0.5)
        return self._runs[replay]

    def commands(self, *planned):
        """The shell commands of drives, replays and programs, to be run in the package's folder; without
        duplicates, each drive before its replays."""
        lines = []
        for each in planned:
            if isinstance(each, Replay):
                lines += [self._line("simulate_bag", each.drive.words), self._line("replay", each.words)]
            elif isinstance(each, Drive):
                lines.append(self._line("simulate_bag", each.words))
            else:
                lines.append(self._line(*each))
        return list(dict.fromkeys(lines))

    def _line(self, program, arguments):
        def short(word):
            text = str(word)
            for folder, shown in ((self.folder, "OUT/"), (programs.ROOT, "")):
                if text.startswith(f"{folder}/"):
                    text = shown + text[len(str(folder)) + 1:]
            return shlex.quote(text)
        return f"rosrun racecar_mcl {program} " + " ".join(short(word) for word in arguments)
