"""Fault injection: kidnapped robot and global localization, and the cost of adaptive particle counts."""
import csv

import numpy as np

from ..html_report import Cell
from ..plot_style import COLOURS, new_figure
from .tracking import CORRIDOR, TRACK, loop
from .parameter_sweeps import plain_ticks
from .runner import CONFIG_NAMES, DEFAULT

BEFORE, AFTER = 2, 8  # s, driven before and after the fault
TIME_LIMIT = 5.0  # s, in which the car should be localized again


def seconds_until_localized(path):
    """The time to localization (s) of each drive in a table of evaluate_scenarios; inf if it never succeeded."""
    with open(path, newline="", encoding="utf-8") as file:
        return [float(row["localized"] or np.inf) for row in csv.DictReader(file)]


class KidnappedRobot:
    title = "Kidnapped robot and global localization"
    SCENARIOS = (  # --fault of evaluate_scenarios, title, variants
        ("kidnap", "kidnapped robot", ((CONFIG_NAMES[DEFAULT], ()),
                                       ("without recovery", ("relocalization:=start",)))),
        ("start", "global localization", ((CONFIG_NAMES[DEFAULT], ()),
                                          ("without relocalization", ("relocalization:=off",)))))

    def plan(self, runner):
        self.drives = 2 if runner.quick else 25
        self.runs = {}
        for scenario, _, variants in self.SCENARIOS:
            for name, settings in variants:
                table = runner.folder / f"runs/{scenario}-{len(self.runs) + 1}.csv"
                words = ["--map", CORRIDOR, TRACK, "--fault", scenario, "--drives", self.drives, "--before",
                         BEFORE, "--after", AFTER, "--seed", 1]
                for setting in settings:
                    words += ["--set", setting]
                self.runs[scenario, name] = table, runner.program(
                    "evaluate_scenarios", *words, "--out", table)

    def show(self, page, runner):
        figure, axes = new_figure(1, len(self.SCENARIOS), height=3.2, sharex=True, sharey=True)
        rows = []
        for plot, (scenario, title, variants) in zip(axes[0], self.SCENARIOS):
            for (name, _), colour in zip(variants, COLOURS):
                seconds = np.sort(seconds_until_localized(self.runs[scenario, name][0]))
                finite = seconds[np.isfinite(seconds)]
                fractions = 100.0 * np.arange(1, len(finite) + 1) / len(seconds)
                plot.step([0.0, *finite, AFTER], [0.0, *fractions, fractions[-1] if len(fractions) else 0.0],
                          where="post", color=colour, label=name)
                in_time = int(np.sum(seconds <= TIME_LIMIT))
                median = seconds[len(seconds) // 2]
                rows.append([title, name, Cell(f"{in_time} of {len(seconds)}",
                                               "good" if in_time >= 0.95 * len(seconds) else "bad"),
                             f"{median:.2f}" if np.isfinite(median) else "–"])
            plot.set_title(title, fontsize=10)
            plot.set_xlabel("time since the fault (s)")
            plot.legend(loc="center right")
        axes[0, 0].set_ylabel("drives localized (%)")
        section = page.section(self.title)
        section.text(f"{self.drives} drives on each map at 3 m/s, seeds 1 to {self.drives}. Localized: position error "
                     "of at most 0.15 m, and never above 0.5 m again.")
        section.table(["scenario", "parameters", f"localized within {TIME_LIMIT:g} s", "median time (s)"], rows,
                      f"Kidnapped robot: moved to another pose after {BEFORE} s. Global localization: unknown initial "
                      "pose.")
        section.figure(figure, "kidnapped-robot", "Fraction of localized drives over time.",
                       runner.commands(*(planned for _, planned in self.runs.values())))


class AdaptiveParticleCount:
    title = "Adaptive particle count (KLD sampling)"
    VARIANTS = (("20,000 to 200 particles (adaptive)", ()),
                ("20,000 particles (constant)", ("num_particles:=20000",)))
    SETTLED = 2.0  # s, after which the update time is steady

    def plan(self, runner):
        self.drive = loop(runner, CORRIDOR, 0.1, duration=4 if runner.quick else 10)
        self.runs = {name: runner.replay(self.drive, DEFAULT, settings=settings, start=("--global",),
                                         timed=True) for name, settings in self.VARIANTS}

    def show(self, page, runner):
        figure, axes = new_figure(1, 2, height=3.2, sharex=True)
        rows = []
        for (name, replay), colour in zip(self.runs.items(), COLOURS):
            run = runner.run(replay)
            seconds = (run.updates.stamps - run.start) * 1e-9
            particles, times = run.updates.column("particles"), run.updates.column("update_ms")
            for plot, values in zip(axes[0], (particles, times)):
                plot.semilogy(seconds, values, color=colour, label=name)
            after, settled = run.errors.seconds(run.start) > self.SETTLED, seconds > self.SETTLED
            rows.append([name, f"{100.0 * run.errors.position[after].mean():.1f}",
                         f"{np.median(particles[settled]):,.0f}", f"{np.median(times[settled]):.2f}"])
        plain_ticks(axes[0, 0].yaxis, (200, 2000, 20000))
        plain_ticks(axes[0, 1].yaxis, (0.1, 1, 10, 100))
        axes[0, 0].set_ylabel("particles")
        axes[0, 1].set_ylabel("update time (ms)")
        for plot in axes[0]:
            plot.set_xlabel("time since the start (s)")
        axes[0, 1].legend(loc="upper right")
        section = page.section(self.title)
        section.text("After a global initialization, KLD sampling reduces the number of particles as they converge.")
        section.table(["particle set", "mean error (cm)", "particles", "median update time (ms)"], rows,
                      f"From {self.SETTLED:g} s after the start on. The first update includes the global search.")
        section.figure(figure, "adaptive-particle-count",
                       "Number of particles and update time after a global initialization, on one "
                       "core of the machine that generated this page.",
                       runner.commands(*self.runs.values()))
