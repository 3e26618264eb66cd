"""Initial pose errors, and pose estimators under perceptual aliasing."""
import csv

import cv2
import numpy as np
from matplotlib.lines import Line2D

from ..html_report import Cell
from ..plot_style import BAD, COLOURS, TRUTH, TRUTH_UNDER, WIDTH, new_figure, plt
from .tracking import CONFIG_COLOURS, CONFIGS, CORRIDOR, loop, start_pose
from .runner import CONFIG_NAMES, DEFAULT, seeds_text

CONVERGED_ERROR = 0.1     # m
CONVERGED_DURATION = 1.0  # s, for which the error must stay below
SAME_PLACE = 0.5          # m, distance up to which an estimate is at the car, or at its alias


def seconds_to_converge(errors, start):
    """Time (s) until the error is below CONVERGED_ERROR for CONVERGED_DURATION; None if it never is."""
    seconds, small = errors.seconds(start), errors.position < CONVERGED_ERROR
    for index in np.flatnonzero(small):
        window = (seconds >= seconds[index]) & (seconds <= seconds[index] + CONVERGED_DURATION)
        if small[window].all():
            return None if seconds[-1] - seconds[index] < CONVERGED_DURATION else float(seconds[index])
    return None


class InitialPoseError:
    title = "Error of the initial pose"
    OFFSETS = (0.25, 0.5, 1.0)  # m
    ROTATION = 0.2              # rad, alternately left and right

    def plan(self, runner):
        self.drive = loop(runner, CORRIDOR, 0.1, duration=4 if runner.quick else 10)
        directions = 2 if runner.quick else 8
        x, y, yaw = start_pose(CORRIDOR)
        self.runs = {}
        for config in CONFIGS:
            for offset in self.OFFSETS:
                for k in range(directions):
                    angle = 2.0 * np.pi * k / directions
                    pose = (f"{x + offset * np.cos(angle):.3f} {y + offset * np.sin(angle):.3f} "
                            f"{yaw + self.ROTATION * (-1)**k:.3f}")
                    self.runs.setdefault((config, offset), []).append(runner.replay(
                        self.drive, config, start=("--initial-pose", pose), seed=k + 1))

    def show(self, page, runner):
        section = page.section(self.title)
        section.text("The filter starts from a wrong initial pose: offsets in "
                     f"{len(next(iter(self.runs.values())))} directions, rotated by "
                     f"{np.degrees(self.ROTATION):.0f}° to the left or right, while the car drives at 3 m/s. "
                     f"Converged: error below {CONVERGED_ERROR:g} m for at least {CONVERGED_DURATION:g} s.")
        figure, axes = new_figure(2, len(self.OFFSETS), height=5.4, sharex=True, sharey=True)
        rows = []
        for row, config in enumerate(CONFIGS):
            for column, offset in enumerate(self.OFFSETS):
                plot = axes[row, column]
                runs = [runner.run(replay) for replay in self.runs[config, offset]]
                for run in runs:
                    plot.semilogy(run.errors.seconds(run.start), np.maximum(run.errors.position, 1e-3),
                                  color=CONFIG_COLOURS[config], linewidth=0.7, alpha=0.7)
                plot.axhline(CONVERGED_ERROR, color=BAD, linestyle="--", linewidth=1.0)
                plot.set_title(f"offset {offset:g} m, {CONFIG_NAMES[config]}", fontsize=9)
                times = [seconds_to_converge(run.errors, run.start) for run in runs]
                converged = [time for time in times if time is not None]
                rows.append([CONFIG_NAMES[config], f"{offset:g} m",
                             Cell(f"{len(converged)} of {len(times)}",
                                  "good" if len(converged) == len(times) else "bad"),
                             f"{np.median(converged):.2f}" if converged else "–",
                             f"{max(converged):.2f}" if converged else "–"])
            axes[row, 0].set_ylabel("position error (m)")
        for plot in axes[1]:
            plot.set_xlabel("time (s)")
        section.table(["parameters", "offset", "converged", "median time (s)", "max time (s)"], rows,
                      f"Time to an error below {CONVERGED_ERROR:g} m.")
        section.figure(figure, "initial-pose-error", "Position error over time after a wrong initial pose. Red: "
                       f"{CONVERGED_ERROR:g} m.",
                       runner.commands(self.drive, *(runs[0] for runs in self.runs.values())))


