"""Pose tracking with increasing odometry noise: section 3.1 of the course report, figures 6 to 8."""
import numpy as np
import yaml
from matplotlib.lines import Line2D

from .. import consistency
from ..html_report import Banner, Cell
from ..programs import ROOT
from ..plot_style import BAD, COLOURS, TRUTH, TRUTH_UNDER, frame_on, new_figure
from .runner import CONFIG_NAMES, DEFAULT, REPORT, seeds_text

CORRIDOR = ROOT / "maps/corridor.yaml"
TRACK = ROOT / "maps/track.yaml"
NOISES = (0.0, 0.05, 0.1)
SYSTEMATIC = f"σ = {NOISES[-1]:g}, systematic errors"
# Results of the report's section 3.1.
REPORT_ERRORS = dict(zip(NOISES, (0.262, 0.270, 0.266)))  # m
REPORT_ANGLE = 5.0  # degrees, "the majority of the time"
CONFIGS = (REPORT, DEFAULT)
CONFIG_COLOURS = {REPORT: COLOURS[1], DEFAULT: COLOURS[0]}
# Limits on the mean position error by parameter set, on the mean heading error and on the max position error.
MEAN_LIMIT = {REPORT: 0.025, DEFAULT: 0.015}  # m
HEADING_LIMIT = 0.5  # degrees
MAX_LIMIT = 0.10  # m


def beside(map_yaml, suffix):
    return map_yaml.with_name(map_yaml.stem + suffix)


def start_pose(map_yaml):
    """The pose [x, y, yaw] at which simulate_bag starts on this map."""
    return yaml.safe_load(beside(map_yaml, "_start.yaml").read_text(encoding="utf-8"))["start"]


def loop(runner, map_yaml, noise, duration=None, systematic=True):
    """The standard drive: wall follower, 3 m/s; `systematic`: scale errors of +2 % in speed and +3 % in turn
    rate."""
    seconds = duration or (6 if runner.quick else 60)
    return runner.drive(map_yaml, "--duration", seconds, "--speed", 3, "--odom-noise", noise,
                        "--speed-scale-error", 0.02 if systematic else 0,
                        "--turn-scale-error", 0.03 if systematic else 0, "--seed", 1)


def limit_cell(value, limit, text):
    """A Cell, marked good or bad if there is a limit."""
    level = "" if limit is None else "good" if value <= limit else "bad"
    return Cell(text.format(value), level)


