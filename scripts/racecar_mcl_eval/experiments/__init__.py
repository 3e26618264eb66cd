"""scripts/experiments: the report's experiments and what the course asks for beyond, as one page."""
import argparse
import os
import shutil
import time
from pathlib import Path

from ..command import exit_status
from ..page import Page
from .drives import RisingNoise
from .filter_parts import ParticleSpread, SensorTable
from .imperfect import Imperfect
from .starts import BadStart, ThreeEstimates
from .sweeps import ErrorAgainst, UpdateTime, WhatItBuys
from .trouble import CarriedAway, ShrinkingSet
from .workshop import Workshop

EXPERIMENTS = {
    "noise": RisingNoise, "table": SensorTable, "particles": ParticleSpread, "time": UpdateTime,
    "start": BadStart, "sweep": ErrorAgainst, "estimates": ThreeEstimates, "away": CarriedAway,
    "size": ShrinkingSet, "buys": WhatItBuys, "imperfect": Imperfect}


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="experiments", description="Drives the simulated car, localizes it with the package's "
        "own programs, and shows the report's experiments on a page (index.html, opens from disk) "
        "with its figures as PNG. Everything is seeded: the same build gives the same page, but for times.")
    parser.add_argument("--out", type=Path, default=Path("build/experiments"), help="folder for all of it")
    parser.add_argument("--only", nargs="+", choices=EXPERIMENTS, metavar="NAME",
                        help="only some: " + " ".join(EXPERIMENTS))
    parser.add_argument("--quick", action="store_true", help="short drives and few seeds")
    parser.add_argument("--keep", action="store_true", help="keep the recordings and runs")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at the same time")
    return parser.parse_args(arguments)


def experiments(options):
    began = time.monotonic()
    workshop = Workshop(options.out.resolve(), options.quick, max(1, options.jobs))
    chosen = [EXPERIMENTS[name]() for name in options.only or EXPERIMENTS]
    for experiment in chosen:
        experiment.plan(workshop)
    workshop.work()
    page = Page(workshop.folder, "The experiments of the localization report, again",
                "A simulated racecar, localized by the program that drives the real one. OUT/ in "
                "the commands is this page's folder; they are run in the package's.")
    for experiment in chosen:
        experiment.show(page, workshop)
    page.footer = f"Made in {(time.monotonic() - began) / 60.0:.1f} minutes by:"
    path = page.write()
    if not options.keep:
        for folder in ("drives", "runs"):
            shutil.rmtree(workshop.folder / folder)
    print(f"page: {path}")


def main(arguments=None):
    return exit_status("experiments", lambda: experiments(parse(arguments)))
