"""Orientation of a camera whose position is known, from stars or ground points (Rae 1987).

    from vopd.stellar import StarField, collinearity, star_directions
    field = StarField.of(star_directions(ra_deg, dec_deg), image_mm, 76.0)
    solution = collinearity(field)       # or wahba, church, two_star, single_rotation
    solution.omega_phi_kappa_deg         # (..., 3)

The methods take stacks of problems (`calibrate` and `resection` take one): the last
axes are stars and coordinates, those before them are problems. A problem without a
solution has NaN and a reason in `failure`; the others of the stack are not affected.
For ground points use `ground_directions` instead of `star_directions`.
"""

from vopd.stellar.angles import (
    alpha_delta_swing_deg,
    matrix_from_alpha_delta_swing,
    omega_phi_kappa_deg,
    orientation_matrix,
    orthogonality_defect,
)
from vopd.stellar.field import (
    REASONS,
    Failure,
    StarField,
    ground_directions,
    image_directions,
    right_ascension_declination_deg,
    star_directions,
)
from vopd.stellar.interstar_angles import star_disagreement_arcsec, star_pairs
from vopd.stellar.methods.calibration import Calibration, LensOfStars, calibrate
from vopd.stellar.methods.church import church
from vopd.stellar.methods.collinearity import collinearity
from vopd.stellar.methods.resection import Resection, resection
from vopd.stellar.methods.single_rotation import single_rotation
from vopd.stellar.methods.two_star import closed_form, two_star
from vopd.stellar.methods.wahba import wahba
from vopd.stellar.outlier_search import Outlier, find_outliers
from vopd.stellar.solution import StarSolution

__all__ = [
    "REASONS",
    "Calibration",
    "Failure",
    "LensOfStars",
    "Outlier",
    "Resection",
    "StarField",
    "StarSolution",
    "alpha_delta_swing_deg",
    "calibrate",
    "church",
    "closed_form",
    "collinearity",
    "find_outliers",
    "ground_directions",
    "image_directions",
    "matrix_from_alpha_delta_swing",
    "omega_phi_kappa_deg",
    "orientation_matrix",
    "orthogonality_defect",
    "resection",
    "right_ascension_declination_deg",
    "single_rotation",
    "star_directions",
    "star_disagreement_arcsec",
    "star_pairs",
    "two_star",
    "wahba",
]
