"""Ablation: errors with single components of the localizer disabled or replaced."""
import numpy as np

from ..plot_style import COLOURS, TRUTH, new_figure
from .runner import CONFIG_NAMES, DEFAULT, REPORT, seeds_text
from .tracking import CORRIDOR


class Ablation:
    title = "Ablation at racing speed"
    VARIANTS = (  # name, parameter set, changed parameters
        (CONFIG_NAMES[DEFAULT], DEFAULT, ()),
        ("without deskewing", DEFAULT, ("deskew:=false",)),
        ("constant motion noise", DEFAULT, ("motion_model:=constant",)),
        ("differential motion model", DEFAULT, ("motion_model:=differential",)),
        ("beam model", DEFAULT, ("sensor_model:=beam",)),
        ("with noise adaptation", DEFAULT, ("expert/noise_adaptation:=true",)),
        ("without odometry calibration", DEFAULT, ("expert/calibration_distance:=0",)),
        ("without tempering", DEFAULT, ("expert/min_effective_particles:=0",)),
        ("100 beams", DEFAULT, ("num_beams_per_particle:=100",)),
        ("evenly spaced beams", DEFAULT, ("expert/beam_layout:=even",)),
        ("with short-return rejection", DEFAULT, ("distance_filter:=true",)),
        ("resampling after every scan", DEFAULT, ("expert/resample_threshold:=1.0",)),
        ("best particle", DEFAULT, ("expert/estimate:=best",)),
        (CONFIG_NAMES[REPORT], REPORT, ()))

    def plan(self, runner):
        self.drive = runner.drive(
            CORRIDOR, "--duration", 5 if runner.quick else 40, "--speed", 7, "--odom-noise", 0.1,
            "--slip", 0.15, "--dropout", 0.1, "--obstacles", 10, "--seed", 1)
        self.seeds = (1,) if runner.quick else (1, 2, 3)
        self.runs = {name: [runner.replay(self.drive, config, settings=settings, seed=seed)
                            for seed in self.seeds] for name, config, settings in self.VARIANTS}

    def show(self, page, runner):
        names = list(self.runs)
        errors = {name: [100.0 * runner.run(replay).errors.position for replay in runs]
                  for name, runs in self.runs.items()}
        mean = [np.mean([each.mean() for each in errors[name]]) for name in names]
        p99 = [np.mean([np.percentile(each, 99) for each in errors[name]]) for name in names]
        heading = [np.degrees(np.mean([np.abs(runner.run(replay).errors.heading).mean()
                                       for replay in runs])) for runs in self.runs.values()]
        figure, axes = new_figure(1, 1, height=0.6 + 0.5 * len(names))
        plot = axes[0, 0]
        rows = np.arange(len(names))
        plot.barh(rows - 0.2, mean, 0.36, color=COLOURS[0], label="mean")
        plot.barh(rows + 0.2, p99, 0.36, color="#c9d3dd", label="99th percentile")
        for row, name in enumerate(names):
            each = [error.mean() for error in errors[name]]
            plot.plot(each, [row - 0.2] * len(each), ".", color=TRUTH, markersize=4,
                      label="mean of each seed" if row == 0 else None)
            plot.text(max(each), row - 0.2, f"  {mean[row]:.1f}", va="center", fontsize=9)
            plot.text(p99[row], row + 0.2, f" {p99[row]:.1f}", va="center", fontsize=9, color="#5b6675")
        plot.axvline(mean[0], color=COLOURS[0], linestyle=":", linewidth=1.0)
        plot.set_yticks(rows)
        plot.set_yticklabels([f"{name} ({angle:.2f}°)" for name, angle in zip(names, heading)])
        plot.get_yticklabels()[0].set_fontweight("bold")
        plot.set_ylim(len(names) - 0.4, -0.6)
        plot.grid(axis="y", visible=False)
        plot.set_xlabel("position error (cm)")
        plot.legend(loc="lower center", ncol=3, bbox_to_anchor=(0.5, 1.0))
        section = page.section(self.title)
        section.figure(figure, "ablation",
                       "Default parameters (bold, dotted) against one change at a time. Corridor, up to "
                       "7 m/s, sweep time 19 ms, 15 % wheel slip in bursts, 10 % of the odometry messages lost, ten "
                       "unmapped obstacles. In parentheses: mean heading error. Mean over the filter's "
                       f"{seeds_text(self.seeds)}.",
                       runner.commands(*(runs[0] for runs in self.runs.values())))
