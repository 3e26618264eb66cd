"""Draws a drive on its map."""
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # a file, with or without a display
import matplotlib.pyplot as pyplot  # noqa: E402
import numpy  # noqa: E402
import yaml  # noqa: E402
from matplotlib.transforms import Affine2D  # noqa: E402

TRUTH_COLOUR = "#222222"
ESTIMATE_COLOUR = "#d62728"


def draw_map(axes, map_yaml):
    """The map's image where map_server's YAML puts it, origin yaw included."""
    map_yaml = Path(map_yaml)
    description = yaml.safe_load(map_yaml.read_text(encoding="utf-8"))
    image = pyplot.imread(str(map_yaml.parent / description["image"]))
    if image.ndim == 3:
        image = image[:, :, :3].mean(axis=2)
    height, width = image.shape
    resolution = description["resolution"]
    x, y, yaw = description["origin"]
    place = Affine2D().rotate(yaw).translate(x, y) + axes.transData
    axes.imshow(image, cmap="gray", alpha=0.5, interpolation="nearest", transform=place,
                extent=(0.0, width * resolution, 0.0, height * resolution), origin="upper")
    corners = Affine2D().rotate(yaw).translate(x, y).transform(
        [(i * width * resolution, j * height * resolution) for i in (0, 1) for j in (0, 1)])
    return corners.min(axis=0), corners.max(axis=0)


def frame_of(trajectories, low, high, margin=2.0):
    """The part of the map that was driven, with a margin in metres."""
    x = numpy.concatenate([t.x for t in trajectories])
    y = numpy.concatenate([t.y for t in trajectories])
    return (numpy.maximum(low, (x.min() - margin, y.min() - margin)),
            numpy.minimum(high, (x.max() + margin, y.max() + margin)))


def draw_drive(path, map_yaml, estimate, title, truth=None, error=None):
    """Writes a PNG: the map, the estimate, the truth if known, and then the error over time.

    `error` is (stamps, position errors in m), as trajectory.errors gives them.
    """
    rows = 2 if error is not None else 1
    figure, axes = pyplot.subplots(rows, 1, figsize=(9, 8 if rows == 2 else 6.5), squeeze=False,
                                   gridspec_kw={"height_ratios": [5, 1][:rows]})
    plan = axes[0, 0]
    low, high = draw_map(plan, map_yaml)
    shown = [estimate]
    if truth is not None and len(truth) > 0:
        plan.plot(truth.x, truth.y, color=TRUTH_COLOUR, linewidth=3.0, alpha=0.45, label="truth")
        shown.append(truth)
    plan.plot(estimate.x, estimate.y, color=ESTIMATE_COLOUR, linewidth=1.0, label="estimate")
    plan.plot(estimate.x[:1], estimate.y[:1], "o", color=ESTIMATE_COLOUR, label="start")
    low, high = frame_of(shown, low, high)
    plan.set(title=title, xlabel="x (m)", ylabel="y (m)", xlim=(low[0], high[0]),
             ylim=(low[1], high[1]))
    plan.set_aspect("equal")
    plan.legend(loc="best")
    if error is not None:
        stamps, position = error
        strip = axes[1, 0]
        strip.plot(stamps - estimate.stamp[0], 100.0 * position, color=ESTIMATE_COLOUR,
                   linewidth=0.8)
        strip.set(xlabel="time (s)", ylabel="position error (cm)", ylim=(0.0, None))
        strip.margins(x=0.0)
        strip.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
