"""scripts/experiments: the experiments of the course report and further ones, as an HTML report."""
import argparse
import os
import shutil
import time
from pathlib import Path

from ..cli import exit_status
from ..html_report import HtmlReport
from .ablation import Ablation
from .car_odometry import CarOdometry
from .fault_injection import AdaptiveParticleCount, KidnappedRobot
from .filter_steps import BeamTable, ParticleSteps
from .initialization import InitialPoseError, PoseEstimators
from .parameter_sweeps import ParameterSweep, UpdateTime
from .runner import Runner
from .sensor_imperfections import SensorImperfections
from .tracking import OdometryNoise

EXPERIMENTS = {
    "noise": OdometryNoise, "table": BeamTable, "particles": ParticleSteps, "time": UpdateTime,
    "initial-pose": InitialPoseError, "sweep": ParameterSweep, "estimators": PoseEstimators,
    "kidnap": KidnappedRobot, "adaptive": AdaptiveParticleCount, "ablation": Ablation,
    "imperfections": SensorImperfections, "car-odometry": CarOdometry}


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="experiments", description="Repeats the experiments of the course report, and further ones, "
        "on the simulated car, and writes an HTML report (index.html) with its figures as PNG. Everything "
        "is seeded: the same build gives the same results, except for times.")
    parser.add_argument("--out", type=Path, default=Path("build/experiments"), help="output folder")
    parser.add_argument("--only", nargs="+", choices=EXPERIMENTS, metavar="NAME",
                        help="only these experiments: " + " ".join(EXPERIMENTS))
    parser.add_argument("--quick", action="store_true", help="short drives, few seeds")
    parser.add_argument("--keep", action="store_true", help="keep the bags and runs")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="parallel runs")
    return parser.parse_args(arguments)


def experiments(options):
    began = time.monotonic()
    runner = Runner(options.out.resolve(), options.quick, max(1, options.jobs))
    selected = [EXPERIMENTS[name]() for name in options.only or EXPERIMENTS]
    for experiment in selected:
        experiment.plan(runner)
    runner.execute()
    page = HtmlReport(runner.folder, "Experiments of the localization report",
                      "Simulated racecar, localized by the program used on the car. Commands are run in the "
                      "package's folder; OUT/ is the folder of this report.")
    for experiment in selected:
        experiment.show(page, runner)
    page.footer = f"Generated in {(time.monotonic() - began) / 60.0:.1f} minutes by:"
    path = page.write()
    if not options.keep:
        for folder in ("drives", "runs"):
            shutil.rmtree(runner.folder / folder)
    print(f"report: {path}")


def main(arguments=None):
    return exit_status("experiments", lambda: experiments(parse(arguments)))
