#!/usr/bin/python3
"""What scripts/demo starts once everything is built."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from racecar_mcl_eval.demo import main  # noqa: E402

sys.exit(main())