def write_symmetric_corridor(folder):
    """Writes the map of a corridor with twofold rotational symmetry, except for one deep niche."""
    resolution, length, width = 0.05, 44.0, 2.4
    columns, rows = int(length / resolution), int(5.0 / resolution)
    image = np.full((rows, columns), 205, np.uint8)

    def free(x, y, dx, dy):
        """Frees a box, given by its lower left corner and size in metres from the centre."""
        left, top = (x + length / 2) / resolution, (2.5 - y - dy) / resolution
        image[int(round(top)):int(round(top + dy / resolution)),
              int(round(left)):int(round(left + dx / resolution))] = 254

    free(-length / 2 + 0.5, -width / 2, length - 1.0, width)
    # Niches in pairs, related by a rotation of 180 degrees about the centre.
    for x, w in ((-19.0, 1.5), (-13.5, 0.8), (-9.0, 2.0), (-4.0, 1.0), (0.6, 1.6), (6.0, 0.9),
                 (11.5, 1.4), (16.0, 1.0)):
        free(x, width / 2, w, 0.6)
        free(-x - w, -width / 2 - 0.6, w, 0.6)
    free(18.8, width / 2, 1.2, 1.1)
    wall = cv2.dilate((image == 254).astype(np.uint8), np.ones((7, 7), np.uint8)) > 0
    image[wall & (image != 254)] = 0
    folder.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(folder / "symmetric.png"), image)
    path = folder / "symmetric.yaml"
    path.write_text(f"image: symmetric.png\nresolution: {resolution}\norigin: [{-length / 2}, -2.5, 0.0]\n"
                    "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n", encoding="utf-8")
    return path


