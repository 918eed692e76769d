"""Find the landmark of a frame that does not fit the others, by leaving each out in turn."""

from __future__ import annotations

import numpy as np
from scipy.special import fdtri

from vopd.arrays import Bools, Floats
from vopd.estimate import Estimate
from vopd.geometry.linear import pseudo_inverse

SIGNIFICANCE = 0.001  # the probability of a false alarm in a frame


@np.errstate(all="ignore")
def outliers(estimate: Estimate, significance: float = SIGNIFICANCE) -> Bools:
    """Mark the landmark of each frame that does not fit the others, at most one, (F, L).

    The residuals are those of least squares: what the erratum `first-landmark` adds
    to them is taken away. Leaving out landmark i reduces their sum of squares by
    r' Q^-1 r, with r its two residuals and Q their block of I - B(B'B)^-1 B'. Half of
    that, over the remaining sum of squares per degree of freedom, is F-distributed with
    2 and 2N - 5 degrees: the largest of the frame is an outlier where its probability is
    below `significance` over N (Bonferroni). It takes four landmarks: of three that
    disagree, none can be named.

    Args:
        estimate: the job
        significance: the probability of a false alarm in a frame
    """
    count = estimate.used.sum(axis=1)
    residual, reduction = _reduction(estimate)
    freedom = 2.0 * count - 5.0
    total = (residual**2).sum(axis=1)
    with_it = np.where(estimate.used, reduction, 0.0)
    f = (with_it / 2.0) / ((total[:, None] - with_it) / freedom[:, None])
    limit = fdtri(2.0, freedom, 1.0 - significance / count)[:, None]
    largest = np.arange(f.shape[1]) == f.argmax(axis=1)[:, None]
    enough = (count >= 4)[:, None] & estimate.used & np.isfinite(f)
    # rounding noise is not a misfit
    noticed = (np.sqrt(total) > 1e-9 * estimate.focal_length)[:, None]
    return np.asarray(enough & noticed & largest & (f > limit))


def _reduction(estimate: Estimate) -> tuple[Floats, Floats]:
    """Residuals of least squares (F, 2L); by how much each landmark raises their sum of squares."""
    b = np.where(np.isfinite(estimate.partials), estimate.partials, 0.0)
    count = estimate.used.shape[1]
    inverse = pseudo_inverse(b)
    fitted = b @ (inverse @ estimate.residual[..., None])
    residual = estimate.residual - fitted[..., 0]
    x, y = slice(0, count), slice(count, None)
    xx, xy, yy = (
        float(one == other) - (b[:, one] * inverse[:, :, other].swapaxes(1, 2)).sum(axis=2)
        for one, other in ((x, x), (x, y), (y, y))
    )
    rx, ry = residual[:, :count], residual[:, count:]
    reduction = (yy * rx**2 - 2.0 * xy * rx * ry + xx * ry**2) / (xx * yy - xy**2)
    return residual, reduction
