"""Update time, and position error against single parameters."""
import numpy as np
import yaml
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from .. import EvaluationError
from ..programs import ROOT
from ..plot_style import BAD, colour, new_figure
from .tracking import CONFIG_COLOURS, CONFIGS, CORRIDOR, loop
from .runner import CONFIG_NAMES, DEFAULT, REPORT, seeds_text

SCAN_PERIOD = 25.0  # ms, of the simulated lidar


def parameter_value(config, name):
    """The value of a parameter in a parameter set; default.yaml applies if the set has none."""
    for each in (config, DEFAULT):
        values = yaml.safe_load((ROOT / f"config/{each}.yaml").read_text(encoding="utf-8"))
        if name in values:
            return float(values[name])
    raise EvaluationError(f"config/{DEFAULT}.yaml: has no {name}")


def plain_ticks(axis, values):
    """Sets ticks at these values, in decimal notation, on a logarithmic axis."""
    axis.set_major_locator(FixedLocator(values))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


class UpdateTime:
    title = "Update time"
    MODELS = tuple((f"beam model, {caster}", ("sensor_model:=beam", f"range_method:={caster}"))
                   for caster in ("bresenham", "distance_transform", "simd", "lut")) + (
                       ("likelihood field", ("sensor_model:=likelihood_field",)),)
    PARTICLES = (50, 100, 200, 500, 1000, 2000, 5000)
    BEAMS = (10, 25, 50, 100, 200, 500)

    def plan(self, runner):
        self.drive = loop(runner, CORRIDOR, 0.1, duration=1 if runner.quick else 2)
        step = 3 if runner.quick else 1
        self.particles, self.beams = self.PARTICLES[::step], self.BEAMS[::step]
        self.runs = {}
        for name, settings in self.MODELS:
            for count in self.particles:
                self.runs[name, count, 100] = self._plan(runner, settings, count, 100)
            for count in self.beams:
                self.runs[name, 200, count] = self._plan(runner, settings, 200, count)

    def _plan(self, runner, settings, particles, beams):
        return runner.replay(self.drive, DEFAULT, timed=True, settings=settings + (
            f"num_particles:={particles}", f"num_beams_per_particle:={beams}"))

    def show(self, page, runner):
        figure, axes = new_figure(1, 2, height=4.2, sharey=True)
        for index, (name, _) in enumerate(self.MODELS):
            for plot, counts, key in ((axes[0, 0], self.particles, lambda n: (name, n, 100)),
                                      (axes[0, 1], self.beams, lambda n: (name, 200, n))):
                times = [runner.run(self.runs[key(count)]).summary["update_ms"]["p50"]
                         for count in counts]
                plot.loglog(counts, times, marker="o", markersize=4, color=colour(index), label=name)
        for plot, label, counts in ((axes[0, 0], "particles (100 beams)", self.particles),
                                    (axes[0, 1], "beams (200 particles)", self.beams)):
            plot.axhline(SCAN_PERIOD, color=BAD, linestyle="--", linewidth=1.0)
            plot.text(0.02, SCAN_PERIOD, f"scan period {SCAN_PERIOD:g} ms", color=BAD, va="bottom",
                      fontsize=9, transform=plot.get_yaxis_transform())
            plain_ticks(plot.xaxis, counts)
            plot.set_xlabel(label)
        low, high = axes[0, 0].get_ylim()
        plain_ticks(axes[0, 0].yaxis, [tick for tick in (0.01, 0.1, 1, 10, 100, 1000) if low <= tick <= high])
        axes[0, 0].set_ylabel("median update time (ms)")
        figure.legend(*axes[0, 1].get_legend_handles_labels(), loc="upper center", ncol=3,
                      bbox_to_anchor=(0.5, 1.14))
        section = page.section(self.title)
        section.text(f"Below the red line the localizer keeps up with a {1000.0 / SCAN_PERIOD:g} Hz lidar on one core.")
        section.figure(figure, "update-time", "Median update time on one core of the machine that generated this page, "
                       "against particles and beams.",
                       runner.commands(self.drive, *(self.runs[name, 200, 100] for name, _ in self.MODELS)))


class ParameterSweep:
    title = "Error against parameters"
    # parameter, axis label, parameter sets, values
    SWEEPS = (
        ("num_particles", "particles", CONFIGS, (25, 50, 100, 200, 500, 1000)),
        ("num_beams_per_particle", "beams", CONFIGS, (10, 25, 50, 100, 240, 480)),
        ("effective_beams", "effective beams", CONFIGS, (5, 10, 20, 40, 80, 160)),
        ("sigma_hit", "sigma_hit (pixels, beam model)", (REPORT,), (1.0, 2.0, 4.0, 8.0, 16.0)),
        ("field_scale", "field_scale (m, likelihood field)", (DEFAULT,), (0.01, 0.02, 0.045, 0.1, 0.2)))

    def plan(self, runner):
        self.drive = loop(runner, CORRIDOR, 0.1, duration=4 if runner.quick else 30)
        self.seeds = (1,) if runner.quick else (1, 2, 3)
        self.runs = {}
        for name, _, configs, values in self.SWEEPS:
            for config in configs:
                for value in values[::2] if runner.quick else values:
                    self.runs[name, config, value] = [
                        runner.replay(self.drive, config, settings=(f"{name}:={value:g}",), seed=seed)
                        for seed in self.seeds]

    def show(self, page, runner):
        figure, axes = new_figure(2, 3, height=6.4, sharey=True)
        for plot in axes.flat[len(self.SWEEPS):]:
            plot.set_visible(False)
        for plot, (name, label, configs, values) in zip(axes.flat, self.SWEEPS):
            for config in configs:
                swept = [value for value in values if (name, config, value) in self.runs]
                errors = 100.0 * np.array([[runner.run(replay).errors.position.mean()
                                            for replay in self.runs[name, config, value]]
                                           for value in swept])
                plot.loglog(swept, errors.mean(axis=1), color=CONFIG_COLOURS[config], marker="o",
                            markersize=4, label=CONFIG_NAMES[config])
                plot.fill_between(swept, errors.min(axis=1), errors.max(axis=1), linewidth=0, alpha=0.2,
                                  color=CONFIG_COLOURS[config])
                plot.axvline(parameter_value(config, name), color="#888888", linestyle=":", linewidth=1.0, zorder=0)
            plot.set_xlabel(label)
            plain_ticks(plot.xaxis, swept)
        for plot in axes[:, 0]:
            plot.set_ylabel("mean position error (cm)")
        low, high = axes[0, 0].get_ylim()
        plain_ticks(axes[0, 0].yaxis, [tick for tick in (0.5, 1, 2, 3, 5, 10, 20, 50, 100)
                                       if low <= tick <= high])
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="upper center", ncol=2,
                      bbox_to_anchor=(0.5, 1.05))
        section = page.section(self.title)
        section.figure(figure, "parameter-sweep",
                       "Mean position error against one parameter at a time; dotted: its value in the "
                       f"parameter set. Line: mean over the filter's {seeds_text(self.seeds)}; band: min and max. "
                       "Odometry noise 0.1, corridor.",
                       runner.commands(self.drive, *(self._nearest(name, config) for name, _, configs, _
                                                     in self.SWEEPS for config in configs)))

    def _nearest(self, name, config):
        """The replay with the value nearest to that of the parameter set."""
        values = [value for other, owner, value in self.runs if (other, owner) == (name, config)]
        configured = parameter_value(config, name)
        return self.runs[name, config, min(values, key=lambda value: abs(value - configured))][0]
