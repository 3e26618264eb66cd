"""Plans what has to be driven and replayed, does it, and keeps the results by what was asked.

Experiments plan first and look at results later, so that everything runs side by side, nothing runs
twice, and one progress bar covers it all.
"""
import concurrent.futures
import shlex
from dataclasses import dataclass, field
from pathlib import Path

from tqdm import tqdm

from .. import grid_map, programs
from ..run import load_folder
from ..trajectory import read_tum

# The two sets of constants that are compared.
REPORT = "report"
DEFAULT = "default"
CONFIG_NAMES = {REPORT: "the report's constants", DEFAULT: "the project's own"}


def seeds_text(seeds):
    """The filter's seeds for a sentence: "seed 1", "seeds 1, 2, 3"."""
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
    """A drive, localized."""
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
class Workshop:
    folder: Path
    quick: bool = False
    jobs: int = 2
    _drives: dict = field(default_factory=dict)
    _replays: dict = field(default_factory=dict)
    _timed: dict = field(default_factory=dict)
    _others: list = field(default_factory=list)
    _runs: dict = field(default_factory=dict)
    _truths: dict = field(default_factory=dict)
    _maps: dict = field(default_factory=dict)

    def drive(self, map_yaml, *arguments):
        """Plans a drive with simulate_bag."""
        key = (Path(map_yaml), tuple(map(str, arguments)))
        if key not in self._drives:
            name = f"{Path(map_yaml).stem}-{len(self._drives) + 1:02d}"
            self._drives[key] = Drive(name, key[0], key[1], self.folder / "drives")
        return self._drives[key]

    def replay(self, drive, config, settings=(), start=("--initial-pose-from-truth",), seed=1, extra=(),
               timed=False):
        """Plans a replay. A `timed` one runs alone, so that its update times mean something."""
        planned = self._timed if timed else self._replays
        key = (drive, config, tuple(settings), tuple(start), seed, tuple(map(str, extra)))
        if key not in planned:
            kind = "timed" if timed else "run"
            planned[key] = Replay(*key, self.folder / f"runs/{kind}-{len(planned) + 1:03d}")
        return planned[key]

    def other(self, program, *arguments):
        """Plans a run of another program, which may need drives."""
        self._others.append((program, arguments))
        return program, arguments

    def work(self):
        """Does everything that was planned."""
        (self.folder / "drives").mkdir(parents=True, exist_ok=True)
        (self.folder / "runs").mkdir(exist_ok=True)
        drives = [("simulate_bag", drive.words) for drive in self._drives.values()]
        side_by_side = [("replay", replay.words) for replay in self._replays.values()] + self._others
        alone = [("replay", replay.words) for replay in self._timed.values()]
        total = len(drives) + len(side_by_side) + len(alone)
        with tqdm(total=total, unit="run", disable=None, smoothing=0.05) as bar:
            for stage, tasks, jobs in (("driving", drives, self.jobs), ("timing", alone, 1),
                                       ("localizing", side_by_side, self.jobs)):
                bar.set_description(stage)
                self._do(tasks, jobs, bar)

    @staticmethod
    def _do(tasks, jobs, bar):
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            waiting = [pool.submit(programs.run, *task) for task in tasks]
            try:
                for done in concurrent.futures.as_completed(waiting):
                    done.result()
                    bar.update()
            finally:
                # After a failure or Ctrl-C what has not begun is left alone.
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

    def run(self, replay, name=None):
        """The Run that a replay left, with its errors."""
        if replay not in self._runs:
            self._runs[replay] = load_folder(replay.folder)
            self._runs[replay].set_truth(self.truth(replay.drive), 0.5)
        run = self._runs[replay]
        if name:
            run.name = name
        return run

    def commands(self, *planned):
        """The commands behind drives, replays and other runs, as one would type them in the package's
        folder: each drive before its replays, nothing twice."""
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
