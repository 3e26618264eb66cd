"""Paired bootstrap of the difference between two settings."""
from dataclasses import dataclass

import numpy as np

BETTER, WORSE, NO_DIFFERENCE = "better", "clearly worse", "no difference shown"
CONFIDENCE = 0.95
REPLICATES = 10000
_CHUNK = 500  # replicates at a time, which limits the memory


@dataclass
class Difference:
    """Mean difference of the errors, setting minus defaults, with its confidence interval."""
    mean: float
    low: float
    high: float

    @property
    def verdict(self):
        if self.high < 0.0:
            return BETTER
        return WORSE if self.low > 0.0 else NO_DIFFERENCE


def mean_over_bags(groups):
    """The mean over bags of the mean over their runs, so that each bag counts once."""
    return float(np.mean([np.mean(group) for group in groups]))


def paired_difference(groups, seed=1):
    """The Difference from the differences of pairs of runs with the same bag, map and seed. `groups`: a list of them
    for each bag. Bags are drawn with replacement, and runs within each drawn bag (two-stage bootstrap, Davison and
    Hinkley 1997, section 3.8): the runs of one bag have correlated errors. Percentile interval."""
    counts = np.array([len(group) for group in groups])
    values = np.zeros((len(groups), counts.max()))
    for row, group in zip(values, groups):
        row[:len(group)] = group
    generator = np.random.default_rng(seed)
    means = np.concatenate([_resampled_means(values, counts, min(_CHUNK, REPLICATES - first), generator)
                            for first in range(0, REPLICATES, _CHUNK)])
    tail = 100.0 * (1.0 - CONFIDENCE) / 2.0
    low, high = np.percentile(means, [tail, 100.0 - tail])
    return Difference(mean_over_bags(groups), float(low), float(high))


def _resampled_means(values, counts, replicates, generator):
    """`replicates` means over redrawn bags of the means over redrawn runs. `values`: bags x runs, of which the first
    `counts` of each row are valid."""
    bags = generator.integers(len(counts), size=(replicates, len(counts)))
    drawn = counts[bags][..., None]
    runs = (generator.random((*bags.shape, values.shape[1])) * drawn).astype(int)
    used = np.arange(values.shape[1]) < drawn
    return ((values[bags[..., None], runs] * used).sum(axis=2) / drawn[..., 0]).mean(axis=1)
