#!/usr/bin/python3
"""Entry point of scripts/demo after the build."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))
from racecar_mcl_eval.demo import main  # noqa: E402

sys.exit(main())
