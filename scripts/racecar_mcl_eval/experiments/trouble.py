"""Carried away, and started anywhere: what the searches of the map buy, and what they cost."""
import csv

import numpy as np

from ..page import Cell
from ..style import COLOURS, new_figure
from .drives import CORRIDOR, TRACK, loop
from .sweeps import plain_ticks
from .workshop import DEFAULT

BEFORE, AFTER = 2, 8  # s, driven before the trouble and after it
AT_ONCE = 5.0  # s, within which the car should be found


def seconds_until_localized(path):
    """Of each drive of an evaluate_drives table; inf where it never was."""
    with open(path, newline="", encoding="utf-8") as file:
        return [float(row["localized"] or np.inf) for row in csv.DictReader(file)]


class CarriedAway:
    title = "Carried away, and started anywhere"
    TROUBLES = (
        ("kidnap", "carried to another place", (("the project's own", ()),
                                                ("without recovery", ("recovery:=false",)))),
        ("start", "started anywhere", (("the project's own", ()),
                                       ("without a search", ("global_search:=false",)))))

    def plan(self, workshop):
        self.drives = 2 if workshop.quick else 25
        self.runs = {}
        for trouble, _, variants in self.TROUBLES:
            for name, settings in variants:
                table = workshop.folder / f"runs/{trouble}-{len(self.runs) + 1}.csv"
                words = ["--map", CORRIDOR, TRACK, "--trouble", trouble, "--drives", self.drives, "--before",
                         BEFORE, "--after", AFTER, "--seed", 1]
                for setting in settings:
                    words += ["--set", setting]
                self.runs[trouble, name] = table, workshop.other(
                    "evaluate_drives", *words, "--out", table)

    def show(self, page, workshop):
        figure, axes = new_figure(1, len(self.TROUBLES), height=3.2, sharex=True, sharey=True)
        rows = []
        for plot, (trouble, told, variants) in zip(axes[0], self.TROUBLES):
            for (name, _), colour in zip(variants, COLOURS):
                seconds = np.sort(seconds_until_localized(self.runs[trouble, name][0]))
                found = seconds[np.isfinite(seconds)]
                shares = 100.0 * np.arange(1, len(found) + 1) / len(seconds)
                plot.step([0.0, *found, AFTER], [0.0, *shares, shares[-1] if len(shares) else 0.0],
                          where="post", color=colour, label=name)
                at_once = int(np.sum(seconds <= AT_ONCE))
                median = seconds[len(seconds) // 2]
                rows.append([told, name, Cell(f"{at_once} of {len(seconds)}",
                                              "good" if at_once >= 0.95 * len(seconds) else "bad"),
                             f"{median:.2f}" if np.isfinite(median) else "–"])
            plot.set_title(told, fontsize=10)
            plot.set_xlabel("time since then (s)")
            plot.legend(loc="center right")
        axes[0, 0].set_ylabel("drives localized (%)")
        section = page.section(self.title)
        section.text(f"{self.drives} drives on each map at 3 m/s, seeds 1 to {self.drives}. Localized: an error "
                     "of at most 0.15 m that none above 0.5 m follows.")
        section.table(["what happens", "constants", f"localized within {AT_ONCE:g} s", "median time (s)"], rows,
                      f"The car is driven for {BEFORE} s, put elsewhere, and driven on; or nobody says where it is.")
        section.figure(figure, "carried-away", "Share of the drives that are localized, over time.",
                       workshop.commands(*(planned for _, planned in self.runs.values())))


class ShrinkingSet:
    title = "A set that shrinks"
    VARIANTS = (("20,000 particles, shrinking to 200", ()),
                ("20,000 all the time", ("num_particles:=20000",)))
    SETTLED = 2.0  # s, after which an update costs what it costs from then on

    def plan(self, workshop):
        self.drive = loop(workshop, CORRIDOR, 0.1, duration=4 if workshop.quick else 10)
        self.runs = {name: workshop.replay(self.drive, DEFAULT, settings=settings, start=("--global",),
                                           timed=True) for name, settings in self.VARIANTS}

    def show(self, page, workshop):
        figure, axes = new_figure(1, 2, height=3.2, sharex=True)
        rows = []
        for (name, replay), colour in zip(self.runs.items(), COLOURS):
            run = workshop.run(replay)
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
        axes[0, 1].set_ylabel("time of an update (ms)")
        for plot in axes[0]:
            plot.set_xlabel("time since the start (s)")
        axes[0, 1].legend(loc="upper right")
        section = page.section(self.title)
        section.text("Nobody says where the car is. As the particles agree, KLD sampling asks for fewer of them.")
        section.table(["set", "mean error (cm)", "particles", "median time of an update (ms)"], rows,
                      f"From {self.SETTLED:g} s after the start on. The first update holds the search of the map.")
        section.figure(figure, "shrinking-set", "Particles and the time of an update after a start anywhere, "
                       "on one core of the machine that made this page.",
                       workshop.commands(*self.runs.values()))
