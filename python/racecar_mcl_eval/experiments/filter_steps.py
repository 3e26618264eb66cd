"""The beam model's table and the particle set during one filter update: figures 1 to 3 of the course report."""
import csv

import numpy as np
from mpl_toolkits import mplot3d

from ..programs import ROOT
from ..plot_style import COLOURS, TRUTH, TRUTH_UNDER, WIDTH, colour, new_figure, plt
from .runner import REPORT
from .tracking import CORRIDOR, loop

# Section 2.2 of the report.
ALPHA_HIT, ALPHA_SHORT, ALPHA_MAX, ALPHA_RAND, SIGMA_HIT, MAX_PIXEL = 0.74, 0.07, 0.07, 0.12, 8.0, 200


def table_by_formula():
    """T[z][d] by the report's equations, independent of the program under test."""
    z, d = np.meshgrid(np.arange(MAX_PIXEL + 1.0), np.arange(MAX_PIXEL + 1.0), indexing="ij")
    hit = np.exp(-((z - d)**2) / (2.0 * SIGMA_HIT**2)) / np.sqrt(2.0 * np.pi * SIGMA_HIT**2)
    hit /= hit.sum(axis=0)
    safe = np.where(d > 0.0, d, 1.0)
    short = np.where((z <= d) & (d > 0.0), 2.0 / safe * (1.0 - z / safe), 0.0)
    table = (ALPHA_HIT * hit + ALPHA_SHORT * short + ALPHA_MAX * (z == MAX_PIXEL)
             + ALPHA_RAND / MAX_PIXEL)
    return table / table.sum(axis=0)


class BeamTable:
    title = "Beam model table"

    def plan(self, runner):
        self.file = runner.folder / "runs/beam_table.csv"
        self.made = runner.program("beam_table", "--out", self.file)

    def show(self, page, runner):
        table = np.loadtxt(self.file, delimiter=",")
        difference = np.abs(table - table_by_formula()).max()
        section = page.section(self.title)
        section.text(f"p(z | d) with α_hit {ALPHA_HIT}, α_short {ALPHA_SHORT}, α_max {ALPHA_MAX}, "
                     f"α_rand {ALPHA_RAND}, σ_hit {SIGMA_HIT:g} pixels, normalised over z for each d. Max difference "
                     f"from an independent evaluation of the equations: {difference:.1e}. The columns sum to 1 "
                     f"within {np.abs(table.sum(axis=0) - 1.0).max():.1e}.")
        figure = plt.figure(figsize=(WIDTH, 4.8))
        surface = figure.add_subplot(1, 2, 1, projection=mplot3d.Axes3D.name)
        z, d = np.meshgrid(np.arange(len(table)), np.arange(len(table)), indexing="ij")
        surface.plot_surface(d, z, table, cmap="viridis", rcount=100, ccount=100, linewidth=0)
        surface.set_xlabel("expected d (pixels)", labelpad=10)
        surface.set_ylabel("measured z (pixels)", labelpad=10)
        surface.set(xticks=(0, 50, 100, 150, 200), yticks=(0, 50, 100, 150, 200))
        surface.view_init(elev=32, azim=-62)
        surface.set_title("p(z | d)")
        slices = figure.add_subplot(1, 2, 2)
        for index, expected in enumerate((20, 60, 100, 140, 180)):
            slices.semilogy(table[:, expected], color=colour(index))
            slices.text(expected, 1.1 * table[expected, expected], f"d = {expected}", color=colour(index),
                        ha="center", fontsize=9)
        slices.set(xlabel="measured z (pixels)", ylabel="p(z | d)", title="Slices at five distances")
        section.figure(figure, "fig-1-beam-table", "Beam model table (figure 1 of the report): ridge: hit; slope "
                       "before it: unmapped obstacle; wall at z = 200: missing return; floor: random noise.",
                       runner.commands(self.made))


class ParticleSteps:
    title = "Particles during one update"
    AT, DRIVE = 4.0, 0.5  # s

    def plan(self, runner):
        self.drive = loop(runner, CORRIDOR, 0.1)
        self.file = runner.folder / "runs/particle_steps.csv"
        self.made = runner.program(
            "particle_steps", "--bag", self.drive.bag, "--map", CORRIDOR, "--truth",
            self.drive.truth_file, "--config", ROOT / f"config/{REPORT}.yaml", "--at", self.AT, "--drive",
            self.DRIVE, "--seed", 1, "--out", self.file)

    def show(self, page, runner):
        with open(self.file, encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        steps = (("start", "initial: σ = 0.5 m, 0.5 rad"), ("first_scan", "weighted and resampled"),
                 ("moved", f"after {self.DRIVE:g} s of odometry"),
                 ("resampled", "weighted and resampled again"))
        sets = {step: np.array([[float(row[name]) for name in ("stamp", "x", "y", "yaw")]
                                for row in rows if row["step"] == step]) for step, _ in steps}
        truth = runner.truth(self.drive)
        centre = np.mean([sets["start"][:, 1:3].mean(axis=0), sets["moved"][:, 1:3].mean(axis=0)], axis=0)
        figure, axes = new_figure(2, 2, height=7.6)
        for plot, (step, title) in zip(axes.flat, steps):
            stamp, x, y, yaw = sets[step].T
            runner.map(CORRIDOR).draw(plot)
            plot.plot(*truth.poses[:, :2].T, color=TRUTH_UNDER, linewidth=3.0, zorder=1)
            plot.quiver(x, y, np.cos(yaw), np.sin(yaw), color=COLOURS[1], angles="xy", scale=28.0,
                        width=0.003, headwidth=4, alpha=0.8, zorder=3)
            here = truth.poses[np.searchsorted(truth.stamps, stamp[0] * 1e9)]
            plot.quiver(*here[:2], np.cos(here[2]), np.sin(here[2]), color=TRUTH, angles="xy", scale=16.0,
                        width=0.007, zorder=4)
            spread = np.sqrt(np.var(x) + np.var(y))
            plot.set(xlim=(centre[0] - 2.6, centre[0] + 2.6), ylim=(centre[1] - 1.9, centre[1] + 1.9),
                     xlabel="x (m)", ylabel="y (m)")
            plot.set_title(f"{title}\nspread {100.0 * spread:.0f} cm", fontsize=10)
            plot.grid(False)
        section = page.section(self.title)
        section.figure(figure, "fig-2-3-particles",
                       "200 particles (orange) and the car (black) with the report's parameters: the "
                       "motion model spreads the particles (figure 2 of the report), weighting and resampling "
                       "concentrates them (figure 3).",
                       runner.commands(self.drive, self.made))
