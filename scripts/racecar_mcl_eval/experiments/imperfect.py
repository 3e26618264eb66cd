"""A lidar that turns the other way, and a map that is out of date: what is not as it should be."""
import cv2
import numpy as np
import yaml

from ..grid_map import OCCUPIED
from ..page import Cell
from ..run_figures import TRUTH_UNDER
from ..style import BAD, COLOURS, frame_on, new_figure
from .drives import CORRIDOR
from .workshop import DEFAULT, seeds_text

PATCHES = 120  # places at walls where the map is wrong
CLEARED = 0.4  # m, half a side of a patch where the map lacks the wall
FILLED = 0.25  # m, of one where it shows what is no longer there


def write_stale_map(folder, map_yaml):
    """The map with patches at its walls: every other one free, the others occupied."""
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
    description["image"] = "stale.png"
    cv2.imwrite(str(folder / "stale.png"), image)
    path = folder / "stale.yaml"
    path.write_text(yaml.safe_dump(description), encoding="utf-8")
    return path


def beside(map_yaml, suffix):
    return map_yaml.with_name(map_yaml.stem + suffix)


class Imperfect:
    title = "A lidar that turns the other way, and a map that is out of date"
    FASTER = ("--speed", 7, "--odom-noise", 0.1)
    OWN = "the project's own"

    def plan(self, workshop):
        duration = ("--duration", 5 if workshop.quick else 40, "--seed", 1)
        self.seeds = (1,) if workshop.quick else (1, 2, 3)
        self.stale = write_stale_map(workshop.folder / "maps", CORRIDOR)
        with open(beside(CORRIDOR, "_start.yaml"), encoding="utf-8") as file:
            start = " ".join(map(str, yaml.safe_load(file)["start"]))
        straight = workshop.drive(CORRIDOR, *self.FASTER, *duration)
        clockwise = workshop.drive(CORRIDOR, *self.FASTER, "--clockwise", *duration)
        stale = workshop.drive(self.stale, "--world", beside(CORRIDOR, "_world.yaml"), "--start", start,
                               "--speed", 3, "--odom-noise", 0.1, *duration)
        self.runs = {
            row: [workshop.replay(drive, DEFAULT, settings=settings, seed=seed) for seed in self.seeds]
            for row, (drive, settings) in {
                ("beams listed in the order taken", self.OWN): (straight, ()),
                ("a lidar that turns clockwise", self.OWN): (clockwise, ()),
                ("a lidar that turns clockwise", "its list believed"): (clockwise, ("sweep_order:=listed",)),
                ("a lidar that turns clockwise", "without deskewing"): (clockwise, ("deskew:=false",)),
                ("a map out of date", self.OWN): (stale, ()),
                ("a map out of date", "every scan in full"): (stale, ("map_error_distance:=0",))}.items()}

    def show(self, page, workshop):
        section = page.section(self.title)
        section.text(
            "Lidars that turn clockwise (RPLIDAR) list their beams against the order in which they took "
            "them, and their drivers do not say so. Which order makes sweeps lie on the map is learned in the "
            "first turns. And maps age: of this one every other patch shows something that is gone, the others "
            "lack a wall. Scans taken close together then count in part. That costs some accuracy here, where the "
            "map errs in small patches that the likelihood forgives, and gains more on recordings from "
            f"buildings whose maps err all along. Mean over the filter's {seeds_text(self.seeds)}.")
        rows, means = [], []
        for (what, constants), replays in self.runs.items():
            runs = [workshop.run(replay) for replay in replays]
            position = [100.0 * run.errors.position for run in runs]
            heading = np.mean([np.degrees(np.abs(run.errors.heading)).mean() for run in runs])
            explained = np.mean([run.updates.column("explained").mean() for run in runs])
            means.append(np.mean([each.mean() for each in position]))
            rows.append([what, constants, Cell(f"{means[-1]:.1f}", "good" if constants == self.OWN else ""),
                         f"{np.mean([np.percentile(each, 99) for each in position]):.1f}", f"{heading:.2f}",
                         f"{100.0 * explained:.0f}"])
        section.table(["what is not as it should be", "constants", "mean (cm)", "99 % (cm)",
                       "heading, mean (deg)", "beams explained (%)"], rows,
                      "Lidars: up to 7 m/s. The map: 3 m/s. Corridor loop, odometry noise 0.1.")
        section.figure(self._figure(workshop, means), "imperfect",
                       "Left: the map out of date. Red: what it shows and is not there; orange: walls that it lacks. "
                       "Right: mean errors of the table.",
                       workshop.commands(*(replays[0] for replays in self.runs.values())))

    def _figure(self, workshop, means):
        figure, axes = new_figure(1, 2, height=3.4)
        plan, bars = axes[0]
        right, stale = workshop.map(CORRIDOR), workshop.map(self.stale)
        right.draw(plan)
        shown, there = stale.cells == OCCUPIED, right.cells == OCCUPIED
        for wrong, colour in ((shown & ~there, BAD), (there & ~shown, COLOURS[1])):
            rows, columns = np.nonzero(wrong)
            plan.plot(right.origin[0] + (columns + 0.5) * right.resolution,
                      right.origin[1] + (rows + 0.5) * right.resolution, "s", markersize=1.2, color=colour)
        truth = workshop.run(self.runs["a map out of date", self.OWN][0]).truth.poses[:, :2]
        plan.plot(*truth.T, color=TRUTH_UNDER, linewidth=2.0)
        frame_on(plan, truth)
        names = [what if constants == self.OWN else constants for what, constants in self.runs]
        colours = [COLOURS[0] if constants == self.OWN else "#c9d3dd" for _, constants in self.runs]
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
