"""What costs how much, and what makes how much of a difference."""
import numpy as np
import yaml
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from .. import EvaluationError
from ..programs import ROOT
from ..style import BAD, COLOURS, TRUTH, colour, new_figure
from .drives import CONFIG_COLOURS, CONFIGS, CORRIDOR, loop
from .workshop import CONFIG_NAMES, DEFAULT, REPORT, seeds_text

SCAN_PERIOD = 25.0  # ms, of the simulated lidar


def constant(config, name):
    """What a set of constants has; what it does not name keeps its default."""
    for each in (config, DEFAULT):
        values = yaml.safe_load((ROOT / f"config/{each}.yaml").read_text(encoding="utf-8"))
        if name in values:
            return float(values[name])
    raise EvaluationError(f"config/{DEFAULT}.yaml: names no {name}")


def plain_ticks(axis, values):
    """A logarithmic axis with ticks at these values, written as people write them."""
    axis.set_major_locator(FixedLocator(values))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


class UpdateTime:
    title = "Update time"
    MODELS = tuple((f"beam model, {caster}", ("sensor_model:=beam", f"range_method:={caster}"))
                   for caster in ("bresenham", "distance_transform", "simd", "panorama")) + (
                       ("likelihood field", ("sensor_model:=likelihood_field",)),)
    PARTICLES = (50, 100, 200, 500, 1000, 2000, 5000)
    BEAMS = (10, 25, 50, 100, 200, 500)

    def plan(self, workshop):
        self.drive = loop(workshop, CORRIDOR, 0.1, duration=1 if workshop.quick else 2)
        step = 3 if workshop.quick else 1
        self.particles, self.beams = self.PARTICLES[::step], self.BEAMS[::step]
        self.runs = {}
        for name, settings in self.MODELS:
            for count in self.particles:
                self.runs[name, count, 100] = self._plan(workshop, settings, count, 100)
            for count in self.beams:
                self.runs[name, 200, count] = self._plan(workshop, settings, 200, count)

    def _plan(self, workshop, settings, particles, beams):
        return workshop.replay(self.drive, DEFAULT, timed=True, settings=settings + (
            f"num_particles:={particles}", f"num_beams_per_particle:={beams}"))

    def show(self, page, workshop):
        figure, axes = new_figure(1, 2, height=4.2, sharey=True)
        for index, (name, _) in enumerate(self.MODELS):
            for plot, counts, key in ((axes[0, 0], self.particles, lambda n: (name, n, 100)),
                                      (axes[0, 1], self.beams, lambda n: (name, 200, n))):
                times = [workshop.run(self.runs[key(count)]).summary["update_ms"]["p50"]
                         for count in counts]
                plot.loglog(counts, times, marker="o", markersize=4, color=colour(index), label=name)
        for plot, label, counts in ((axes[0, 0], "particles (100 beams)", self.particles),
                                    (axes[0, 1], "beams (200 particles)", self.beams)):
            plot.axhline(SCAN_PERIOD, color=BAD, linestyle="--", linewidth=1.0)
            plot.text(0.02, SCAN_PERIOD, f"a scan comes every {SCAN_PERIOD:g} ms", color=BAD, va="bottom",
                      fontsize=9, transform=plot.get_yaxis_transform())
            plain_ticks(plot.xaxis, counts)
            plot.set_xlabel(label)
        low, high = axes[0, 0].get_ylim()
        plain_ticks(axes[0, 0].yaxis, [tick for tick in (0.01, 0.1, 1, 10, 100, 1000) if low <= tick <= high])
        axes[0, 0].set_ylabel("median time of an update (ms)")
        figure.legend(*axes[0, 1].get_legend_handles_labels(), loc="upper center", ncol=3,
                      bbox_to_anchor=(0.5, 1.14))
        section = page.section(self.title)
        section.text(f"What lies below the red line keeps up with a lidar of {1000.0 / SCAN_PERIOD:g} Hz on "
                     "one core.")
        section.figure(figure, "update-time", "Median time of an update on one core of the machine "
                       "that made this page, against particles and beams.",
                       workshop.commands(self.drive, *(self.runs[name, 200, 100] for name, _ in self.MODELS)))


