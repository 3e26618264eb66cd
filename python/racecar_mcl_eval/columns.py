"""Names in the localizer's output: columns of updates.csv, keys of summary.json and /diagnostics, and values."""
STATUS = "status"  # column and key of /diagnostics
INLIER_RATIO = "inlier_ratio"  # column: fraction of a scan's beams that end at mapped surfaces
OUTCOME = "outcome"  # column
BEAM_ORDER = "scan_direction"  # key of summary.json

INITIALIZING, LOCALIZED, DEGRADED, LOST = "initializing", "localized", "degraded", "lost"  # of STATUS
STATIONARY, REJECTED = "stationary", "weights_vanished"  # of OUTCOME
REVERSED = "reversed"  # of BEAM_ORDER
