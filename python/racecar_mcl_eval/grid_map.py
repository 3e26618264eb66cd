"""Occupancy grid maps in map_server's format: reading, writing, drawing, and distances to walls."""
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
import yaml
from matplotlib.colors import ListedColormap
from matplotlib.transforms import Affine2D

from . import EvaluationError

FREE, OCCUPIED, UNKNOWN = 0, 1, 2
# Distances to walls are truncated here; points outside the map have this distance.
MAX_DISTANCE = 2.0  # m
_COLOURS = ListedColormap(["#ffffff", "#4d4d4d", "#e4e7ea"])


@dataclass
class GridMap:
    name: str
    cells: np.ndarray    # FREE, OCCUPIED or UNKNOWN; row 0 at the bottom
    resolution: float    # m per cell
    origin: tuple        # x, y, yaw of the lower-left corner in the map frame
    _distances: np.ndarray = field(default=None, repr=False)

    def to_grid(self, points):
        """Points (N, 2) in the map frame as continuous grid coordinates, in cells from the corner."""
        x, y, yaw = self.origin
        dx, dy = points[:, 0] - x, points[:, 1] - y
        return np.column_stack((dx * np.cos(yaw) + dy * np.sin(yaw),
                                dy * np.cos(yaw) - dx * np.sin(yaw))) / self.resolution

    def corners(self):
        height, width = self.cells.shape
        box = np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * (width, height) * self.resolution
        return Affine2D().rotate(self.origin[2]).translate(*self.origin[:2]).transform(box)

    def wall_distances(self, points):
        """Distance (m) from each point to the nearest occupied cell's centre, interpolated between cell
        centres and truncated at MAX_DISTANCE."""
        if self._distances is None:
            margin = int(np.ceil(MAX_DISTANCE / self.resolution)) + 2
            open_space = np.pad((self.cells != OCCUPIED).astype(np.uint8), margin, mode="constant",
                                constant_values=1)
            if open_space.all():
                raise EvaluationError(f"map {self.name} has no occupied cell")
            distances = cv2.distanceTransform(open_space, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
            self._distances = np.minimum(distances * self.resolution, MAX_DISTANCE).astype(np.float32)
        margin = int(np.ceil(MAX_DISTANCE / self.resolution)) + 2
        grid = (self.to_grid(points) - 0.5 + margin).astype(np.float32)
        if len(grid) == 0:
            return np.empty(0)
        # cv2.remap is limited to 32767 rows.
        parts = [cv2.remap(self._distances, part[:, 0:1].copy(), part[:, 1:2].copy(),
                           cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=MAX_DISTANCE)
                 for part in np.array_split(grid, len(grid) // 30000 + 1)]
        return np.concatenate(parts)[:, 0]

    def draw(self, axes, alpha=1.0):
        """Draws the cells in the map frame, including the origin's yaw."""
        height, width = self.cells.shape
        place = Affine2D().rotate(self.origin[2]).translate(*self.origin[:2]) + axes.transData
        axes.imshow(self.cells, cmap=_COLOURS, vmin=0, vmax=2, origin="lower", alpha=alpha,
                    extent=(0, width * self.resolution, 0, height * self.resolution), zorder=0,
                    interpolation="nearest" if max(width, height) < 1200 else "antialiased",
                    transform=place)
        axes.set_aspect("equal")


def load_map(path):
    """Reads a map_server YAML and its image, in trinary mode."""
    path = Path(path)
    try:
        description = yaml.safe_load(path.read_text(encoding="utf-8"))
        resolution = float(description["resolution"])
        origin = tuple(float(value) for value in description["origin"])
        occupied, free = float(description["occupied_thresh"]), float(description["free_thresh"])
        negate, image_path = int(description["negate"]), path.parent / description["image"]
        assert len(origin) == 3 and resolution > 0.0
    except (OSError, UnicodeDecodeError) as error:
        raise EvaluationError(f"map {path} cannot be read: {error}") from error
    except (yaml.YAMLError, KeyError, TypeError, ValueError, AssertionError) as error:
        raise EvaluationError(f"map {path} is not a map_server YAML (image, resolution, origin, negate, "
                              f"occupied_thresh, free_thresh): {error!r}") from error
    image = cv2.imread(str(image_path), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise EvaluationError(f"map {path}: its image {image_path} cannot be read")
    dark = image / 255.0 if negate else 1.0 - image / 255.0
    cells = np.full(image.shape, UNKNOWN, dtype=np.uint8)
    cells[dark > occupied] = OCCUPIED
    cells[dark < free] = FREE
    return GridMap(str(path), np.ascontiguousarray(cells[::-1]), resolution, origin)


def write_map(grid_map, path):
    """Writes a map_server YAML and its image beside it."""
    path = Path(path)
    shades = np.empty(3, np.uint8)
    shades[[FREE, OCCUPIED, UNKNOWN]] = 254, 0, 205
    image = path.with_suffix(".pgm")
    if not cv2.imwrite(str(image), shades[grid_map.cells[::-1]]):
        raise EvaluationError(f"{image}: cannot be written")
    path.write_text(f"image: {image.name}\nresolution: {grid_map.resolution!r}\n"
                    f"origin: {[float(value) for value in grid_map.origin]}\n"
                    "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n", encoding="utf-8")
