"""Figures of the filter, its status and its protection level over time. Each function returns a matplotlib figure."""
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.patches import Patch

from . import protection
from .columns import INLIER_RATIO, STATUS
from .plot_style import (BAD, COLOURS, GOOD, STATUS_COLOURS, TRUTH, TRUTH_UNDER, WARNING, colour, new_figure,
                         run_legend, time_axis)
from .trajectory import spans

# Classes of beams: columns of updates.csv and their colours.
_BEAM_CLASSES = {INLIER_RATIO: GOOD, "obstructed": "#56b4e9", "contradicted": BAD, "unmapped": "#c3c8cf"}
# Stanford diagrams: limits of errors and levels, m and degrees.
_STANFORD_LIMITS = ((1e-3, 20.0), (1e-3, 20.0), (1e-2, 180.0))


def filter_over_time(runs):
    """Update time, effective sample size and number of particles of the runs that have them."""
    runs = [run for run in runs if run.updates.column("update_ms") is not None]
    figure, axes = new_figure(3, 1, height=7.0, sharex=True)
    for index, run in enumerate(runs):
        seconds = (run.updates.stamps - run.start) * 1e-9
        particles = run.updates.column("particles")
        weighted = particles > 0
        style = {"color": colour(index), "linewidth": 0.7, "label": run.name}
        axes[0, 0].semilogy(seconds, np.maximum(run.updates.column("update_ms"), 1e-3), **style)
        fraction = run.updates.column("effective_sample_size")[weighted] / particles[weighted]
        axes[1, 0].plot(seconds[weighted], 100.0 * fraction, **style)
        axes[2, 0].semilogy(seconds[weighted], particles[weighted], **style)
    axes[0, 0].set_ylabel("update (ms)")
    axes[1, 0].set_ylabel("effective sample size\n(% of particles)")
    axes[1, 0].set_ylim(0.0, 102.0)
    axes[2, 0].set_ylabel("particles")
    time_axis(axes[2, 0])
    run_legend(figure, axes[0, 0], runs, 1.05)
    return figure


def _bars(axes, row, run, intervals, bar_colour):
    """Draws intervals as bars with a minimal width."""
    width = 0.003 * (run.trajectory.stamps[-1] - run.start) * 1e-9
    bars = [((first - run.start) * 1e-9, max((last - first) * 1e-9, width))
            for first, last in intervals]
    axes.broken_barh(bars, (row - 0.4, 0.8), color=bar_colour, linewidth=0)


def timeline(runs, rows):
    """Intervals over time. `rows`: (run index, label, [(intervals, colour)])."""
    figure, axes = new_figure(1, 1, height=0.9 + 0.42 * len(rows))
    plan = axes[0, 0]
    for row, (index, _, bars) in enumerate(rows):
        for intervals, bar_colour in bars:
            _bars(plan, row, runs[index], intervals, bar_colour)
    plan.set_yticks(range(len(rows)))
    plan.set_yticklabels([label for _, label, _ in rows])
    plan.set_ylim(len(rows) - 0.4, -0.6)
    plan.grid(False)
    time_axis(plan)
    figure.legend(handles=[Patch(color=shade, label=name) for name, shade in
                           [*STATUS_COLOURS.items(), ("update rejected", "#000000")]],
                  loc="upper center", ncol=5, bbox_to_anchor=(0.5, 1.18))
    return figure


def _status_band(axes, seconds, status):
    """The status as colours, each until the next update."""
    until = np.append(seconds[1:], seconds[-1])
    for state, shade in STATUS_COLOURS.items():
        bars = [(seconds[first], until[last] - seconds[first])
                for first, last in spans(np.arange(len(status)), status == state)]
        axes.broken_barh(bars, (0.0, 1.0), color=shade, linewidth=0)
    axes.set(ylim=(0.0, 1.0), yticks=[])
    axes.set_ylabel("status", rotation=0, ha="right", va="center")
    axes.grid(False)
    axes.legend(handles=[Patch(color=shade, label=state) for state, shade in STATUS_COLOURS.items()],
                loc="lower left", bbox_to_anchor=(0.0, 1.0), ncol=4, frameon=False)


