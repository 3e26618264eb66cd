"""scripts/plot_calibration: calibrated models against the data they were estimated from."""
import argparse
import warnings
from pathlib import Path

import numpy as np

from . import EvaluationError
from .cli import exit_status
from .plot_style import TRUTH, colour, new_figure, save

DESCRIPTION = """Plots the calibrated models against their data: writes beam_model.png and motion_noise.png
into FOLDER, the --out folder of calibrate_beam_model and calibrate_motion_noise."""
COMPONENTS = [("x", "longitudinal (m)"), ("y", "lateral (m)"), ("yaw", "heading (rad)")]
SENSOR_COLUMNS = ["expected_from", "expected_to", "range", "measured", "estimated", "before"]
MOTION_COLUMNS = ["model", "distance", *(f"{kind}_{name}" for kind in ("error", "sigma")
                                         for name, _ in COMPONENTS)]
DISTANCE_BINS = 12
MIN_PER_BIN = 5


def read_table(path, columns):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # numpy only warns about an empty file
            table = np.genfromtxt(str(path), delimiter=",", names=True, dtype=None, encoding="utf-8")
    except (ValueError, IndexError, OSError, Warning) as error:
        raise EvaluationError(f"{path}: not a table of the calibration programs: {error}") from None
    missing = [name for name in columns if name not in (table.dtype.names or ())]
    if missing:
        raise EvaluationError(f"{path}: lacks the column {missing[0]} of the calibration programs")
    if table.size < 2:
        raise EvaluationError(f"{path}: has no rows")
    return table


def draw_sensor(table, path):
    """Histograms of the measured range in bands of expected range, and the beam model before and after."""
    bands = np.unique(np.column_stack((table["expected_from"], table["expected_to"])), axis=0)
    figure, axes = new_figure(len(bands), 1, height=2.3 * len(bands))
    for row, (low, high) in zip(axes[:, 0], bands):
        part = table[(table["expected_from"] == low) & (table["expected_to"] == high)]
        width = part["range"][1] - part["range"][0]
        row.bar(part["range"], part["measured"], width=width, color="#bbbbbb", label="measured")
        row.plot(part["range"], part["before"], color=colour(1), linestyle="--", label="before")
        row.plot(part["range"], part["estimated"], color=colour(0), label="calibrated")
        row.set(yscale="log", ylim=(1e-5, 1.0), ylabel="fraction of beams")
        row.set_title(f"expected {low:.2f} to {high:.2f} m", loc="left")
    axes[0, 0].legend(loc="upper right", ncol=3)
    axes[-1, 0].set_xlabel("measured range (m); the last bin includes missing returns")
    save(figure, path)


def draw_spread(axes, part, component, shade):
    """RMS of the errors and of the model's sigmas, against the distance driven."""
    # The true distance: binning by the odometry's own would correlate with its errors.
    distance = part["distance"] + part["error_x"]
    edges = np.unique(np.quantile(distance, np.linspace(0, 1, DISTANCE_BINS + 1)))
    bins = np.clip(np.searchsorted(edges, distance, side="right") - 1, 0, max(len(edges) - 2, 0))
    rows = []
    for index in np.unique(bins):
        here = part[bins == index]
        if len(here) >= MIN_PER_BIN:
            rows.append((distance[bins == index].mean(), np.sqrt((here["error_" + component] ** 2).mean()),
                         np.sqrt((here["sigma_" + component] ** 2).mean())))
    rows = np.array(rows).reshape(-1, 3)
    axes.plot(rows[:, 0], rows[:, 1], "o", color=TRUTH, markersize=4, label="measured")
    axes.plot(rows[:, 0], rows[:, 2], color=shade, label="model")
    axes.set_ylim(bottom=0.0)


def draw_ratio(axes, part, component, shade):
    """Histogram of the normalised errors (error / sigma) and the standard normal density."""
    noisy = part["sigma_" + component] > 0.0
    ratio = part["error_" + component][noisy] / part["sigma_" + component][noisy]
    edges = np.linspace(-5, 5, 41)
    axes.hist(np.clip(ratio, -4.99, 4.99), bins=edges, density=True, color="#bbbbbb")
    grid = np.linspace(-5, 5, 200)
    axes.plot(grid, np.exp(-grid ** 2 / 2) / np.sqrt(2 * np.pi), color=shade)


def draw_motion(table, path):
    models = list(dict.fromkeys(table["model"]))
    figure, axes = new_figure(2 * len(models), 3, height=4.2 * len(models))
    for index, model in enumerate(models):
        part, shade = table[table["model"] == model], colour(index)
        for column, (component, title) in enumerate(COMPONENTS):
            spread, ratio = axes[2 * index, column], axes[2 * index + 1, column]
            draw_spread(spread, part, component, shade)
            draw_ratio(ratio, part, component, shade)
            spread.set_title(f"{model}: {title}", loc="left")
            spread.set_xlabel("distance (m)")
            ratio.set_xlabel("error / sigma")
        axes[2 * index, 0].set_ylabel("rms error")
        axes[2 * index + 1, 0].set_ylabel("density")
        axes[2 * index, 0].legend()
    save(figure, path)


def draw(folder):
    drawn = []
    for name, columns, draw_table in (("beam_model", SENSOR_COLUMNS, draw_sensor),
                                      ("motion_noise", MOTION_COLUMNS, draw_motion)):
        source = folder / f"{name}.csv"
        if source.exists():
            draw_table(read_table(source, columns), folder / f"{name}.png")
            drawn.append(folder / f"{name}.png")
    if not drawn:
        raise EvaluationError(f"{folder}: holds neither beam_model.csv nor motion_noise.csv, which "
                              "calibrate_beam_model and calibrate_motion_noise write with --out")
    for path in drawn:
        print(path)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="plot_calibration", description=DESCRIPTION)
    parser.add_argument("folder", metavar="FOLDER", type=Path)
    return exit_status("plot_calibration", lambda: draw(parser.parse_args(arguments).folder))
