"""One word for a run, and why: what a reader should know before looking at any figure."""
from .consistency import round_text
from .page import Banner
from .scan_fit import NEAR
from .trajectory import share_of_time, spans

# Shares of beams near a wall. On seven recordings in furnished buildings good runs keep 88 % and more
# (chairs, people and open doors are on no map), while a car that is lost in a corridor much like its own
# can have 72 %.
FEW_NEAR, MOST_NEAR = 0.75, 0.85
# Share of updates inside 3 sigma on all axes; 99.7 % per axis if the covariance is right.
FEW_INSIDE = 0.9
LOST_SHARE = 0.01  # of the time


def judge(run, consistency, fit, lost_error):
    """Only what was measured counts; a run without truth and scans is not judged."""
    bad, doubtful = [], []
    if run.errors is not None:
        position = run.errors.position
        lost = position > lost_error
        share = share_of_time(run.errors.stamps, lost)
        if share > LOST_SHARE or position[-1] > lost_error:
            bad.append(f"more than {lost_error:g} m off for {percent(share)} of the time; "
                       f"{position.max():.2f} m at worst, {position[-1]:.2f} m at the end")
        elif lost.any():
            doubtful.append(f"{position.max():.2f} m off at worst "
                            f"({len(spans(run.errors.stamps, lost))} times more than {lost_error:g} m)")
    if fit is not None:
        told = f"{percent(fit.near)} of all beams end within {NEAR:g} m of a wall of the map"
        if fit.near < FEW_NEAR:
            bad.append("only " + told)
        elif fit.near < MOST_NEAR:
            doubtful.append("only " + told)
    if consistency is not None and consistency.share_within < FEW_INSIDE:
        doubtful.append(f"over-confident: the truth lies within the 3σ it claimed in "
                        f"{percent(consistency.share_within)} of updates (NEES "
                        f"{round_text(consistency.mean_nees)} on average; 3 would be right)")
    if bad:
        return Banner(run.name, "bad", "NOT LOCALIZED", bad + doubtful)
    if doubtful:
        return Banner(run.name, "doubtful", "DOUBTFUL", doubtful)
    if run.errors is None and fit is None:
        return Banner(run.name, "doubtful", "NOT JUDGED",
                      ["neither a truth nor scans and a map to compare with were given"])
    return Banner(run.name, "good", "LOCALIZED", [good_reason(run, fit)])


def good_reason(run, fit):
    if run.errors is not None:
        return (f"{100 * run.errors.position.mean():.1f} cm off on average, "
                f"{100 * run.errors.position.max():.1f} cm at worst")
    return f"{percent(fit.near)} of all beams end within {NEAR:g} m of a wall of the map"


def percent(share):
    return f"{100.0 * share:.1f} %"
