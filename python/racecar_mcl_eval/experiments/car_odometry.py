"""Odometry from the commanded steering angle, with and without a gyro."""
import numpy as np

from ..html_report import Cell
from ..plot_style import COLOURS, new_figure
from .tracking import CORRIDOR, TRACK
from .runner import DEFAULT, seeds_text

FEW_SCANS = 0.825  # fraction of lost scans: 7 of 40 per second are left


class CarOdometry:
    title = "Odometry from the commanded steering angle"
    DRIVE = ("--speed", 3, "--odom-noise", 0.1, "--turn-scale-error", -0.6, "--odom-turn-delay", 0.1, "--imu")
    CALIBRATION_OFF = ("expert/calibration_distance:=0",)

    def plan(self, runner):
        duration = ("--duration", 5 if runner.quick else 60)
        self.seeds = (1,) if runner.quick else (1, 2, 3)
        self.runs = {}
        for name, map_yaml in (("corridor", CORRIDOR), ("track", TRACK)):
            for rate, lost in ((40, 0.0), (7, FEW_SCANS)):
                drives = [runner.drive(map_yaml, *self.DRIVE, "--scan-dropout", lost, *duration, "--seed", seed)
                          for seed in self.seeds]
                for turns, settings, extra in (("not calibrated", self.CALIBRATION_OFF, ()),
                                               ("calibrated", (), ()),
                                               ("gyro", (), ("--imu-topic", "/imu"))):
                    self.runs[name, rate, turns] = [
                        runner.replay(drive, DEFAULT, settings=settings, seed=seed, extra=extra)
                        for drive, seed in zip(drives, self.seeds)]

    def show(self, page, runner):
        section = page.section(self.title)
        section.text(
            "The odometry of cars with a VESC integrates the commanded steering angle. Here its turn rate is 60 % too "
            "small and 0.1 s late. The turn scale and delay are estimated while driving; with an IMU the turns are "
            "those of its gyro as soon as they agree better with the scans. The fewer scans per second, the more it "
            f"matters. Mean over drives and filters with {seeds_text(self.seeds)}.")
        rows = []
        for (course, rate, turns), replays in self.runs.items():
            runs = [runner.run(replay) for replay in replays]
            position = [100.0 * run.errors.position for run in runs]
            heading = [np.degrees(np.abs(run.errors.heading)) for run in runs]
            rows.append([course, f"{rate}", turns,
                         Cell(f"{np.mean([each.mean() for each in position]):.1f}", "good" if turns == "gyro" else ""),
                         f"{np.mean([np.percentile(each, 99) for each in position]):.1f}",
                         f"{np.max([each.max() for each in position]):.0f}",
                         f"{np.mean([each.mean() for each in heading]):.2f}",
                         f"{np.max([each.max() for each in heading]):.1f}"])
        section.table(["course", "scans per second", "turns", "mean (cm)", "p99 (cm)", "max (cm)",
                       "heading, mean (deg)", "max (deg)"], rows, "3 m/s, odometry noise 0.1.")
        section.figure(self._figure(runner), "car-odometry", "Mean heading error.",
                       runner.commands(*(replays[0] for replays in self.runs.values())))

    def _figure(self, runner):
        figure, axes = new_figure(1, 1, height=3.0)
        bars = axes[0][0]
        turns_of = list(dict.fromkeys(turns for _, _, turns in self.runs))
        groups = list(dict.fromkeys((course, rate) for course, rate, _ in self.runs))
        for place, turns in enumerate(turns_of):
            means = [np.mean([np.degrees(np.abs(runner.run(replay).errors.heading)).mean()
                              for replay in self.runs[course, rate, turns]]) for course, rate in groups]
            bars.bar(np.arange(len(groups)) + 0.27 * (place - 1), means, 0.25, label=turns, color=COLOURS[place])
        bars.set_xticks(range(len(groups)))
        bars.set_xticklabels([f"{course}, {rate} scans/s" for course, rate in groups])
        bars.set_yscale("log")
        bars.set_ylabel("heading error (deg)")
        bars.grid(axis="x", visible=False)
        bars.legend()
        return figure