def _beam_classes(axes, seconds, updates):
    """Fractions of the beam classes over time. Results of older versions lack some of the columns."""
    fractions = {name: updates.column(name) for name in _BEAM_CLASSES if updates.column(name) is not None}
    axes.stackplot(seconds, [100.0 * fraction for fraction in fractions.values()], labels=list(fractions),
                   colors=[_BEAM_CLASSES[name] for name in fractions], alpha=0.65, linewidth=0)
    conflict = updates.column("conflict")
    if conflict is not None:
        axes.plot(seconds, 100.0 * conflict, color=TRUTH, linewidth=1.0, label="conflict")
    axes.set_ylim(0.0, 100.5)
    axes.set_ylabel("beams (%)")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncol=5, frameon=False)


def status_over_time(run, protected):
    """Error (with a truth) and protection level, the status, and the beam classes (if the run has them)."""
    seconds = (run.updates.stamps - run.start) * 1e-9
    heights = ([3.0] if run.errors is not None else []) + [0.3]
    heights += [2.0] if run.updates.column(INLIER_RATIO) is not None else []
    figure, axes = new_figure(len(heights), 1, height=1.0 + 1.1 * sum(heights), sharex=True,
                              gridspec_kw={"height_ratios": heights})
    axes = list(axes[:, 0])
    if run.errors is not None:
        position = axes.pop(0)
        position.semilogy(run.errors.seconds(run.start), np.maximum(run.errors.position, 1e-3),
                          color=COLOURS[0], linewidth=1.0, label="error")
        if protected is not None:
            position.plot((protected.stamps - run.start) * 1e-9, np.hypot(*protected.levels[:, :2].T),
                          color=WARNING, linewidth=1.0, label="protection level, position")
        position.set_ylabel("position (m)")
        position.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncol=2, frameon=False)
    _status_band(axes[0], seconds, run.updates.column(STATUS))
    if len(axes) > 1:
        _beam_classes(axes[1], seconds, run.updates)
    time_axis(axes[-1])
    figure.suptitle(run.name, fontsize=11, fontweight="bold")
    return figure


def stanford(run, protected):
    """Stanford diagrams: two-dimensional histograms of error and level, one per axis."""
    figure, axes = new_figure(1, 3, height=4.0)
    norm = LogNorm(1.0, max(10.0, len(protected.stamps)))
    for axis, (plan, name) in enumerate(zip(axes[0], protection.AXES)):
        low, high = _STANFORD_LIMITS[axis]
        unit, scale = ("deg", 180.0 / np.pi) if name == "heading" else ("m", 1.0)
        error, level = (np.clip(scale * values[:, axis], low, high)
                        for values in (protected.errors, protected.levels))
        bins = np.geomspace(low, high, 46)
        shown = plan.hist2d(error, level, bins=[bins, bins], cmap="viridis", norm=norm, cmin=1,
                            zorder=3)[3]
        plan.fill_between((low, high), (low, high), low, color=BAD, alpha=0.12, linewidth=0)
        plan.plot((low, high), (low, high), color=BAD, linewidth=1.0, zorder=2)
        fractions = protected.regions(axis)
        _region_name(plan, 0.97, 0.03, "misleading", fractions, BAD, "bottom")
        _region_name(plan, 0.03, 0.27, "nominal", fractions, GOOD, "bottom")
        limit = scale * protection.alarm_limit(axis)
        if limit < high:
            above = np.array((low, limit, high))
            plan.fill_between(above, np.maximum(above, limit), high, color=TRUTH_UNDER, alpha=0.35,
                              linewidth=0)
            plan.axhline(limit, color=TRUTH, linestyle="--", linewidth=1.0, zorder=2)
            _region_name(plan, 0.03, 0.97, "unavailable", fractions, TRUTH, "top")
        plan.set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high),
                 xlabel=f"error {name} ({unit})", ylabel=f"level ({unit})")
    figure.colorbar(shown, ax=list(axes[0]), shrink=0.75, pad=0.01, label="updates")
    figure.suptitle(run.name, fontsize=11, fontweight="bold")
    return figure


def _region_name(axes, x, y, name, fractions, shade, side):
    axes.text(x, y, f"{name}\n{100.0 * fractions[name]:.2f} %", transform=axes.transAxes, color=shade,
              fontsize=9, ha="left" if x < 0.5 else "right", va=side, zorder=4)
