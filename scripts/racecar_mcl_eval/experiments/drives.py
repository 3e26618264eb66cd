"""Drives round a loop with rising odometry noise: the report's section 3.1, figures 6 to 8."""
import numpy as np
from matplotlib.lines import Line2D

from .. import consistency
from ..page import Banner, Cell
from ..programs import ROOT
from ..run_figures import TRUTH_UNDER
from ..style import BAD, COLOURS, TRUTH, frame_on, new_figure
from .workshop import CONFIG_NAMES, DEFAULT, REPORT, seeds_text

CORRIDOR = ROOT / "maps/corridor.yaml"
TRACK = ROOT / "maps/track.yaml"
NOISES = (0.0, 0.05, 0.1)
STEADY = f"σ = {NOISES[-1]:g}, and 2 %, 3 % off"
# What the report's section 3.1 found with rising odometry noise.
REPORT_ERRORS = dict(zip(NOISES, (0.262, 0.270, 0.266)))  # m
REPORT_ANGLE = 5.0  # degrees, "the majority of the time"
CONFIGS = (REPORT, DEFAULT)
CONFIG_COLOURS = {REPORT: COLOURS[1], DEFAULT: COLOURS[0]}
# Limits on the mean error per set of constants, and on heading and greatest error of both.
MEAN_LIMIT = {REPORT: 0.025, DEFAULT: 0.015}  # m
HEADING_LIMIT = 0.5  # degrees
MAX_LIMIT = 0.10  # m


def loop(workshop, map_yaml, noise, duration=None, steady=True):
    """The standard drive: wall follower, 3 m/s; `steady`: the odometry is also off by +2 % of the
    speed and +3 % of the turn."""
    seconds = duration or (6 if workshop.quick else 60)
    return workshop.drive(map_yaml, "--duration", seconds, "--speed", 3, "--odom-noise", noise,
                          "--speed-scale-error", 0.02 if steady else 0,
                          "--turn-scale-error", 0.03 if steady else 0, "--seed", 1)


def judged(value, limit, text):
    """Good or bad where there is a limit."""
    level = "" if limit is None else "good" if value <= limit else "bad"
    return Cell(text.format(value), level)


