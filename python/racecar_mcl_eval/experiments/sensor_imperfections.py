"""A clockwise lidar, biased ranges and an outdated map."""
import cv2
import numpy as np
import yaml

from ..grid_map import OCCUPIED
from ..columns import INLIER_RATIO
from ..html_report import Cell
from ..plot_style import BAD, COLOURS, TRUTH_UNDER, frame_on, new_figure
from .tracking import CORRIDOR, beside, start_pose
from .runner import CONFIG_NAMES, DEFAULT, seeds_text

PATCHES = 120  # square errors of the map at its walls
CLEARED = 0.4  # m, half side of a patch with a missing wall
FILLED = 0.25  # m, half side of a patch with an object that no longer exists


def write_outdated_map(folder, map_yaml):
    """Writes a copy of the map with patches at its walls, alternately free and occupied."""
    with open(map_yaml, encoding="utf-8") as file:
        description = yaml.safe_load(file)
    image = cv2.imread(str(map_yaml.parent / description["image"]), cv2.IMREAD_GRAYSCALE)
    free = cv2.dilate((image > 250).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    walls = np.argwhere((image < 100) & free)
    chosen = walls[np.random.default_rng(1).choice(len(walls), PATCHES, replace=False)]
    for count, (row, column) in enumerate(chosen.tolist()):
        reach = int(round((FILLED if count % 2 else CLEARED) / description["resolution"]))
        cv2.rectangle(image, (column - reach, row - reach), (column + reach, row + reach),
                      0 if count % 2 else 254, -1)
    folder.mkdir(parents=True, exist_ok=True)
    description["image"] = "outdated.png"
    cv2.imwrite(str(folder / "outdated.png"), image)
    path = folder / "outdated.yaml"
    path.write_text(yaml.safe_dump(description), encoding="utf-8")
    return path


class SensorImperfections:
    title = "Clockwise lidar, biased ranges and outdated map"
    LIDAR_DRIVE = ("--speed", 7, "--odom-noise", 0.1)
    DEFAULTS = CONFIG_NAMES[DEFAULT]

    def plan(self, runner):
        duration = ("--duration", 5 if runner.quick else 40, "--seed", 1)
        self.seeds = (1,) if runner.quick else (1, 2, 3)
        self.outdated = write_outdated_map(runner.folder / "maps", CORRIDOR)
        start = " ".join(map(str, start_pose(CORRIDOR)))
        counterclockwise = runner.drive(CORRIDOR, *self.LIDAR_DRIVE, *duration)
        clockwise = runner.drive(CORRIDOR, *self.LIDAR_DRIVE, "--clockwise", *duration)
        long, short = (runner.drive(CORRIDOR, "--speed", 3, "--odom-noise", 0.1, "--range-bias", bias, *duration)
                       for bias in (0.03, -0.03))
        outdated = runner.drive(self.outdated, "--world", beside(CORRIDOR, "_world.yaml"), "--start", start,
                                "--speed", 3, "--odom-noise", 0.1, *duration)
        self.runs = {
            row: [runner.replay(drive, DEFAULT, settings=settings, seed=seed) for seed in self.seeds]
            for row, (drive, settings) in {
                ("counterclockwise lidar", self.DEFAULTS): (counterclockwise, ()),
                ("clockwise lidar", self.DEFAULTS): (clockwise, ()),
                ("clockwise lidar", "order not estimated"): (clockwise, ("scan_direction:=listed",)),
                ("clockwise lidar", "without deskewing"): (clockwise, ("deskew:=false",)),
                ("ranges 3 cm too long", self.DEFAULTS): (long, ()),
                ("ranges 3 cm too long", "bias not estimated"): (long, ("expert/range_bias_distance:=0",)),
                ("ranges 3 cm too short", self.DEFAULTS): (short, ()),
                ("ranges 3 cm too short", "bias not estimated"): (short, ("expert/range_bias_distance:=0",)),
                ("outdated map", self.DEFAULTS): (outdated, ()),
                ("outdated map", "no scan decorrelation"): (outdated, ("expert/scan_decorrelation_distance:=0",))}.items()}

    def show(self, page, runner):
        section = page.section(self.title)
        section.text(
            "Drivers of clockwise lidars (RPLIDAR) list the beams in reverse acquisition order without saying so. "
            "The localizer estimates the order from the match of deskewed scans with the map in the first turns. "
            "A constant error of all ranges becomes an error of the position along the path; it is estimated as well. "
            "The outdated map has patches in which a wall is missing, and others with objects that no longer "
            "exist. Consecutive scans then have correlated errors and are down-weighted. This costs some accuracy "
            "here, where the map errors are small patches, and gains more on recordings of buildings with large "
            f"map errors. Mean over the filter's {seeds_text(self.seeds)}.")
        rows, means = [], []
        for (condition, parameters), replays in self.runs.items():
            runs = [runner.run(replay) for replay in replays]
            position = [100.0 * run.errors.position for run in runs]
            heading = np.mean([np.degrees(np.abs(run.errors.heading)).mean() for run in runs])
            inlier_ratio = np.mean([run.updates.column(INLIER_RATIO).mean() for run in runs])
            means.append(np.mean([each.mean() for each in position]))
            rows.append([condition, parameters, Cell(f"{means[-1]:.1f}", "good" if parameters == self.DEFAULTS else ""),
                         f"{np.mean([np.percentile(each, 99) for each in position]):.1f}", f"{heading:.2f}",
                         f"{100.0 * inlier_ratio:.0f}"])
        section.table(["condition", "parameters", "mean (cm)", "p99 (cm)",
                       "heading, mean (deg)", "inlier ratio (%)"], rows,
                      "Order of the beams: up to 7 m/s; others: 3 m/s. Corridor loop, odometry noise 0.1.")
        section.figure(self._figure(runner, means), "sensor-imperfections",
                       "Left: the outdated map. Red: objects that do not exist; orange: missing walls. "
                       "Right: mean errors of the table.",
                       runner.commands(*(replays[0] for replays in self.runs.values())))

    def _figure(self, runner, means):
        figure, axes = new_figure(1, 2, height=3.4)
        plan, bars = axes[0]
        correct, outdated = runner.map(CORRIDOR), runner.map(self.outdated)
        correct.draw(plan)
        mapped, real = outdated.cells == OCCUPIED, correct.cells == OCCUPIED
        for wrong, colour in ((mapped & ~real, BAD), (real & ~mapped, COLOURS[1])):
            rows, columns = np.nonzero(wrong)
            plan.plot(correct.origin[0] + (columns + 0.5) * correct.resolution,
                      correct.origin[1] + (rows + 0.5) * correct.resolution, "s", markersize=1.2, color=colour)
        truth = runner.run(self.runs["outdated map", self.DEFAULTS][0]).truth.poses[:, :2]
        plan.plot(*truth.T, color=TRUTH_UNDER, linewidth=2.0)
        frame_on(plan, truth)
        names = [condition if parameters == self.DEFAULTS else parameters for condition, parameters in self.runs]
        colours = [COLOURS[0] if parameters == self.DEFAULTS else "#c9d3dd" for _, parameters in self.runs]
        places = np.arange(len(names))
        bars.barh(places, means, 0.6, color=colours)
        for place, mean in zip(places, means):
            bars.text(mean, place, f" {mean:.1f}", va="center", fontsize=9)
        bars.set_yticks(places)
        bars.set_yticklabels(names)
        bars.invert_yaxis()
        bars.grid(axis="y", visible=False)
        bars.set_xlabel("mean position error (cm)")
        return figure
