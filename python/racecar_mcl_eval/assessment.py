"""Overall assessment of a run for the head of the page: a headline and its reasons."""
from .consistency import format_nees
from .html_report import Banner
from .scan_match import INLIER_DISTANCE
from .trajectory import fraction_of_time, spans

# Fractions of beams within INLIER_DISTANCE of a wall. On seven recordings in furnished buildings good runs have
# 88 % and more (chairs, people and open doors are unmapped); a car lost in a similar corridor can reach 72 %.
MIN_INLIERS, GOOD_INLIERS = 0.75, 0.85
# Fraction of updates with all axes within 3 sigma; 99.7 % per axis if the covariance is correct.
MIN_WITHIN_3_SIGMA = 0.9
MAX_LOST_FRACTION = 0.01  # of the time


def assess(run, consistency, match, lost_error):
    """A Banner. `consistency` and `match` (ScanMatch) may be None; missing measurements are left out."""
    failures, warnings = [], []
    if run.errors is not None:
        position = run.errors.position
        lost = position > lost_error
        fraction = fraction_of_time(run.errors.stamps, lost)
        if fraction > MAX_LOST_FRACTION or position[-1] > lost_error:
            failures.append(f"position error above {lost_error:g} m for {percent(fraction)} of the time; "
                            f"max {position.max():.2f} m, at the end {position[-1]:.2f} m")
        elif lost.any():
            warnings.append(f"position error above {lost_error:g} m in "
                            f"{len(spans(run.errors.stamps, lost))} intervals; max {position.max():.2f} m")
    if match is not None and match.inlier_ratio < GOOD_INLIERS:
        (failures if match.inlier_ratio < MIN_INLIERS else warnings).append("only " + inliers_text(match))
    if consistency is not None and consistency.fraction_within < MIN_WITHIN_3_SIGMA:
        warnings.append(f"overconfident: error within 3σ in {percent(consistency.fraction_within)} of updates, "
                        f"mean NEES {format_nees(consistency.mean_nees)} (expected: 3)")
    if failures:
        return Banner(run.name, "bad", "NOT LOCALIZED", failures + warnings)
    if warnings:
        return Banner(run.name, "warning", "WARNING", warnings)
    if run.errors is None and match is None:
        return Banner(run.name, "warning", "NOT ASSESSED",
                      ["neither ground truth nor scans with a map were given"])
    return Banner(run.name, "good", "LOCALIZED", [good_reason(run, match)])


def good_reason(run, match):
    if run.errors is not None:
        return (f"position error: mean {100 * run.errors.position.mean():.1f} cm, "
                f"max {100 * run.errors.position.max():.1f} cm")
    return inliers_text(match)


def inliers_text(match):
    return f"{percent(match.inlier_ratio)} of the beams end within {INLIER_DISTANCE:g} m of a wall"


def percent(fraction):
    return f"{100.0 * fraction:.1f} %"