class RisingNoise:
    title = "Three drives with rising odometry noise"

    def plan(self, workshop):
        self.seeds = (1,) if workshop.quick else (1, 2, 3)
        self.runs = {
            (map_yaml, noise, config): [
                workshop.replay(loop(workshop, map_yaml, NOISES[-1] if noise == STEADY else noise,
                                     steady=noise == STEADY), config, seed=seed)
                for seed in self.seeds]
            for map_yaml in (CORRIDOR, TRACK) for noise in (*NOISES, STEADY) for config in CONFIGS}

    def show(self, page, workshop):
        section = page.section(self.title)
        section.text(
            "The car follows the left wall at 3 m/s. Its odometry has Gaussian noise of standard "
            "deviation σ on each component of every twist (m/s, m/s, rad/s; 50 Hz), as the report's "
            "had; in the last rows it reports 2 % too much speed and 3 % too much turn besides. "
            "The estimate is compared with the simulated "
            "car's true pose at 100 Hz, without alignment. Mean over the filter's "
            f"{seeds_text(self.seeds)}; greatest of all. Within 3σ: updates whose error the "
            "filter's own covariance explains. NEES, the error squared in units of that "
            "covariance, is 3 on average where it is exact, less where it is cautious, more "
            "where it claims too much.")
        page.banners += [self._banner(workshop, config) for config in CONFIGS]
        for map_yaml in (CORRIDOR, TRACK):
            self._table(section, workshop, map_yaml)
        self._trajectory(section, workshop)
        self._over_time(section, workshop, 0.0, "fig-7-no-noise", "7")
        self._over_time(section, workshop, 0.1, "fig-8-noise", "8")
        self._tracks(section, workshop)

    def _measure(self, workshop, map_yaml, noise, config):
        """One row of a table."""
        runs = [workshop.run(replay) for replay in self.runs[map_yaml, noise, config]]
        told = [consistency.measure(run, 0.5) for run in runs]
        error = [run.errors.summary()["position_error_m"] for run in runs]
        heading = [run.errors.summary()["heading_error_deg"] for run in runs]
        return {"mean": np.mean([each["mean"] for each in error]),
                "p95": np.mean([each["p95"] for each in error]),
                "max": max(each["max"] for each in error),
                "heading": np.mean([each["mean"] for each in heading]),
                "heading_max": max(each["max"] for each in heading),
                "cross": np.mean([np.abs(run.errors.cross_track).mean() for run in runs]),
                "inside": 100.0 * np.mean([each.share_within for each in told]),
                "nees": np.mean([each.mean_nees for each in told])}

    def _banner(self, workshop, config):
        """The outcome in a line: the report's three errors against these."""
        rows = [self._measure(workshop, CORRIDOR, noise, config) for noise in NOISES]
        kept = all(row["mean"] <= MEAN_LIMIT[config] and row["max"] <= MAX_LIMIT and
                   row["heading"] <= HEADING_LIMIT for row in rows)

        def centimetres(values, digits):
            return ", ".join(f"{100.0 * value:.{digits}f}" for value in values)
        return Banner(
            CONFIG_NAMES[config], "good" if kept else "bad", "LIMITS KEPT" if kept else "LIMITS EXCEEDED", [
                f"mean position error {centimetres((row['mean'] for row in rows), 2)} cm at odometry noise "
                f"{', '.join(f'{noise:g}' for noise in NOISES)}; limit {100.0 * MEAN_LIMIT[config]:g} cm; "
                f"the report found {centimetres(REPORT_ERRORS.values(), 1)} cm",
                f"{100.0 * max(row['max'] for row in rows):.1f} cm at worst; limit {100.0 * MAX_LIMIT:g} cm",
                f"heading error {max(row['heading'] for row in rows):.2f}° on average, "
                f"{max(row['heading_max'] for row in rows):.1f}° at worst; limit {HEADING_LIMIT:g}° on "
                f"average; the report found ±{REPORT_ANGLE:g}° the majority of the time"])

    def _table(self, section, workshop, map_yaml):
        on_corridor = map_yaml == CORRIDOR  # where the report's figures and the limits belong
        rows = []
        for noise in (*NOISES, STEADY):
            for config in CONFIGS:
                measured = self._measure(workshop, map_yaml, noise, config)
                limits = ((MEAN_LIMIT[config], MAX_LIMIT, HEADING_LIMIT)
                          if on_corridor and noise != STEADY else (None,) * 3)
                row = [STEADY if noise == STEADY else f"σ = {noise:g}", CONFIG_NAMES[config]]
                if on_corridor:
                    row.append("" if noise == STEADY else f"{REPORT_ERRORS[noise]:.3f}")
                rows.append(row + [
                    judged(measured["mean"], limits[0], "{:.4f}"), f"{measured['p95']:.3f}",
                    judged(measured["max"], limits[1], "{:.3f}"),
                    judged(measured["heading"], limits[2], "{:.2f}"), f"{measured['cross']:.4f}",
                    f"{measured['inside']:.1f}", f"{measured['nees']:.2f}"])
        header = ["odometry noise", "constants", "mean (m)", "95 % (m)", "greatest (m)",
                  "heading, mean (deg)", "cross-track, mean (m)", "within 3σ (%)", "NEES"]
        caption = "The race track, whose walls tell less about the way along them."
        if on_corridor:
            header.insert(2, "the report's result (m)")
            caption = (f"The corridor loop. Limits: {MEAN_LIMIT[REPORT]:g} m (the report's "
                       f"constants) and {MEAN_LIMIT[DEFAULT]:g} m (the project's own) for the "
                       f"mean, {MAX_LIMIT:g} m for the greatest, {HEADING_LIMIT:g}° for the heading; "
                       "green: kept, red: not.")
        section.table(header, rows, caption)

    def _trajectory(self, section, workshop):
        """The report's figure 6: the trajectory in the highest noise, over the truth."""
        figure, axes = new_figure(1, 2, height=3.6)
        replays = [self.runs[CORRIDOR, NOISES[-1], config][0] for config in CONFIGS]
        for plan, config, replay in zip(axes[0], CONFIGS, replays):
            run = workshop.run(replay)
            workshop.map(CORRIDOR).draw(plan)
            plan.plot(*run.truth.poses[:, :2].T, color=TRUTH_UNDER, linewidth=4.5)
            plan.plot(*run.trajectory.poses[:, :2].T, color=CONFIG_COLOURS[config], linewidth=1.0)
            frame_on(plan, run.truth.poses[:, :2])
            plan.set_title(f"{CONFIG_NAMES[config]}: mean error {100 * run.errors.position.mean():.1f} cm")
        figure.legend(handles=[
            Line2D([], [], color=TRUTH_UNDER, linewidth=4.5, label="truth"),
            *(Line2D([], [], color=CONFIG_COLOURS[config], label=f"estimate, {CONFIG_NAMES[config]}")
              for config in CONFIGS)], loc="upper center", ncol=3, bbox_to_anchor=(0.5, 1.07))
        section.figure(figure, "fig-6-trajectory",
                       "The trajectory over the truth in the highest odometry noise, σ = "
                       f"{NOISES[-1]:g} (the report's figure 6: 0.266 m).", workshop.commands(*replays))

    def _over_time(self, section, workshop, noise, name, number):
        """The report's figures 7 and 8: distance error and signed angle error over time."""
        figure, axes = new_figure(2, 1, height=5.0, sharex=True)
        distance, angle = axes[:, 0]
        replays = [self.runs[CORRIDOR, noise, config][0] for config in CONFIGS]
        for config, replay in zip(CONFIGS, replays):
            run = workshop.run(replay)
            seconds = run.errors.seconds(run.start)
            style = {"color": CONFIG_COLOURS[config], "linewidth": 0.8, "label": CONFIG_NAMES[config]}
            distance.plot(seconds, run.errors.position, **style)
            angle.plot(seconds, np.degrees(run.errors.heading), **style)
        distance.axhline(0.25, color=BAD, linestyle="--", linewidth=1.0)
        distance.text(0.995, 0.25, "the report: about 0.25 m", color=BAD, ha="right", va="bottom",
                      fontsize=9, transform=distance.get_yaxis_transform())
        distance.set_ylim(0.0, 0.3)
        distance.set_ylabel("distance error (m)")
        for limit in (-REPORT_ANGLE, REPORT_ANGLE):
            angle.axhline(limit, color=BAD, linestyle="--", linewidth=1.0)
        angle.text(0.995, REPORT_ANGLE, "the report: ±5° the majority of the time", color=BAD,
                   ha="right", va="bottom", fontsize=9, transform=angle.get_yaxis_transform())
        angle.axhline(0.0, color="#888888", linewidth=0.7)
        angle.set_ylim(-7.0, 7.0)
        angle.set_ylabel("angle error (deg)\n+ = too far left")
        angle.set_xlabel("time (s)")
        angle.margins(x=0.01)
        figure.legend(*distance.get_legend_handles_labels(), loc="upper center", ncol=2,
                      bbox_to_anchor=(0.5, 1.06))
        inside = []
        for config, replay in zip(CONFIGS, replays):
            heading = np.degrees(np.abs(workshop.run(replay).errors.heading))
            inside.append(f"{100.0 * np.mean(heading <= REPORT_ANGLE):.1f} % of the time within "
                          f"±5°, {heading.max():.1f}° at worst with {CONFIG_NAMES[config]}")
        section.figure(figure, name, "Distance error and signed angle error while following the "
                       f"wall, odometry noise {noise:g} (the report's figure {number}). The angle stays "
                       + "; ".join(inside) + ".", workshop.commands(*replays))

    def _tracks(self, section, workshop):
        """Along the track and across it: what a controller sees."""
        figure, axes = new_figure(2, 2, height=5.4, sharex="col")
        replays = {(map_yaml, config): self.runs[map_yaml, NOISES[-1], config][0]
                   for map_yaml in (CORRIDOR, TRACK) for config in CONFIGS}
        for column, which in enumerate(("cross_track", "along_track")):
            errors = {key: 100.0 * getattr(workshop.run(replay).errors, which)
                      for key, replay in replays.items()}
            reach = max(np.percentile(np.abs(error), 99.5) for error in errors.values())
            for row, (map_yaml, place) in enumerate(((CORRIDOR, "corridor"), (TRACK, "race track"))):
                plot = axes[row, column]
                for config in CONFIGS:
                    error = errors[map_yaml, config]
                    shown = {"bins": np.linspace(-reach, reach, 97), "color": CONFIG_COLOURS[config],
                             "weights": np.full(len(error), 100.0 / len(error))}
                    plot.hist(error, alpha=0.25, **shown)
                    plot.hist(error, histtype="step", linewidth=1.2, label=(
                        f"{CONFIG_NAMES[config]}: σ {error.std():.1f} cm, mean {error.mean():+.1f} cm"),
                        **shown)
                plot.axvline(0.0, color=TRUTH, linewidth=0.7)
                plot.set_title(f"{place}: {which.replace('_', '-')} error", fontsize=10)
                plot.set_ylim(top=plot.get_ylim()[1] * 1.3)
                plot.legend(loc="upper right", fontsize=8)
            axes[1, column].set_xlabel("error (cm); + = " + ("left of the car" if column == 0
                                                            else "ahead of the car"))
        for plot in axes[:, 0]:
            plot.set_ylabel("share of time (%)")
        section.figure(figure, "cross-track", "Error across the car's way, which a steering "
                       f"controller suffers from, and along it; odometry noise {NOISES[-1]:g}.",
                       workshop.commands(*replays.values()))
