"""From a bad start to the right place, and three estimates of an ambiguous one."""
import csv

import cv2
import numpy as np
from matplotlib.lines import Line2D

from ..page import Cell
from ..run_figures import TRUTH_UNDER
from ..style import BAD, COLOURS, TRUTH, WIDTH, new_figure, plt
from .drives import CONFIG_COLOURS, CONFIGS, CORRIDOR, loop
from .workshop import CONFIG_NAMES, DEFAULT, seeds_text

CONVERGED = 0.1  # m
HELD = 1.0       # s, for which the error has to stay below
AT_PLACE = 0.5   # m, within which an estimate is at the car, or at its twin


def seconds_to_converge(errors, start):
    """s until the error is below CONVERGED and stays there for HELD s; None where it never is."""
    seconds, inside = errors.seconds(start), errors.position < CONVERGED
    for index in np.flatnonzero(inside):
        held = (seconds >= seconds[index]) & (seconds <= seconds[index] + HELD)
        if inside[held].all():
            return None if seconds[-1] - seconds[index] < HELD else float(seconds[index])
    return None


class BadStart:
    title = "From a bad start"
    OFFSETS = (0.25, 0.5, 1.0)  # m
    TURN = 0.2                  # rad, to either side in turn

    def plan(self, workshop):
        self.drive = loop(workshop, CORRIDOR, 0.1, duration=4 if workshop.quick else 10)
        directions = 2 if workshop.quick else 8
        # simulate_bag starts here: maps/corridor_start.yaml.
        x, y, yaw = -7.8, -2.65, 0.0
        self.runs = {}
        for config in CONFIGS:
            for offset in self.OFFSETS:
                for k in range(directions):
                    angle = 2.0 * np.pi * k / directions
                    pose = (f"{x + offset * np.cos(angle):.3f} {y + offset * np.sin(angle):.3f} "
                            f"{yaw + self.TURN * (-1)**k:.3f}")
                    self.runs.setdefault((config, offset), []).append(workshop.replay(
                        self.drive, config, start=("--initial-pose", pose), seed=k + 1))

    def show(self, page, workshop):
        section = page.section(self.title)
        section.text("The filter is told a start that is off by so much, in "
                     f"{len(next(iter(self.runs.values())))} directions and "
                     f"{np.degrees(self.TURN):.0f}° to the left or right, while the car drives off at 3 "
                     f"m/s. Converged: below {CONVERGED:g} m for {HELD:g} s and more.")
        figure, axes = new_figure(2, len(self.OFFSETS), height=5.4, sharex=True, sharey=True)
        rows = []
        for row, config in enumerate(CONFIGS):
            for column, offset in enumerate(self.OFFSETS):
                plot = axes[row, column]
                runs = [workshop.run(replay) for replay in self.runs[config, offset]]
                for run in runs:
                    plot.semilogy(run.errors.seconds(run.start), np.maximum(run.errors.position, 1e-3),
                                  color=CONFIG_COLOURS[config], linewidth=0.7, alpha=0.7)
                plot.axhline(CONVERGED, color=BAD, linestyle="--", linewidth=1.0)
                plot.set_title(f"{offset:g} m off, {CONFIG_NAMES[config]}", fontsize=9)
                times = [seconds_to_converge(run.errors, run.start) for run in runs]
                found = [time for time in times if time is not None]
                rows.append([CONFIG_NAMES[config], f"{offset:g} m",
                             Cell(f"{len(found)} of {len(times)}",
                                  "good" if len(found) == len(times) else "bad"),
                             f"{np.median(found):.2f}" if found else "–",
                             f"{max(found):.2f}" if found else "–"])
            axes[row, 0].set_ylabel("position error (m)")
        for plot in axes[1]:
            plot.set_xlabel("time (s)")
        section.table(["constants", "start off by", "converged", "median time (s)", "slowest (s)"], rows,
                      f"Time to an error below {CONVERGED:g} m.")
        section.figure(figure, "bad-start", "Error over time after a start that was off. Red: 0.1 m.",
                       workshop.commands(self.drive, *(runs[0] for runs in self.runs.values())))


