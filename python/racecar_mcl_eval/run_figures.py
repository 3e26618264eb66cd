"""Figures of the trajectories and errors of one or more runs. Each function returns a matplotlib figure."""
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.lines import Line2D

from .consistency import AXES, CHI2_95, format_nees
from .plot_style import (BAD, COLOURS, GOOD, TRUTH, TRUTH_UNDER, WARNING, WIDTH, colour, frame_on, new_figure, plt,
                         run_legend, time_axis)
from .scan_match import INLIER_DISTANCE

# Upper end of the error colour scale, m.
MAX_COLOUR_ERROR = 1.0
# Errors of this long, at the start, do not set the scale of errors over time: the start pose is being corrected.
START_SECONDS = 1.0
ERROR_COLOURS = "rainbow"
_DEGREES_PER_UNIT = (1.0, 1.0, 180.0 / np.pi)
_MATCH_COLOURS = ListedColormap([GOOD, BAD])


def plan_grid(count, points):
    """A figure and its axes for `count` plans of the same extent, arranged by their aspect ratio."""
    extent = np.ptp(points, axis=0) + 3.0
    columns = 1 if count == 1 else min(count, 2 if extent[0] > 0.7 * extent[1] else 3)
    rows = -(-count // columns)
    height = WIDTH / columns * min(1.1, max(0.35, extent[1] / extent[0])) * rows + 0.7
    figure, axes = plt.subplots(rows, columns, figsize=(WIDTH, min(height, 14.0)), squeeze=False)
    for unused in axes.flat[count:]:
        unused.set_visible(False)
    return figure, list(axes.flat[:count])


def _driven(runs):
    """The points that a plan of these runs must show. Estimates more than 3 m outside the extent of the
    truth are left out."""
    points = []
    for run in runs:
        estimate = run.trajectory.poses[:, :2]
        if run.truth is not None:
            true = run.truth.poses[:, :2]
            points.append(true)
            near = ((estimate > true.min(axis=0) - 3.0) & (estimate < true.max(axis=0) + 3.0)).all(axis=1)
            estimate = estimate[near]
        points.append(estimate)
    return np.concatenate(points)


def trajectories(runs, grid_map):
    """The estimates on the map; with a truth, over it and coloured by their error."""
    points = _driven(runs)
    figure, plans = plan_grid(len(runs), points)
    worst = [run.errors.position.max() for run in runs if run.errors is not None]
    limit = float(np.clip(max(worst), 0.05, MAX_COLOUR_ERROR)) if worst else None
    lines = None
    for index, (run, axes) in enumerate(zip(runs, plans)):
        if grid_map is not None:
            grid_map.draw(axes)
        if run.errors is None:
            axes.plot(*run.trajectory.poses[:, :2].T, color=colour(index), linewidth=1.6)
            first = run.trajectory.poses[0]
            handles = [Line2D([], [], color=colour(index), label="estimate")]
        else:
            axes.plot(*run.truth.poses[:, :2].T, color=TRUTH_UNDER, linewidth=5.0, zorder=2)
            estimate = run.errors.estimate[:, :2]
            segments = np.stack((estimate[:-1], estimate[1:]), axis=1)
            lines = LineCollection(segments, cmap=ERROR_COLOURS, norm=Normalize(0.0, limit), linewidth=1.8,
                                   zorder=3)
            lines.set_array(run.errors.position[1:])
            axes.add_collection(lines)
            first = run.errors.truth[0]
            handles = [Line2D([], [], color=TRUTH_UNDER, linewidth=5.0, label="truth"),
                       Line2D([], [], color=plt.get_cmap(ERROR_COLOURS)(0.2), linewidth=1.8,
                              label="estimate, coloured by error")]
        axes.plot(*first[:2], marker="o", markersize=7, color="white", markeredgecolor=TRUTH,
                  zorder=5)
        handles.append(Line2D([], [], marker="o", color="none", markerfacecolor="white",
                              markeredgecolor=TRUTH, label="start"))
        frame_on(axes, points)
        axes.set_title(run.name)
        if index == 0:
            axes.legend(handles=handles, loc="best")
    if lines is not None:
        over = max(worst) > limit
        bar = figure.colorbar(lines, ax=plans, shrink=0.8, pad=0.01,
                              extend="max" if over else "neither")
        bar.set_label("position error (m)")
    return figure


def _is_wide(runs):
    """Whether the errors need a logarithmic scale."""
    typical = min(np.median(run.errors.position) for run in runs)
    return max(run.errors.position.max() for run in runs) > 20.0 * max(typical, 1e-3)


def _min_shown(runs):
    return max(1e-3, min(np.percentile(run.errors.position, 1) for run in runs))


def _without_wraps(degrees):
    """Angles with NaN at steps across 180 degrees, so that no line is drawn there."""
    shown = np.array(degrees)
    shown[1:][np.abs(np.diff(degrees)) > 180.0] = np.nan
    return shown


def _limit_after_start(axes, runs, errors, unit, signed=True):
    """Scales an axis to the errors after START_SECONDS and names the larger ones before. `errors`: one array per
    run, of its run.errors.stamps."""
    largest, limit = 0.0, 0.0
    for run, values in zip(runs, errors):
        later = run.errors.seconds(run.errors.stamps[0]) > START_SECONDS
        size = np.abs(np.nan_to_num(values))
        largest = max(largest, size.max())
        limit = max(limit, 1.1 * (size[later] if later.any() else size).max())
    if largest <= 1.5 * limit:
        return
    axes.set_ylim(-limit if signed else 0.0, limit)
    axes.text(0.005, 0.95, f"up to {largest:.2g} {unit} in the first {START_SECONDS:g} s", ha="left", va="top",
              transform=axes.transAxes, fontsize=9)


def errors_over_time(runs, lost_error):
    """Position, heading and cross-track error of each run."""
    figure, axes = new_figure(3, 1, height=7.2, sharex=True)
    position, heading, cross = axes[:, 0]
    headings = [_without_wraps(np.degrees(run.errors.heading)) for run in runs]
    for index, run in enumerate(runs):
        seconds = run.errors.seconds(run.start)
        style = {"color": colour(index), "linewidth": 0.9, "label": run.name}
        position.plot(seconds, run.errors.position, **style)
        heading.plot(seconds, headings[index], **style)
        cross.plot(seconds, run.errors.cross_track, **style)
    _limit_after_start(heading, runs, headings, "deg")
    _limit_after_start(cross, runs, [run.errors.cross_track for run in runs], "m")
    if _is_wide(runs):
        position.set_yscale("log")
        position.set_ylim(bottom=_min_shown(runs))
    else:
        position.set_ylim(bottom=0.0)
        _limit_after_start(position, runs, [run.errors.position for run in runs], "m", signed=False)
    if max(run.errors.position.max() for run in runs) > lost_error:
        position.axhline(lost_error, color=BAD, linestyle="--", linewidth=1.0)
        position.text(0.995, lost_error, f"lost above {lost_error:g} m", color=BAD, ha="right",
                      va="bottom", transform=position.get_yaxis_transform(), fontsize=9)
    position.set_ylabel("position error (m)")
    heading.set_ylabel("heading error (deg)\n+ = left")
    cross.set_ylabel("cross-track error (m)\n+ = left of the car")
    for signed in (heading, cross):
        signed.axhline(0.0, color="#888888", linewidth=0.7)
    time_axis(cross)
    run_legend(figure, position, runs, 1.05)
    return figure


def histograms(runs):
    """Histogram and cumulative distribution of the position error."""
    figure, axes = new_figure(1, 2, height=3.6)
    counts, cumulative = axes[0]
    top = max(run.errors.position.max() for run in runs)
    wide = _is_wide(runs)
    bins = np.geomspace(_min_shown(runs), top, 60) if wide else np.linspace(0.0, top, 60)
    for index, run in enumerate(runs):
        error = np.sort(run.errors.position)
        counts.hist(error, bins=bins, weights=np.full(len(error), 100.0 / len(error)),
                    color=colour(index), alpha=0.25)
        counts.hist(error, bins=bins, weights=np.full(len(error), 100.0 / len(error)),
                    color=colour(index), histtype="step", linewidth=1.2, label=run.name)
        cumulative.plot(error, 100.0 * np.arange(1, len(error) + 1) / len(error), color=colour(index),
                        label=run.name)
    for plot in (counts, cumulative):
        plot.set_xlabel("position error (m)")
        if wide:
            plot.set_xscale("log")
    counts.set_ylabel("truth stamps (%)")
    cumulative.set_ylabel("truth stamps with\na smaller error (%)")
    cumulative.axhline(95.0, color="#888888", linestyle=":", linewidth=1.0)
    cumulative.set_ylim(0.0, 100.5)
    cumulative.legend(loc="lower right")
    return figure


def consistency(run, measured):
    """Errors of the updates with the estimated 3-sigma band, and their NEES."""
    figure, axes = new_figure(4, 1, height=8.0, sharex=True)
    stamps = run.updates.stamps[measured.selected]
    seconds = (stamps - run.start) * 1e-9
    for axis, name in enumerate(AXES):
        plot, unit = axes[axis, 0], "deg" if name == "yaw" else "m"
        scale = _DEGREES_PER_UNIT[axis]
        error, band = scale * measured.errors[:, axis], 3.0 * scale * measured.sigmas[:, axis]
        outside = np.abs(error) > band
        plot.fill_between(seconds, -band, band, color=COLOURS[0], alpha=0.18, linewidth=0,
                          label="±3σ estimated")
        plot.plot(seconds, error, color=COLOURS[0], linewidth=0.8, label="error")
        plot.plot(seconds[outside], error[outside], ".", color=BAD, markersize=3,
                  label="outside 3σ")
        reach = 1.15 * max(np.percentile(np.abs(error), 99.5), 1.2 * np.percentile(band, 50))
        plot.set_ylim(-reach, reach)
        plot.set_ylabel(f"{name} error ({unit})")
        plot.set_title(f"{name}: {100.0 * measured.within_3_sigma[axis]:.1f} % within 3σ", loc="left",
                       fontsize=10)
    axes[0, 0].legend(loc="upper right", ncol=3)
    nees = axes[3, 0]
    nees.semilogy(seconds, np.maximum(measured.nees, 1e-3), color=COLOURS[0], linewidth=0.7)
    nees.axhline(3.0, color=GOOD, label="3: expected mean")
    nees.axhline(CHI2_95, color=WARNING, linestyle="--",
                 label=f"{CHI2_95:.1f}: expected 95 % quantile")
    nees.set_title(f"NEES: mean {format_nees(measured.mean_nees)}, {100.0 * np.mean(measured.nees <= CHI2_95):.1f} % "
                   f"below {CHI2_95:.1f}", loc="left", fontsize=10)
    nees.set_ylabel("NEES")
    nees.legend(loc="upper right", ncol=2)
    time_axis(nees)
    return figure


def scans_on_map(runs, matches, grid_map):
    """The end points of the scans at the estimated poses: green near walls, red elsewhere."""
    points = _driven(runs)
    shown = [measured.points for measured in matches]
    low, high = points.min(axis=0) - 3.0, points.max(axis=0) + 3.0
    near = np.concatenate([part[((part > low) & (part < high)).all(axis=1)] for part in shown] + [points])
    figure, plans = plan_grid(len(runs), near)
    for run, measured, axes in zip(runs, matches, plans):
        grid_map.draw(axes, alpha=0.75)
        step = max(1, len(measured.points) // 60000)
        far = measured.distances[::step] > INLIER_DISTANCE
        # Outliers last, on top.
        order = np.argsort(far, kind="stable")
        axes.scatter(*measured.points[::step][order].T, c=far[order], cmap=_MATCH_COLOURS, vmin=0,
                     vmax=1, s=1.2, linewidths=0, alpha=0.6, rasterized=True)
        axes.plot(*run.trajectory.poses[:, :2].T, color=COLOURS[0], linewidth=1.0)
        frame_on(axes, near, margin=0.5)
        axes.set_title(f"{run.name}\n{100.0 * measured.inlier_ratio:.1f} % of beams within {INLIER_DISTANCE:g} m; "
                       f"mean {100.0 * measured.mean_distance:.1f} cm", fontsize=10)
    figure.legend(handles=[
        Line2D([], [], color=GOOD, marker="o", linestyle="", label=f"within {INLIER_DISTANCE:g} m of a wall"),
        Line2D([], [], color=BAD, marker="o", linestyle="", label="farther away"),
        Line2D([], [], color=COLOURS[0], label="estimate")], loc="upper center", ncol=3,
        bbox_to_anchor=(0.5, 1.05))
    return figure


def match_over_time(runs, matches):
    """Mean distance to walls and inlier ratio of each scan."""
    figure, axes = new_figure(2, 1, height=4.8, sharex=True)
    for index, (run, measured) in enumerate(zip(runs, matches)):
        seconds = (measured.stamps - run.start) * 1e-9
        style = {"color": colour(index), "linewidth": 0.8, "label": run.name}
        axes[0, 0].plot(seconds, measured.mean_distances, **style)
        axes[1, 0].plot(seconds, 100.0 * measured.inlier_ratios, **style)
    axes[0, 0].set_ylabel("mean distance of\nend points to walls (m)")
    axes[0, 0].set_ylim(bottom=0.0)
    axes[1, 0].set_ylabel(f"beams within {INLIER_DISTANCE:g} m\nof a wall (%)")
    axes[1, 0].set_ylim(0.0, 102.0)
    time_axis(axes[1, 0])
    run_legend(figure, axes[0, 0], runs, 1.08)
    return figure
