"""Consistency of the filter: its covariance against its errors (NEES and 3-sigma bounds)."""
from dataclasses import dataclass

import numpy as np

# 95 % quantile of the chi-squared distribution with three degrees of freedom.
CHI2_95 = 7.815
AXES = ("x", "y", "yaw")


@dataclass
class Consistency:
    errors: np.ndarray        # (N, 3): m, m, rad
    sigmas: np.ndarray        # (N, 3): m, m, rad
    nees: np.ndarray          # (N,), normalised estimation error squared; mean 3 if consistent
    within_3_sigma: tuple     # fraction of updates, per axis
    selected: np.ndarray      # boolean mask of these updates

    @property
    def mean_nees(self):
        return float(np.mean(self.nees))

    @property
    def fraction_within(self):
        """Fraction of updates with all axes within 3 sigma."""
        return float((np.abs(self.errors) <= 3.0 * self.sigmas).all(axis=1).mean())


def format_nees(nees):
    """A NEES, from below 1 to millions, as text."""
    return f"{nees:.2f}" if nees < 100.0 else f"{nees:,.0f}"


def measure(run, max_gap):
    """The Consistency of a run with a truth; None if no update has a truth or a covariance."""
    errors, covariances, selected = run.update_errors(max_gap)
    if len(errors) == 0 or not np.any(covariances):
        return None
    sigmas = np.sqrt(np.maximum(np.diagonal(covariances, axis1=1, axis2=2), 0.0))
    # Identical particles have a singular covariance; adding (1 nm)^2 keeps the NEES finite (and huge).
    regular = covariances + 1e-18 * np.eye(3)
    nees = np.einsum("ni,ni->n", errors, np.linalg.solve(regular, errors[:, :, None])[:, :, 0])
    within = tuple(float(fraction) for fraction in (np.abs(errors) <= 3.0 * sigmas).mean(axis=0))
    return Consistency(errors, sigmas, nees, within, selected)