def write_twin_corridor(folder):
    """A corridor that looks the same from both ends, but for a niche near one of them."""
    resolution, length, width = 0.05, 44.0, 2.4
    columns, rows = int(length / resolution), int(5.0 / resolution)
    image = np.full((rows, columns), 205, np.uint8)

    def free(x, y, dx, dy):
        """A box by its lower left corner and size, in metres from the middle."""
        left, top = (x + length / 2) / resolution, (2.5 - y - dy) / resolution
        image[int(round(top)):int(round(top + dy / resolution)),
              int(round(left)):int(round(left + dx / resolution))] = 254

    free(-length / 2 + 0.5, -width / 2, length - 1.0, width)
    # Niches by pairs: turned by half a turn each falls onto its twin.
    for x, w in ((-19.0, 1.5), (-13.5, 0.8), (-9.0, 2.0), (-4.0, 1.0), (0.6, 1.6), (6.0, 0.9),
                 (11.5, 1.4), (16.0, 1.0)):
        free(x, width / 2, w, 0.6)
        free(-x - w, -width / 2 - 0.6, w, 0.6)
    free(18.8, width / 2, 1.2, 1.1)
    wall = cv2.dilate((image == 254).astype(np.uint8), np.ones((7, 7), np.uint8)) > 0
    image[wall & (image != 254)] = 0
    folder.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(folder / "twin.png"), image)
    path = folder / "twin.yaml"
    path.write_text(f"image: twin.png\nresolution: {resolution}\norigin: [{-length / 2}, -2.5, 0.0]\n"
                    "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n", encoding="utf-8")
    return path