class PoseEstimators:
    title = "Pose estimators under perceptual aliasing"
    KINDS = (("mean", "weighted mean", COLOURS[1]), ("best", "best particle", COLOURS[4]),
             ("cluster", "best cluster", COLOURS[0]))
    SHOWN_AT = 1.5     # s
    MAX_DRAWN = 1000   # particles

    def plan(self, runner):
        self.map_yaml = write_symmetric_corridor(runner.folder / "maps")
        self.drive = runner.drive(self.map_yaml, "--start", "8 0 0", "--duration", 6, "--speed", 2,
                                  "--odom-noise", 0.1, "--wall-distance", 1.0, "--seed", 1)
        self.particles = runner.folder / "runs/symmetric_particles.csv"
        self.seeds = (1,) if runner.quick else (1, 2, 3, 4)
        self.runs = {}
        for kind, _, _ in self.KINDS:
            for seed in self.seeds:
                extra = (("--particles", self.particles, "--particles-period", 0.5)
                         if (kind, seed) == ("mean", self.seeds[0]) else ())
                self.runs[kind, seed] = runner.replay(
                    self.drive, DEFAULT, start=("--global",), extra=extra, seed=seed,
                    settings=(f"expert/estimate:={kind}", "num_particles:=5000"))

    def show(self, page, runner):
        section = page.section(self.title)
        section.text("An open problem of the report: the mean of a bimodal particle set lies between its modes, where "
                     "the car is not. This corridor is symmetric under a rotation by 180° except for one deep niche "
                     "(top right), and the filter is initialized globally. Until the niche is observed, two poses "
                     "explain all scans: the true one and its alias. While the particle set has more than one "
                     "cluster, the estimator mean returns the best cluster, hence the similar rows.")
        self._table(section, runner)
        self._figure(section, runner)

    def _table(self, section, runner):
        rows = []
        for kind, name, _ in self.KINDS:
            all_errors = [runner.run(self.runs[kind, seed]).errors for seed in self.seeds]
            at_car = np.mean([(errors.position <= SAME_PLACE).mean() for errors in all_errors])
            at_alias = np.mean([self._at_alias(errors).mean() for errors in all_errors])
            neither = 1.0 - at_car - at_alias
            jumps = np.mean([self._jumps(errors) for errors in all_errors])
            rows.append([name, f"{100.0 * at_car:.0f}", f"{100.0 * at_alias:.0f}",
                         Cell(f"{100.0 * neither:.0f}", "bad" if neither > 0.1 else "good"),
                         Cell(f"{jumps:.1f}", "bad" if jumps > 20.0 else "good"),
                         f"{np.mean([errors.position.mean() for errors in all_errors]):.2f}",
                         f"{max(errors.position[-1] for errors in all_errors):.3f}"])
        section.table(["estimator", "at the car (% of time)", "at the alias (%)", "elsewhere (%)",
                       "jumps over 1 m, per run", "mean error (m)", "max error at the end (m)"], rows,
                      f"Location of the estimate (within {SAME_PLACE:g} m), mean over the filter's "
                      f"{seeds_text(self.seeds)}. The alias is as likely as the true pose, an estimate elsewhere is "
                      "always wrong, and an estimate that jumps cannot be used for control.")

    def _figure(self, section, runner):
        runs = {kind: runner.run(self.runs[kind, self.seeds[0]]) for kind, _, _ in self.KINDS}
        figure = plt.figure(figsize=(WIDTH, 6.4))
        grid = figure.add_gridspec(3, 1, height_ratios=[1.0, 1.0, 1.6])
        moment, paths, error = (figure.add_subplot(grid[row]) for row in range(3))
        for plot in (moment, paths):
            runner.map(self.map_yaml).draw(plot)
            plot.set(xlim=(-22.5, 22.5), ylim=(-2.6, 2.6), ylabel="y (m)")
            plot.grid(False)
        truth = runner.truth(self.drive)
        self._draw_moment(moment, runs, truth)
        paths.plot(*truth.poses[:, :2].T, color=TRUTH_UNDER, linewidth=5.0)
        for kind, name, shade in self.KINDS:
            run = runs[kind]
            # Points, as lines would show mostly the jumps between the two poses.
            paths.plot(*run.trajectory.poses[:, :2].T, ".", color=shade, markersize=2.5)
            error.plot(run.errors.seconds(run.start), run.errors.position, color=shade, linewidth=1.4)
        paths.set_title("all estimates of the run", fontsize=10)
        paths.set_xlabel("x (m)")
        error.set(xlabel="time (s)", ylabel="position error (m)")
        error.set_ylim(bottom=0.0)
        figure.legend(handles=[
            Line2D([], [], color=TRUTH_UNDER, linewidth=5.0, label="truth"),
            Line2D([], [], color=TRUTH, marker="s", linestyle="", label="car"),
            Line2D([], [], color=COLOURS[3], marker=">", linestyle="", label="particles"),
            *(Line2D([], [], color=shade, marker="X", label=name) for _, name, shade in self.KINDS)],
            loc="upper center", ncol=6, bbox_to_anchor=(0.5, 1.06))
        section.figure(figure, "pose-estimators",
                       f"Global localization in the symmetric corridor, seed {self.seeds[0]}. "
                       "Top: the bimodal particle set. Below: the estimates and their errors until the niche is "
                       "observed and the wrong mode disappears.",
                       runner.commands(*(self.runs[kind, self.seeds[0]] for kind, _, _ in self.KINDS)))

    def _draw_moment(self, plot, runs, truth):
        """Draws particles, car and estimates at SHOWN_AT."""
        start = runs["mean"].start
        stamp, cloud = self._particles_at(self.SHOWN_AT, start)
        cloud = cloud[::max(1, len(cloud) // self.MAX_DRAWN)]
        plot.quiver(cloud[:, 0], cloud[:, 1], np.cos(cloud[:, 2]), np.sin(cloud[:, 2]), angles="xy",
                    color=COLOURS[3], scale=45.0, width=0.0015, zorder=2)
        here = truth.poses[np.searchsorted(truth.stamps, stamp * 1e9)]
        plot.plot(*here[:2], marker="s", color=TRUTH, markersize=8, zorder=3)
        for kind, _, shade in self.KINDS:
            trajectory = runs[kind].trajectory
            pose = trajectory.poses[np.searchsorted(trajectory.stamps, stamp * 1e9)]
            plot.plot(*pose[:2], marker="X", color=shade, markersize=10, markeredgecolor="white", zorder=4,
                      linestyle="")
        plot.set_title(f"particles {stamp - start * 1e-9:.1f} s after the start", fontsize=10)

    def _particles_at(self, seconds, start):
        sets = {}
        with open(self.particles, encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                pose = [float(row[name]) for name in ("x", "y", "yaw")]
                sets.setdefault(float(row["stamp"]), []).append(pose)
        stamp = min(sets, key=lambda each: abs(each - start * 1e-9 - seconds))
        return stamp, np.array(sets[stamp])

    @staticmethod
    def _at_alias(errors):
        """Mask of the estimates at the true position rotated by 180 degrees about the centre."""
        away = np.hypot(*(errors.estimate[:, :2] + errors.truth[:, :2]).T)
        return (away <= SAME_PLACE) & (errors.position > SAME_PLACE)

    @staticmethod
    def _jumps(errors):
        """The number of steps of the estimate by more than 1 m between consecutive truth stamps."""
        return int((np.hypot(*np.diff(errors.estimate[:, :2], axis=0).T) > 1.0).sum())
