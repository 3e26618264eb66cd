"""Carried away, and started anywhere: what the searches of the map buy."""
import csv

import numpy as np

from ..page import Cell
from ..style import COLOURS, new_figure
from .drives import CORRIDOR, TRACK

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
                         2, "--after", 8, "--seed", 1]
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
                plot.step([0.0, *found, 8.0], [0.0, *shares, shares[-1] if len(shares) else 0.0],
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
                      "The car is driven for 2 s, put elsewhere, and driven on; or nobody says where it is.")
        section.figure(figure, "carried-away", "Share of the drives that are localized, over time.",
                       workshop.commands(*(planned for _, planned in self.runs.values())))