class ErrorAgainst:
    title = "Error against the filter's size and constants"
    # name, axis, sets of constants, values
    SWEEPS = (
        ("num_particles", "particles", CONFIGS, (25, 50, 100, 200, 500, 1000)),
        ("num_beams_per_particle", "beams", CONFIGS, (10, 25, 50, 100, 240, 480)),
        ("squash_factor", "squash_factor (beam model)", (REPORT,), (1.0, 2.2, 4.0, 8.0, 16.0)),
        ("field_squash", "field_squash (likelihood field)", (DEFAULT,), (1.0, 2.5, 6.5, 12.0, 25.0)),
        ("sigma_hit", "sigma_hit (pixels, beam model)", (REPORT,), (1.0, 2.0, 4.0, 8.0, 16.0)),
        ("field_sigma", "field_sigma (m, likelihood field)", (DEFAULT,), (0.01, 0.02, 0.045, 0.1, 0.2)))

    def plan(self, workshop):
        self.drive = loop(workshop, CORRIDOR, 0.1, duration=4 if workshop.quick else 30)
        self.seeds = (1,) if workshop.quick else (1, 2, 3)
        self.runs = {}
        for name, _, configs, values in self.SWEEPS:
            for config in configs:
                for value in values[::2] if workshop.quick else values:
                    self.runs[name, config, value] = [
                        workshop.replay(self.drive, config, settings=(f"{name}:={value:g}",), seed=seed)
                        for seed in self.seeds]

    def show(self, page, workshop):
        figure, axes = new_figure(2, 3, height=6.4, sharey=True)
        for plot, (name, label, configs, values) in zip(axes.flat, self.SWEEPS):
            for config in configs:
                taken = [value for value in values if (name, config, value) in self.runs]
                errors = 100.0 * np.array([[workshop.run(replay).errors.position.mean()
                                            for replay in self.runs[name, config, value]]
                                           for value in taken])
                plot.loglog(taken, errors.mean(axis=1), color=CONFIG_COLOURS[config], marker="o",
                            markersize=4, label=CONFIG_NAMES[config])
                plot.fill_between(taken, errors.min(axis=1), errors.max(axis=1), linewidth=0, alpha=0.2,
                                  color=CONFIG_COLOURS[config])
                plot.axvline(constant(config, name), color="#888888", linestyle=":", linewidth=1.0, zorder=0)
            plot.set_xlabel(label)
            plain_ticks(plot.xaxis, taken)
        for plot in axes[:, 0]:
            plot.set_ylabel("mean position error (cm)")
        low, high = axes[0, 0].get_ylim()
        plain_ticks(axes[0, 0].yaxis, [tick for tick in (0.5, 1, 2, 3, 5, 10, 20, 50, 100)
                                       if low <= tick <= high])
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="upper center", ncol=2,
                      bbox_to_anchor=(0.5, 1.05))
        section = page.section(self.title)
        section.figure(figure, "error-against", "Mean position error against one parameter at a "
                       "time; the others as in the set of constants, whose own value is dotted. "
                       f"Line: mean over the filter's {seeds_text(self.seeds)}; band: least and "
                       "greatest of them. Odometry noise 0.1, corridor.",
                       workshop.commands(self.drive, *(self._nearest(name, config) for name, _, configs, _
                                                       in self.SWEEPS for config in configs)))

    def _nearest(self, name, config):
        """The replay whose value is nearest to the set's own."""
        values = [value for other, owner, value in self.runs if (other, owner) == (name, config)]
        own = constant(config, name)
        return self.runs[name, config, min(values, key=lambda value: abs(value - own))][0]


class WhatItBuys:
    title = "What each part buys at racing speed"
    VARIANTS = (
        ("the project's own", DEFAULT, ()),
        ("without deskewing", DEFAULT, ("deskew:=false",)),
        ("noise: constant", DEFAULT, ("motion_model:=constant",)),
        ("noise: differential", DEFAULT, ("motion_model:=differential",)),
        ("beam model", DEFAULT, ("sensor_model:=beam",)),
        ("noise that does not adapt", DEFAULT, ("noise_adaptation:=false",)),
        ("odometry not calibrated", DEFAULT, ("calibration_distance:=0",)),
        ("each scan at once", DEFAULT, ("min_effective_particles:=0",)),
        ("100 beams", DEFAULT, ("num_beams_per_particle:=100",)),
        ("beams even", DEFAULT, ("beam_layout:=even",)),
        ("short returns left out", DEFAULT, ("reject_short_returns:=true",)),
        ("resampling at every scan", DEFAULT, ("resample_threshold:=1.0",)),
        ("best particle", DEFAULT, ("estimate:=best",)),
        ("the report's constants", REPORT, ()))

    def plan(self, workshop):
        self.drive = workshop.drive(
            CORRIDOR, "--duration", 5 if workshop.quick else 40, "--speed", 7, "--odom-noise", 0.1,
            "--slip", 0.15, "--dropout", 0.1, "--obstacles", 10, "--seed", 1)
        self.seeds = (1,) if workshop.quick else (1, 2, 3)
        self.runs = {name: [workshop.replay(self.drive, config, settings=settings, seed=seed)
                            for seed in self.seeds] for name, config, settings in self.VARIANTS}

    def show(self, page, workshop):
        names = list(self.runs)
        errors = {name: [100.0 * workshop.run(replay).errors.position for replay in runs]
                  for name, runs in self.runs.items()}
        mean = [np.mean([each.mean() for each in errors[name]]) for name in names]
        p99 = [np.mean([np.percentile(each, 99) for each in errors[name]]) for name in names]
        heading = [np.degrees(np.mean([np.abs(workshop.run(replay).errors.heading).mean()
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
        section.figure(figure, "what-it-buys", "Up to 7 m/s along the corridor, a sweep that takes "
                       "19 ms, wheels that slip by 15 % in bursts, a tenth of the odometry lost, "
                       "ten unmapped obstacles: the project's own constants (bold, dotted), and "
                       f"one thing changed at a time; in brackets the mean heading error. Mean over the "
                       f"filter's {seeds_text(self.seeds)}.",
                       workshop.commands(*(runs[0] for runs in self.runs.values())))
