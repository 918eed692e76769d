"""The columns of a table of star attitudes: name, unit and meaning of each."""

from __future__ import annotations

from typing import NamedTuple

from vopd.stellar.methods.solved_stars import ANGLE_NAMES, ANGLE_SIGMA_NAMES


class SolutionColumn(NamedTuple):
    """One column; `{unit}` in a name or unit is that of the image coordinates.

    Lists (stars, residuals) are one cell of text with spaces between.
    """

    name: str
    unit: str
    meaning: str
    text: bool = False


MATRIX_COLUMNS = tuple(f"m{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3))
AXIS_COLUMNS = ("axis_x", "axis_y", "axis_z")
SIGMA_COLUMNS = ("sigma_x_arcsec", "sigma_y_arcsec", "sigma_z_arcsec")
COVARIANCE_COLUMNS = tuple(
    f"covariance_{pair}_arcsec2" for pair in ("xx", "xy", "xz", "yy", "yz", "zz")
)
REGION_COLUMNS = ("boresight_95_major_arcsec", "boresight_95_minor_arcsec")

_ANGLES = {
    "omega_deg": "first turn of the camera axes, about x",
    "phi_deg": "second turn, about the new y",
    "kappa_deg": "third turn, about the new z",
    "alpha_deg": "right ascension of the optical axis, -180 to 180",
    "delta_deg": "declination of the optical axis",
    "swing_deg": "of the photograph's y axis from north toward increasing right ascension",
}

IMAGE = SolutionColumn("image", "", "the photograph", text=True)

COLUMNS = (
    SolutionColumn("method", "", "how it was solved", text=True),
    SolutionColumn("stars", "", "the stars solved, counted from 1", text=True),
    *(SolutionColumn(name, "deg", _ANGLES[name]) for name in ANGLE_NAMES),
    *(SolutionColumn(name, "", "of the matrix from object to camera axes")
      for name in MATRIX_COLUMNS),
    SolutionColumn("orthogonality_defect", "", "of the matrix as solved"),
    SolutionColumn("rms_{unit}", "{unit}", "root mean square of the residuals' coordinates"),
    SolutionColumn("residuals_{unit}", "{unit}", "observed minus computed x, y by star", text=True),
    SolutionColumn("iterations", "", "corrections made"),
    SolutionColumn("converged", "", "whether no further correction would change it", text=True),
    SolutionColumn("reading_sigma_{unit}", "{unit}", "standard deviation of an image coordinate"),
    SolutionColumn("reading_freedom", "", "degrees of freedom of that; missing where it is given"),
    *(SolutionColumn(name, "arcsec", "standard deviation about a camera axis")
      for name in SIGMA_COLUMNS),
    *(SolutionColumn(name, "arcsec2", "covariance about two camera axes")
      for name in COVARIANCE_COLUMNS),
    *(SolutionColumn(name, "deg", "standard deviation") for name in ANGLE_SIGMA_NAMES),
    *(SolutionColumn(name, "arcsec", "semi-axis of the 95 percent ellipse of the optical axis")
      for name in REGION_COLUMNS),
    SolutionColumn("boresight_95_angle_deg", "deg", "of its longer axis from north toward east"),
    SolutionColumn("weighted_rms_{unit}", "{unit}", "rms of the residuals with their weights"),
    *(SolutionColumn(name, "", "axis of the single rotation") for name in AXIS_COLUMNS),
    SolutionColumn("axis_ra_deg", "deg", "right ascension of that axis"),
    SolutionColumn("axis_dec_deg", "deg", "its declination"),
    SolutionColumn("angle_deg", "deg", "angle of the single rotation"),
    SolutionColumn("conditioning", "", "sin(D1, D2) of the single rotation"),
    SolutionColumn("interstar_discrepancy_arcsec", "arcsec", "of a pair: sky minus photograph"),
    SolutionColumn("disagreement_arcsec", "arcsec", "of each star with all others", text=True),
    SolutionColumn("weights", "", "of the residuals, x, y by star", text=True),
    SolutionColumn("images_{unit}", "{unit}", "x right, y up from the principal point", text=True),
    *(SolutionColumn(f"{name}_{{unit}}", "{unit}", f"{name}, solved with the attitude")
      for name in ("focal", "centre_x", "centre_y")),
    SolutionColumn("k1", "", "radial distortion, solved with the attitude"),
    *(SolutionColumn(f"sigma_{name}_{{unit}}", "{unit}", f"standard deviation of {name}")
      for name in ("focal", "centre_x", "centre_y")),
    SolutionColumn("sigma_k1", "", "standard deviation of k1"),
    SolutionColumn("ra_deg", "deg", "right ascension of the optical axis, 0 to 360"),
    SolutionColumn("ra_hours", "h", "the same in hours"),
    SolutionColumn("dec_deg", "deg", "declination of the optical axis"),
    SolutionColumn("ra_of_date_deg", "deg", "right ascension, equator and equinox of date"),
    SolutionColumn("ra_of_date_hours", "h", "the same in hours"),
    SolutionColumn("dec_of_date_deg", "deg", "declination, equator of date"),
    SolutionColumn("azimuth_deg", "deg", "of the optical axis, clockwise from north"),
    SolutionColumn("elevation_deg", "deg", "of the optical axis above the horizon"),
    SolutionColumn("camera_roll_deg", "deg", "of the camera about the optical axis"),
    *(SolutionColumn(f"vehicle_{name}_deg", "deg", f"{name} of the vehicle")
      for name in ("yaw", "pitch", "roll")),
    SolutionColumn("epoch", "", "what right ascensions and declinations refer to", text=True),
    SolutionColumn("camera_m", "m", "position of the camera, where it is solved", text=True),
    SolutionColumn("camera_sigma_m", "m", "its standard deviations", text=True),
)  # fmt: skip
"""The columns of every table in their order; IMAGE stands before them where there are several."""

CONVENTIONS = {
    "matrix": "M from object axes (U V W, or those of the ground points) to camera axes: x, y of "
    "the photograph, a positive seen from behind, y up; z backward",
    "sequence": "M = Rz(kappa) Ry(phi) Rx(omega); alpha, delta, swing from the same matrix",
    "sigmas": "one standard deviation; the 95 percent ellipse allows for the degrees of freedom",
}
"""What every file of star attitudes states."""