class ThreeEstimates:
    title = "Mean, best particle or best cluster"
    KINDS = (("mean", "weighted mean", COLOURS[1]), ("best", "best particle", COLOURS[4]),
             ("cluster", "best cluster", COLOURS[0]))
    SHOWN_AT = 1.5     # s
    DRAWN = 1000       # particles of a set, so that arrows can be told apart

    def plan(self, workshop):
        self.map_yaml = write_twin_corridor(workshop.folder / "maps")
        self.drive = workshop.drive(self.map_yaml, "--start", "8 0 0", "--duration", 6, "--speed", 2,
                                    "--odom-noise", 0.1, "--wall-distance", 1.0, "--seed", 1)
        self.particles = workshop.folder / "runs/twin_particles.csv"
        self.seeds = (1,) if workshop.quick else (1, 2, 3, 4)
        self.runs = {}
        for kind, _, _ in self.KINDS:
            for seed in self.seeds:
                extra = (("--particles", self.particles, "--particles-period", 0.5)
                         if (kind, seed) == ("mean", self.seeds[0]) else ())
                self.runs[kind, seed] = workshop.replay(
                    self.drive, DEFAULT, start=("--global",), extra=extra, seed=seed,
                    settings=(f"estimate:={kind}", "num_particles:=5000"))

    def show(self, page, workshop):
        section = page.section(self.title)
        section.text("The report's open problem: of a cloud in two places the mean lies between "
                     "them, where the car is not. This corridor looks the same from both ends, but "
                     "for one deep niche (top right); the filter starts anywhere. Until the car "
                     "has looked into that niche, two places explain all scans: its own and the twin, "
                     "half a turn about the middle. While the filter is in more than one place it gives "
                     "the best cluster instead of the mean, which is why those two rows are alike.")
        self._table(section, workshop)
        self._figure(section, workshop)

    def _table(self, section, workshop):
        rows = []
        for kind, name, _ in self.KINDS:
            every = [workshop.run(self.runs[kind, seed]).errors for seed in self.seeds]
            at_car = np.mean([(errors.position <= AT_PLACE).mean() for errors in every])
            at_twin = np.mean([self._at_twin(errors).mean() for errors in every])
            neither = 1.0 - at_car - at_twin
            jumps = np.mean([self._jumps(errors) for errors in every])
            rows.append([name, f"{100.0 * at_car:.0f}", f"{100.0 * at_twin:.0f}",
                         Cell(f"{100.0 * neither:.0f}", "bad" if neither > 0.1 else "good"),
                         Cell(f"{jumps:.1f}", "bad" if jumps > 20.0 else "good"),
                         f"{np.mean([errors.position.mean() for errors in every]):.2f}",
                         f"{max(errors.position[-1] for errors in every):.3f}"])
        section.table(["estimate", "at the car (% of time)", "at its twin (%)", "at neither (%)",
                       "jumps over 1 m, per run", "mean error (m)", "error at the end, worst (m)"], rows,
                      f"Where each estimate was (within {AT_PLACE:g} m), the filter's "
                      f"{seeds_text(self.seeds)}. The twin is a fair guess, neither place is "
                      "always wrong, and a car cannot be steered by an estimate that jumps.")

    def _figure(self, section, workshop):
        runs = {kind: workshop.run(self.runs[kind, self.seeds[0]]) for kind, _, _ in self.KINDS}
        figure = plt.figure(figsize=(WIDTH, 6.4))
        grid = figure.add_gridspec(3, 1, height_ratios=[1.0, 1.0, 1.6])
        moment, ways, error = (figure.add_subplot(grid[row]) for row in range(3))
        for plot in (moment, ways):
            workshop.map(self.map_yaml).draw(plot)
            plot.set(xlim=(-22.5, 22.5), ylim=(-2.6, 2.6), ylabel="y (m)")
            plot.grid(False)
        truth = workshop.truth(self.drive)
        self._draw_moment(moment, runs, truth)
        ways.plot(*truth.poses[:, :2].T, color=TRUTH_UNDER, linewidth=5.0)
        for kind, name, shade in self.KINDS:
            run = runs[kind]
            # Points: a line would only show the jumps between the two places.
            ways.plot(*run.trajectory.poses[:, :2].T, ".", color=shade, markersize=2.5)
            error.plot(run.errors.seconds(run.start), run.errors.position, color=shade, linewidth=1.4)
        ways.set_title("all estimates of the run", fontsize=10)
        ways.set_xlabel("x (m)")
        error.set(xlabel="time (s)", ylabel="position error (m)")
        error.set_ylim(bottom=0.0)
        figure.legend(handles=[
            Line2D([], [], color=TRUTH_UNDER, linewidth=5.0, label="truth"),
            Line2D([], [], color=TRUTH, marker="s", linestyle="", label="car"),
            Line2D([], [], color=COLOURS[3], marker=">", linestyle="", label="particles"),
            *(Line2D([], [], color=shade, marker="X", label=name) for _, name, shade in self.KINDS)],
            loc="upper center", ncol=6, bbox_to_anchor=(0.5, 1.06))
        section.figure(figure, "three-estimates", "A start anywhere in a corridor where every "
                       f"place has a twin; seed {self.seeds[0]}. Top: the particles stand in two "
                       "groups. Below: where the estimates were, and their "
                       "errors, until the niche is seen and the wrong group dies out.",
                       workshop.commands(*(self.runs[kind, self.seeds[0]] for kind, _, _ in self.KINDS)))

    def _draw_moment(self, plot, runs, truth):
        """Particles, car and estimates a while after the start."""
        start = runs["mean"].start
        stamp, cloud = self._particles_at(self.SHOWN_AT, start)
        cloud = cloud[::max(1, len(cloud) // self.DRAWN)]
        plot.quiver(cloud[:, 0], cloud[:, 1], np.cos(cloud[:, 2]), np.sin(cloud[:, 2]), angles="xy",
                    color=COLOURS[3], scale=45.0, width=0.0015, zorder=2)
        here = truth.poses[np.searchsorted(truth.stamps, stamp * 1e9)]
        plot.plot(*here[:2], marker="s", color=TRUTH, markersize=8, zorder=3)
        for kind, _, shade in self.KINDS:
            trajectory = runs[kind].trajectory
            pose = trajectory.poses[np.searchsorted(trajectory.stamps, stamp * 1e9)]
            plot.plot(*pose[:2], marker="X", color=shade, markersize=10, markeredgecolor="white", zorder=4,
                      linestyle="")
        plot.set_title(f"the particles {stamp - start * 1e-9:.1f} s after the start", fontsize=10)

    def _particles_at(self, seconds, start):
        sets = {}
        with open(self.particles, encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                pose = [float(row[name]) for name in ("x", "y", "yaw")]
                sets.setdefault(float(row["stamp"]), []).append(pose)
        stamp = min(sets, key=lambda each: abs(each - start * 1e-9 - seconds))
        return stamp, np.array(sets[stamp])

    @staticmethod
    def _at_twin(errors):
        """Whether the estimate is where the truth, turned by half a turn about the middle, is."""
        away = np.hypot(*(errors.estimate[:, :2] + errors.truth[:, :2]).T)
        return (away <= AT_PLACE) & (errors.position > AT_PLACE)

    @staticmethod
    def _jumps(errors):
        """How often the estimate jumped by more than a metre from one truth stamp to the next."""
        return int((np.hypot(*np.diff(errors.estimate[:, :2], axis=0).T) > 1.0).sum())
