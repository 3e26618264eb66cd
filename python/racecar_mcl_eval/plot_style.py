"""Common style of all figures."""
import matplotlib

matplotlib.use("Agg")  # writes files, needs no display
import matplotlib.pyplot as plt  # noqa: E402

from .columns import DEGRADED, INITIALIZING, LOCALIZED, LOST  # noqa: E402

# Okabe and Ito's palette for colour-blind readers; the truth is always black.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c564b", "#666666"]
TRUTH = "#000000"
TRUTH_UNDER = "#b3b9c1"  # of the truth under an estimate
GOOD, WARNING, BAD = "#009e73", "#e69f00", "#c1121f"
STATUS_COLOURS = {LOCALIZED: GOOD, INITIALIZING: "#56b4e9", DEGRADED: WARNING, LOST: BAD}
WIDTH = 10.0  # inches, of a full-width figure

plt.rcParams.update({
    "figure.dpi": 100, "savefig.dpi": 130, "savefig.bbox": "tight", "font.size": 10, "axes.titlesize": 11,
    "axes.titleweight": "bold", "axes.labelsize": 10, "legend.fontsize": 9, "axes.grid": True,
    "grid.alpha": 0.25, "grid.linewidth": 0.6, "axes.spines.top": False, "axes.spines.right": False,
    "lines.linewidth": 1.2, "legend.framealpha": 0.9, "figure.constrained_layout.use": True,
    "axes.axisbelow": True})


def colour(index):
    return COLOURS[index % len(COLOURS)]


def new_figure(rows=1, columns=1, height=4.0, **options):
    """A full-width figure of `height` inches and its axes, always a 2-D array."""
    return plt.subplots(rows, columns, figsize=(WIDTH, height), squeeze=False, **options)


def frame_on(axes, points, margin=2.2):
    """Zooms a plan to the points."""
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="x (m)", ylabel="y (m)")
    axes.set_aspect("equal")
    axes.grid(False)


def time_axis(axes):
    axes.set_xlabel("time (s)")
    axes.margins(x=0.01)


def run_legend(figure, axes, runs, height):
    """Names the runs above a figure of several."""
    if len(runs) > 1:
        figure.legend(*axes.get_legend_handles_labels(), loc="upper center", ncol=4,
                      bbox_to_anchor=(0.5, height))


def save(figure, path):
    figure.savefig(str(path))
    plt.close(figure)
