"""Installs python/racecar_mcl_eval; run by catkin_python_setup(), not by hand."""
from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(
    packages=["racecar_mcl_eval", "racecar_mcl_eval.chaos", "racecar_mcl_eval.experiments",
              "racecar_mcl_eval.sweep"],
    package_dir={"": "python"},
    package_data={"racecar_mcl_eval": ["*.j2"]}))