class OdometryNoise:
    title = "Pose tracking with increasing odometry noise"

    def plan(self, runner):
        self.seeds = (1,) if runner.quick else (1, 2, 3)
        self.runs = {
            (map_yaml, noise, config): [
                runner.replay(loop(runner, map_yaml, NOISES[-1] if noise == SYSTEMATIC else noise,
                                   systematic=noise == SYSTEMATIC), config, seed=seed)
                for seed in self.seeds]
            for map_yaml in (CORRIDOR, TRACK) for noise in (*NOISES, SYSTEMATIC) for config in CONFIGS}

    def show(self, page, runner):
        section = page.section(self.title)
        section.text(
            "The car follows the left wall at 3 m/s. Each twist component of the odometry (m/s, m/s, rad/s; 50 Hz) "
            "has Gaussian noise with standard deviation σ, as in the report. The last rows add systematic scale "
            "errors of 2 % in speed and 3 % in turn rate. The estimate is compared with the true pose at 100 Hz, "
            f"without alignment. Values are means over the filter's {seeds_text(self.seeds)}; max is over all. "
            "Within 3σ: updates with an error within the estimated 3σ bounds. NEES: normalised estimation error "
            "squared, mean 3 if the covariance is correct, higher if it is overconfident.")
        page.banners += [self._banner(runner, config) for config in CONFIGS]
        for map_yaml in (CORRIDOR, TRACK):
            self._table(section, runner, map_yaml)
        self._trajectory(section, runner)
        self._over_time(section, runner, 0.0, "fig-7-no-noise", "7")
        self._over_time(section, runner, 0.1, "fig-8-noise", "8")
        self._tracks(section, runner)

    def _measure(self, runner, map_yaml, noise, config):
        """The values of one table row."""
        runs = [runner.run(replay) for replay in self.runs[map_yaml, noise, config]]
        consistencies = [consistency.measure(run, 0.5) for run in runs]
        error = [run.errors.summary()["position_error_m"] for run in runs]
        heading = [run.errors.summary()["heading_error_deg"] for run in runs]
        return {"mean": np.mean([each["mean"] for each in error]),
                "p95": np.mean([each["p95"] for each in error]),
                "max": max(each["max"] for each in error),
                "heading": np.mean([each["mean"] for each in heading]),
                "heading_max": max(each["max"] for each in heading),
                "cross": np.mean([np.abs(run.errors.cross_track).mean() for run in runs]),
                "within_3_sigma": 100.0 * np.mean([each.fraction_within for each in consistencies]),
                "nees": np.mean([each.mean_nees for each in consistencies])}

    def _banner(self, runner, config):
        """Summary of the three noise levels against the limits and the report."""
        rows = [self._measure(runner, CORRIDOR, noise, config) for noise in NOISES]
        passed = all(row["mean"] <= MEAN_LIMIT[config] and row["max"] <= MAX_LIMIT and
                     row["heading"] <= HEADING_LIMIT for row in rows)

        def centimetres(values, digits):
            return ", ".join(f"{100.0 * value:.{digits}f}" for value in values)
        return Banner(
            CONFIG_NAMES[config], "good" if passed else "bad", "PASS" if passed else "FAIL", [
                f"mean position error {centimetres((row['mean'] for row in rows), 2)} cm at odometry noise "
                f"{', '.join(f'{noise:g}' for noise in NOISES)}; limit {100.0 * MEAN_LIMIT[config]:g} cm; "
                f"report: {centimetres(REPORT_ERRORS.values(), 1)} cm",
                f"max position error {100.0 * max(row['max'] for row in rows):.1f} cm; limit {100.0 * MAX_LIMIT:g} cm",
                f"heading error: mean {max(row['heading'] for row in rows):.2f}°, "
                f"max {max(row['heading_max'] for row in rows):.1f}°; limit of the mean {HEADING_LIMIT:g}°; "
                f"report: ±{REPORT_ANGLE:g}° the majority of the time"])

    def _table(self, section, runner, map_yaml):
        on_corridor = map_yaml == CORRIDOR  # the map of the limits and of the report's results
        rows = []
        for noise in (*NOISES, SYSTEMATIC):
            for config in CONFIGS:
                measured = self._measure(runner, map_yaml, noise, config)
                limits = ((MEAN_LIMIT[config], MAX_LIMIT, HEADING_LIMIT)
                          if on_corridor and noise != SYSTEMATIC else (None,) * 3)
                row = [SYSTEMATIC if noise == SYSTEMATIC else f"σ = {noise:g}", CONFIG_NAMES[config]]
                if on_corridor:
                    row.append("" if noise == SYSTEMATIC else f"{REPORT_ERRORS[noise]:.3f}")
                rows.append(row + [
                    limit_cell(measured["mean"], limits[0], "{:.4f}"), f"{measured['p95']:.3f}",
                    limit_cell(measured["max"], limits[1], "{:.3f}"),
                    limit_cell(measured["heading"], limits[2], "{:.2f}"), f"{measured['cross']:.4f}",
                    f"{measured['within_3_sigma']:.1f}", f"{measured['nees']:.2f}"])
        header = ["odometry noise", "parameters", "mean (m)", "p95 (m)", "max (m)",
                  "heading, mean (deg)", "cross-track, mean (m)", "within 3σ (%)", "NEES"]
        caption = "Race track: its walls constrain the position along the track less."
        if on_corridor:
            header.insert(2, "report (m)")
            caption = (f"Corridor loop. Limits: mean {MEAN_LIMIT[REPORT]:g} m ({CONFIG_NAMES[REPORT]}) and "
                       f"{MEAN_LIMIT[DEFAULT]:g} m ({CONFIG_NAMES[DEFAULT]}), max {MAX_LIMIT:g} m, mean heading "
                       f"error {HEADING_LIMIT:g}°; green: pass, red: fail.")
        section.table(header, rows, caption)

    def _trajectory(self, section, runner):
        """Figure 6 of the report: trajectory at the highest noise, over the ground truth."""
        figure, axes = new_figure(1, 2, height=3.6)
        replays = [self.runs[CORRIDOR, NOISES[-1], config][0] for config in CONFIGS]
        for plan, config, replay in zip(axes[0], CONFIGS, replays):
            run = runner.run(replay)
            runner.map(CORRIDOR).draw(plan)
            plan.plot(*run.truth.poses[:, :2].T, color=TRUTH_UNDER, linewidth=4.5)
            plan.plot(*run.trajectory.poses[:, :2].T, color=CONFIG_COLOURS[config], linewidth=1.0)
            frame_on(plan, run.truth.poses[:, :2])
            plan.set_title(f"{CONFIG_NAMES[config]}: mean error {100 * run.errors.position.mean():.1f} cm")
        figure.legend(handles=[
            Line2D([], [], color=TRUTH_UNDER, linewidth=4.5, label="truth"),
            *(Line2D([], [], color=CONFIG_COLOURS[config], label=f"estimate, {CONFIG_NAMES[config]}")
              for config in CONFIGS)], loc="upper center", ncol=3, bbox_to_anchor=(0.5, 1.07))
        section.figure(figure, "fig-6-trajectory",
                       "Trajectory over the ground truth at the highest odometry noise, σ = "
                       f"{NOISES[-1]:g} (figure 6 of the report: 0.266 m).", runner.commands(*replays))

    def _over_time(self, section, runner, noise, name, number):
        """Figures 7 and 8 of the report: distance error and signed angle error over time."""
        figure, axes = new_figure(2, 1, height=5.0, sharex=True)
        distance, angle = axes[:, 0]
        replays = [self.runs[CORRIDOR, noise, config][0] for config in CONFIGS]
        for config, replay in zip(CONFIGS, replays):
            run = runner.run(replay)
            seconds = run.errors.seconds(run.start)
            style = {"color": CONFIG_COLOURS[config], "linewidth": 0.8, "label": CONFIG_NAMES[config]}
            distance.plot(seconds, run.errors.position, **style)
            angle.plot(seconds, np.degrees(run.errors.heading), **style)
        distance.axhline(0.25, color=BAD, linestyle="--", linewidth=1.0)
        distance.text(0.995, 0.25, "report: about 0.25 m", color=BAD, ha="right", va="bottom",
                      fontsize=9, transform=distance.get_yaxis_transform())
        distance.set_ylim(0.0, 0.3)
        distance.set_ylabel("distance error (m)")
        for limit in (-REPORT_ANGLE, REPORT_ANGLE):
            angle.axhline(limit, color=BAD, linestyle="--", linewidth=1.0)
        angle.text(0.995, REPORT_ANGLE, "report: ±5° the majority of the time", color=BAD,
                   ha="right", va="bottom", fontsize=9, transform=angle.get_yaxis_transform())
        angle.axhline(0.0, color="#888888", linewidth=0.7)
        angle.set_ylim(-7.0, 7.0)
        angle.set_ylabel("angle error (deg)\n+ = left")
        angle.set_xlabel("time (s)")
        angle.margins(x=0.01)
        figure.legend(*distance.get_legend_handles_labels(), loc="upper center", ncol=2,
                      bbox_to_anchor=(0.5, 1.06))
        ranges = []
        for config, replay in zip(CONFIGS, replays):
            heading = np.degrees(np.abs(runner.run(replay).errors.heading))
            ranges.append(f"{CONFIG_NAMES[config]}: within ±5° for "
                          f"{100.0 * np.mean(heading <= REPORT_ANGLE):.1f} % of the time, max {heading.max():.1f}°")
        section.figure(figure, name, "Distance error and signed angle error during wall following, odometry noise "
                       f"{noise:g} (figure {number} of the report). Angle error: " + "; ".join(ranges) + ".",
                       runner.commands(*replays))

    def _tracks(self, section, runner):
        """Along-track and cross-track errors."""
        figure, axes = new_figure(2, 2, height=5.4, sharex="col")
        replays = {(map_yaml, config): self.runs[map_yaml, NOISES[-1], config][0]
                   for map_yaml in (CORRIDOR, TRACK) for config in CONFIGS}
        for column, which in enumerate(("cross_track", "along_track")):
            errors = {key: 100.0 * getattr(runner.run(replay).errors, which)
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
            plot.set_ylabel("time (%)")
        section.figure(figure, "cross-track",
                       "Cross-track error, which affects a steering controller, and along-track error; "
                       f"odometry noise {NOISES[-1]:g}.",
                       runner.commands(*replays.values()))
