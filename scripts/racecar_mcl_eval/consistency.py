"""Whether a filter's covariance tells the truth about its errors."""
from dataclasses import dataclass

import numpy as np

# 95 % quantile of chi squared with three degrees of freedom.
CHI2_95 = 7.815
AXES = ("x", "y", "yaw")


@dataclass
class Consistency:
    errors: np.ndarray        # (N, 3): m, m, rad
    sigmas: np.ndarray        # (N, 3): m, m, rad
    nees: np.ndarray          # (N,), normalised estimation error squared; 3 on average if all is right
    within_3_sigma: tuple     # share of updates, per axis
    chosen: np.ndarray        # which updates these are

    @property
    def mean_nees(self):
        return float(np.mean(self.nees))

    @property
    def share_within(self):
        """Share of updates with all axes inside 3 sigma."""
        return float((np.abs(self.errors) <= 3.0 * self.sigmas).all(axis=1).mean())


def round_text(nees):
    """A NEES, which runs from below 1 to millions, as people read it."""
    return f"{nees:.2f}" if nees < 100.0 else f"{nees:,.0f}"


def measure(run, max_gap):
    """None where no update has a truth or there is no covariance."""
    errors, covariances, chosen = run.update_errors(max_gap)
    if len(errors) == 0 or not np.any(covariances):
        return None
    sigmas = np.sqrt(np.maximum(np.diagonal(covariances, axis1=1, axis2=2), 0.0))
    # A cloud that fell onto one point has a singular covariance; a nanometre of spread keeps the
    # answer finite (and enormous).
    regular = covariances + 1e-18 * np.eye(3)
    nees = np.einsum("ni,ni->n", errors, np.linalg.solve(regular, errors[:, :, None])[:, :, 0])
    within = tuple(float(share) for share in (np.abs(errors) <= 3.0 * sigmas).mean(axis=0))
    return Consistency(errors, sigmas, nees, within, chosen)
