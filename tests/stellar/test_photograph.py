"""Photographs: problem, solutions and exit status."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest

from tests.kit.stars import photograph as make_photograph
from tests.kit.stars import written
from tests.tolerances import assert_close
from vopd.findings import Finding, InputError
from vopd.stellar.field import Failure, star_directions
from vopd.stellar.files import photograph
from vopd.stellar.files import photograph as photograph_directions_module
from vopd.stellar.files.findings import KindOfFinding, counted
from vopd.stellar.files.images import ImageAxes, MissingOption
from vopd.stellar.files.mistakes import Plausibility, UsualMistake
from vopd.stellar.files.photograph import (
    SolvedCamera,
    StarRequest,
    exit_status,
    implausible,
    only_one_pair,
    photograph_directions,
    photograph_problem,
    solve_photograph,
)
from vopd.stellar.files.read import PixelFormat, StarFile, read_star_csv
from vopd.stellar.methods.run import SolvedStars, StarOptions
from vopd.stellar.outlier_search import Outlier
from vopd.stellar.sky import FileSky, SkyRequest

# What is solved of a photograph: options that another needs, errors, and what is handed on


UTC_2020 = datetime(2020, 1, 15, 21, tzinfo=UTC)
PLACE = (48.0, 11.0, 500.0)
IMAGE = np.array([[1.0, 2.0], [3.0, 4.0], [-5.0, 6.0]])
SKY = np.array([[10.0, 20.0], [30.0, 40.0], [50.0, 60.0]])
AXES = ImageAxes(focal_mm=76.0)


def star_file(kind: str = "ra_deg,dec_deg", **more: Any) -> StarFile:
    positions = SKY if "dec" in kind else np.column_stack([SKY, [70.0, 80.0, 90.0]])
    if kind == "u,v,w":
        positions = star_directions(SKY[:, 0], SKY[:, 1])
    one = StarFile("a.csv", (2, 3, 4), ("", "", ""), IMAGE, "mm", kind, positions)
    return replace(one, **more)


def request(sky: dict[str, Any] | None = None, **more: Any) -> StarRequest:
    return StarRequest(AXES, sky=SkyRequest(**(sky or {})), **more)


MOUNT = "--mount needs --place, for the vehicle's yaw and pitch"
DATE = "needs --date, or a column utc"
MISSING: list[tuple[dict[str, Any], str]] = [
    ({"place": PLACE}, f"--place {DATE}"),
    ({"ephemeris": "de421.bsp"}, f"--ephemeris {DATE}"),
    ({"place": PLACE, "ephemeris": "de421.bsp"}, f"--place {DATE}"),
    ({"mount": np.eye(3)}, MOUNT),
    ({"mount": np.eye(3), "utc": UTC_2020}, MOUNT),
    ({"mount": np.eye(3), "place": PLACE}, f"--place {DATE}"),
]


@pytest.mark.parametrize(("sky", "said"), MISSING)
@pytest.mark.parametrize("kind", ["ra_deg,dec_deg", "u,v,w"])
def test_an_option_that_needs_another(sky: dict[str, Any], said: str, kind: str) -> None:
    with pytest.raises(MissingOption) as caught:
        photograph_directions(star_file(kind), request(sky), list[Finding]().append)
    assert str(caught.value) == f"a.csv: {said}"


CAMERA = "--camera is for ground points; the file has {}"
FOR_STARS = "a date and a place are for stars by ra and dec or by name, not {}"
AT = {"utc": UTC_2020, "place": PLACE}
REFUSED: list[tuple[str, dict[str, Any], dict[str, Any], str]] = [
    ("ra_deg,dec_deg", {}, {"camera_m": (1.0, 2.0, 3.0)}, CAMERA),
    ("ra_hours,dec_deg", {}, {"camera_m": (1.0, 2.0, 3.0)}, CAMERA),
    ("name", {}, {"camera_m": (1.0, 2.0, 3.0)}, CAMERA),
    ("u,v,w", {}, {"camera_m": (1.0, 2.0, 3.0)}, CAMERA),
    ("x_m,y_m,z_m", {}, {}, "ground points need --camera X,Y,Z, or --resection"),
    ("u,v,w", AT, {}, FOR_STARS),
    ("u,v,w", {"utc": UTC_2020}, {}, FOR_STARS),
    ("x_m,y_m,z_m", {"utc": UTC_2020}, {"camera_m": (0.0, 0.0, 0.0)}, FOR_STARS),
]


@pytest.mark.parametrize(("kind", "sky", "more", "said"), REFUSED)
def test_an_option_for_another_kind_of_file(
    kind: str, sky: dict[str, Any], more: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError) as caught:
        photograph_directions(star_file(kind), request(sky, **more), list[Finding]().append)
    assert str(caught.value) == f"a.csv: {said.format(kind)}"


def test_directions_and_what_they_refer_to() -> None:
    """Nothing is said of stars that are as the file has them."""
    found: list[Finding] = []
    for kind, more, epoch in (
        ("ra_deg,dec_deg", {}, "ICRF axes (J2000), stars as the file has them: no proper motion, "
         "aberration or refraction"),
        ("u,v,w", {}, "the axes of u, v, w"),
        ("x_m,y_m,z_m", {"camera_m": (10.0, 20.0, 0.0)}, ""),
    ):  # fmt: skip
        sky = photograph_directions(star_file(kind), request(**more), found.append)
        assert (sky.epoch, sky.frame, sky.magnitude) == (epoch, None, None)
        if kind != "x_m,y_m,z_m":
            assert_close("rae element", sky.directions, star_directions(SKY[:, 0], SKY[:, 1]))
        else:
            assert_close("rae element", sky.directions[0], [0.0, 0.0, 1.0])
    assert found == []
    long = star_file("u,v,w", positions=np.array([[0.0, 0.0, 2.0]] * 3))
    photograph_directions(long, request(), found.append)
    assert len(found) == 3 and "u, v, w have length 2" in str(found[0])


def test_the_date_of_the_file_is_used() -> None:
    """Before that of the option; everything else that was said of the sky stays."""
    pytest.importorskip("skyfield")
    sky = {"utc": UTC_2020.replace(year=2000), "place": PLACE, "pressure_mbar": 0.0}
    other = UTC_2020.replace(month=2)
    found = photograph_problem(star_file(utc=other), request(sky)).request.sky
    assert (found.utc, found.place, found.pressure_mbar) == (other, PLACE, 0.0)
    assert photograph_problem(star_file(), request(sky)).request.sky.utc == sky["utc"]


def test_warnings_about_the_stars_are_kept() -> None:
    long = star_file("u,v,w", positions=2.0 * star_directions(SKY[:, 0], SKY[:, 1]))
    notes = photograph_problem(long, request()).notes
    assert [str(one) for one in notes] == [
        f"a.csv: line {n}: u, v, w have length 2 and are taken as a direction" for n in (2, 3, 4)
    ]


SIGMAS = np.array([[0.01, 0.02, 0.5], [0.02, 0.01, 0.25], [0.01, 0.01, -0.5]])


@pytest.mark.parametrize("down", ["neither", "option", "format"])
def test_errors_of_the_readings(down: str) -> None:
    """Variances 1, 4, 4, 1, 1, 1 E-4, of which the mean is 2E-4; y turned turns correlations."""
    pixels = PixelFormat(y_down=down == "format")
    asked = replace(request(), axes=ImageAxes(focal_mm=76.0, y_down=down == "option"))
    found = photograph_problem(star_file(sigmas=SIGMAS, pixels=pixels), asked)
    sign = 1.0 if down == "neither" else -1.0
    assert found.stars.errors is not None
    covariance = [[[0.5, 0.5 * sign], [0.5 * sign, 2.0]], [[2.0, 0.25 * sign], [0.25 * sign, 0.5]]]
    assert_close("rae element", found.stars.errors[:2], covariance)
    assert found.request.options.reading_sigma_mm is not None
    assert_close("rae element", found.request.options.reading_sigma_mm, 2.0**0.5 / 100.0)
    assert found.stars.image_mm[:, 1].tolist() == [2.0 * sign, 4.0 * sign, 6.0 * sign]


def test_readings_that_are_all_alike() -> None:
    asked = request(options=StarOptions(reading_sigma_mm=0.03, weights="listed"))
    found = photograph_problem(star_file(), asked)
    assert found.stars.errors is None and found.request.options.reading_sigma_mm == 0.03
    assert photograph_problem(star_file(), request()).request.options.reading_sigma_mm is None


LISTED = "--weights listed knows no columns of sigma, and no other errors"
ERRORS: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    ({"sigmas": SIGMAS}, {"weights": "listed"}, LISTED),
    ({"sigmas": SIGMAS}, {"reading_sigma_mm": 0.1}, "the file has standard deviations: no "
     "--reading-sigma"),
]  # fmt: skip


@pytest.mark.parametrize(("file", "options", "said"), ERRORS)
def test_errors_that_do_not_go_together(
    file: dict[str, Any], options: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError) as caught:
        photograph_problem(star_file(**file), request(options=StarOptions(**options)))
    assert str(caught.value) == f"a.csv: {said}"


def test_how_many_stars_a_photograph_may_have() -> None:
    images = np.stack(np.meshgrid(np.arange(100.0), np.arange(1.0, 52.0)), -1).reshape(-1, 2)
    rays = np.column_stack([images, np.full(len(images), -76.0)])
    for count, refused in ((5001, True), (5000, False)):
        lines = tuple(range(11, 11 + count))
        many = StarFile("a.csv", lines, ("",) * count, images[:count], "mm", "u,v,w", rays[:count])
        many = replace(many, positions=rays[:count] / np.linalg.norm(rays[:count], axis=1)[:, None])
        if refused:
            with pytest.raises(InputError) as caught:
                photograph_problem(many, request())
            said = "a.csv: line 5011: more than 5000 stars in one photograph"
            assert str(caught.value) == said
        else:
            assert len(photograph_problem(many, request()).stars.used) == 5000


def test_resection_is_for_ground_points() -> None:
    """Before anything is asked of directions; a position that is given is not used."""
    for more in ({}, {"camera_m": (1.0, 2.0, 3.0)}):
        with pytest.raises(InputError) as caught:
            photograph_problem(star_file("u,v,w"), request(resection=True, **more))
        assert str(caught.value) == "a.csv: --resection is for ground points; the file has u,v,w"


@pytest.mark.parametrize("own", [None, [1.0, 2.0, 3.0]])
@pytest.mark.parametrize("listed", [None, [7.0, 8.0, 9.0]])
def test_magnitudes_of_the_catalogue(
    monkeypatch: pytest.MonkeyPatch, own: list[float] | None, listed: list[float] | None
) -> None:
    """They are used where the file has none of its own; stars by name are looked up there."""
    asked: list[str] = []

    def directions(file: StarFile, sky: SkyRequest, report: Any) -> FileSky:
        asked.append(file.kind)
        known = None if listed is None else np.array(listed)
        return FileSky(star_directions(SKY[:, 0], SKY[:, 1]), None, "", known)

    monkeypatch.setattr(photograph_directions_module, "sky_directions", directions)
    file = star_file("name", magnitude=None if own is None else np.array(own))
    found = photograph_problem(file, request()).file.magnitude
    expected = own or listed
    assert (None if found is None else found.tolist()) == expected and asked == ["name"]


# Exit status of a photograph, what a method for pairs leaves unsaid, and counts of findings


SOLVED = SolvedStars("svd", (1, 2), Failure.NONE, [], [], 0.0, [], 0, True, 0.0)
GOOD = Plausibility(0.1)
BAD = Plausibility(9.0, "much less is allowed")
BY_STARS = BAD._replace(mistake=UsualMistake("star 2 disagrees", 0.1, (1,)))
BY_UNITS = BAD._replace(mistake=UsualMistake("hours", 0.1))

PLAIN = StarRequest(ImageAxes(focal_mm=76.0))
REJECT, EDIT = replace(PLAIN, reject=True), replace(PLAIN, edit_by_pairs=True)
ROBUST = replace(PLAIN, options=StarOptions(weights="robust"))
LISTED_STATUS = replace(PLAIN, options=StarOptions(weights="listed"))

AFTER_ALL = {Failure.NONE: 0, Failure.NO_CONVERGENCE: 3}
WHERE_BAD = {Failure.NOT_A_ROTATION: 3, Failure.TOO_UNCERTAIN: 3, Failure.NO_CONVERGENCE: 3}


@pytest.mark.parametrize("failure", Failure)
def test_every_failure(failure: Failure) -> None:
    """Residuals that are too large explain two of them, which then are no error."""
    solved = [SOLVED, replace(SOLVED, failure=failure)]
    assert exit_status(solved, GOOD, PLAIN) == AFTER_ALL.get(failure, 1)
    assert exit_status(solved, BAD, PLAIN) == (WHERE_BAD | {Failure.NONE: 3}).get(failure, 1)
    allowed = WHERE_BAD | {Failure.NONE: 0}
    assert exit_status(solved, BY_STARS, REJECT) == allowed.get(failure, 1)


@pytest.mark.parametrize(
    ("judged", "request_", "doubtful"),
    [
        (GOOD, PLAIN, False), (GOOD, REJECT, False), (BAD, PLAIN, True), (BAD, REJECT, True),
        (BAD, ROBUST, True), (BY_UNITS, REJECT, True), (BY_UNITS, ROBUST, True),
        (BY_STARS, PLAIN, True), (BY_STARS, LISTED_STATUS, True), (BY_STARS, REJECT, False),
        (BY_STARS, EDIT, False), (BY_STARS, ROBUST, False),
    ],
)  # fmt: skip
def test_what_a_solution_allows_for(
    judged: Plausibility, request_: StarRequest, doubtful: bool
) -> None:
    """Wrong stars that are left out, or weigh little, do not spoil it; another mistake does."""
    assert implausible(judged, request_) == doubtful
    assert exit_status([SOLVED], judged, request_) == (3 if doubtful else 0)


def star_file_status(count: int) -> StarFile:
    image = np.zeros((count, 2))
    return StarFile("a.csv", tuple(range(count)), ("",) * count, image, "mm", "name", image)


PAIR = replace(SOLVED, method="two-star", stars=(1, 2))
TURN = replace(SOLVED, method="single-rotation", stars=(1, 2))
SAID = "stars 1 and 2 of {}, as listed; --pair or --all-pairs for others"
ASKED: list[tuple[tuple[SolvedStars, ...], int, dict[str, Any], str]] = [
    ((PAIR,), 3, {}, "two-star: " + SAID.format(3)),
    ((SOLVED, PAIR, TURN), 9, {}, "two-star and single-rotation: " + SAID.format(9)),
    ((TURN, SOLVED), 4, {"reject": True}, "single-rotation: " + SAID.format(4)),
    ((PAIR,), 2, {}, ""),
    ((SOLVED,), 9, {}, ""),
    ((), 9, {}, ""),
    ((PAIR,), 9, {"all_pairs": True}, ""),
    ((PAIR,), 9, {"pair": (1, 2)}, ""),
]


@pytest.mark.parametrize(("solved", "count", "options", "said"), ASKED)
def test_the_first_two_stars_of_many(
    solved: tuple[SolvedStars, ...], count: int, options: dict[str, Any], said: str
) -> None:
    found = only_one_pair(solved, star_file_status(count), replace(PLAIN, **options))
    expected = [KindOfFinding("pair", Finding(said, deck="a.csv", severity="warning"))]
    assert found == (expected if said else [])


@pytest.mark.parametrize(
    ("reject", "edit", "rejects"),
    [(False, False, False), (True, False, True), (False, True, True), (True, True, True)],
)
def test_what_rejects_stars(reject: bool, edit: bool, rejects: bool) -> None:
    assert replace(PLAIN, reject=reject, edit_by_pairs=edit).rejects == rejects


def test_defaults_of_a_request() -> None:
    """As `vopd stars solve --help` has them."""
    asked = StarRequest(ImageAxes())
    assert (asked.method, asked.pair, asked.free) == ("collinearity", None, ())
    assert not (asked.all_pairs or asked.reject or asked.edit_by_pairs or asked.listing)
    assert (asked.resection, asked.camera_m, tuple(asked.errors)) == (False, None, (None, False))
    assert (asked.axes.y_down, asked.axes.k1) == (False, 0.0)
    sky = asked.sky
    assert (sky.utc, sky.place, sky.pressure_mbar, sky.temperature_c) == (None, None, None, 10.0)
    assert (sky.ephemeris, sky.catalogue, sky.mount) == (None, None, None)


def test_findings_of_several_kinds_and_files() -> None:
    """The three first of each in their order; then of each kind the others, with the last file."""
    given = [
        KindOfFinding(kind, Finding(f"{kind} {k}", f"{k}.csv", severity="warning"))
        for k in range(5)
        for kind in ("svd: axis", "plausibility", "pair")
    ]
    shown = counted(given)
    assert [one.message for one in shown] == [
        *(f"{kind} {k}" for k in range(3) for kind in ("svd: axis", "plausibility", "pair")),
        "plausibility 3", "plausibility 4", "svd: 2 more like these", "pair: 2 more like these",
    ]  # fmt: skip
    assert {one.deck for one in shown[-2:]} == {"4.csv"}
    assert {one.severity for one in shown} == {"warning"}
    assert counted([]) == []


# Photographs of stars solved: methods and pairs, judgements, cameras, and what is handed on


REQUEST = StarRequest(ImageAxes(focal_mm=76.0))
STARS = make_photograph(8)


def star_file_photographs(count: int = 8) -> StarFile:
    (file,) = read_star_csv(written(STARS[:count]), "a.csv")
    return file


METHODS = {
    2: ["collinearity", "two-star", "single-rotation", "svd"],
    3: ["collinearity", "church", "church-weighted", "church-weighted-r", "two-star",
        "single-rotation", "svd"],
}  # fmt: skip


@pytest.mark.parametrize("count", METHODS)
def test_all_methods(count: int) -> None:
    """Church's takes three stars."""
    found = solve_photograph(star_file_photographs(count), replace(REQUEST, method="all"), "x")
    assert [one.method for one in found.solved] == METHODS[count]
    assert found.label == "x" and found.used.tolist() == list(range(count))
    assert [one.kind for one in found.findings] == (["pair"] if count > 2 else [])
    assert found.epoch.startswith("ICRF") and (found.utc, found.local) == (None, None)
    assert {one.sky is not None and set(one.sky) == {"ra_deg", "ra_hours", "dec_deg"}
            for one in found.solved} == {True}  # fmt: skip


@pytest.mark.parametrize("pair", [(1, 8), (8, 1), (3, 2)])
def test_a_pair(monkeypatch: pytest.MonkeyPatch, pair: tuple[int, int]) -> None:
    """In the order in which it is asked for; its residuals are judged by nobody."""
    monkeypatch.setattr(photograph, "judge", lambda *given: BAD_STAR)
    found = solve_photograph(star_file_photographs(), replace(REQUEST, method="svd", pair=pair))
    assert [one.stars for one in found.solved] == [pair] and found.findings == ()
    for k in (0, 1):
        beyond = (9, 1) if k else (1, 9)
        with pytest.raises(InputError) as caught:
            solve_photograph(star_file_photographs(), replace(REQUEST, pair=beyond))
        said = "a.csv: line 9: there is no star 9: the file ends with star 8"
        assert str(caught.value) == said


def test_all_pairs_are_of_200_stars_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = replace(REQUEST, method="svd", all_pairs=True)
    found = solve_photograph(star_file_photographs(3), asked)
    assert [one.stars for one in found.solved] == [(1, 2), (1, 3), (2, 3)]
    image = np.zeros((201, 2))
    for count in (200, 201):
        file = StarFile("a.csv", tuple(range(count)), ("",) * count, image, "mm", "name", image)
        if count == 200:
            pairs = photograph._pairs(file, asked)
            assert pairs is not None and len(pairs) == 19_900
            continue
        with pytest.raises(InputError) as caught:
            photograph._pairs(file, asked)
        assert str(caught.value) == "a.csv: 201 stars: all pairs are solved of 200 at most"


BAD_STAR = Plausibility(
    9.0, "less", UsualMistake("star 3 disagrees", 0.1, (2,)), (Outlier(2, 5.0, 1e-9),)
)
JUDGED = {
    "good": (Plausibility(0.1), {}, True, 0, 8),
    "bad": (Plausibility(9.0, "less", unexplained="why?"), {}, False, 3, 8),
    "star": (BAD_STAR, {}, False, 3, 8),
    "rejected": (BAD_STAR, {"reject": True}, True, 0, 7),
    "edited": (BAD_STAR, {"edit_by_pairs": True}, True, 0, 7),
    "robust": (BAD_STAR, {"options": StarOptions(weights="robust")}, True, 0, 8),
}


@pytest.mark.parametrize("name", JUDGED)
def test_what_a_judgement_changes(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Implausible residuals leave no statement of uncertainty; stars that do not fit may go."""
    judged, options, certain, status, count = JUDGED[name]
    monkeypatch.setattr(photograph, "judge", lambda *given: judged)
    found = solve_photograph(star_file_photographs(), replace(REQUEST, **options))
    (one,) = found.solved
    assert (one.rotation_sigma_arcsec is not None) == certain
    assert (found.status, len(found.used), len(one.stars)) == (status, count, count)
    assert (3 in one.stars) == (count == 8)
    said = [one.finding.message for one in found.findings]
    assert any("is left out" in text for text in said) == (count == 7)
    assert any("implausible" in text for text in said) == (name in ("bad", "star", "robust"))
    assert {one.kind for one in found.findings} <= {"plausibility"}


@pytest.mark.parametrize("edit", [False, True])
@pytest.mark.parametrize("sigma", [None, 0.01])
def test_what_is_judged(monkeypatch: pytest.MonkeyPatch, edit: bool, sigma: float | None) -> None:
    """All stars, by the sigma that was stated, and from the half that was asked for."""
    given: list[Any] = []

    def judge(*arguments: Any) -> Plausibility:
        given.append(arguments)
        return Plausibility(0.1)

    monkeypatch.setattr(photograph, "judge", judge)
    options = StarOptions(reading_sigma_mm=sigma)
    solve_photograph(star_file_photographs(), replace(REQUEST, edit_by_pairs=edit, options=options))
    ((file, stars, stated, axes, start),) = given
    assert (len(file.lines), stars.used.sum(), stated, axes) == (8, 8, sigma, REQUEST.axes)
    assert start == ("pairs" if edit else "interstar")


def test_a_solved_camera(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is judged by the stars as that camera of all of them sees them."""
    seen: list[Any] = []
    monkeypatch.setattr(photograph, "judge", lambda *given: seen.append(given[1]) or BAD_STAR)
    off = [(x * 1.25, y * 1.25, ra, dec) for x, y, ra, dec in STARS]
    (file,) = read_star_csv(written(off), "a.csv")
    found = solve_photograph(file, replace(REQUEST, free=("focal",), reject=True))
    (one,) = found.solved
    assert one.camera is not None and one.stars == (1, 2, 4, 5, 6, 7, 8)
    for stars in (seen[0], found.stars):
        assert round(float(stars.focal_length_mm[0])) == 95
    assert seen[0].focal_length_mm[0] != found.stars.focal_length_mm[0]  # of all stars, of seven
    assert one.reading_freedom == 2 * 7 - 3 - 1
    stated = replace(REQUEST, free=("focal",), options=StarOptions(reading_sigma_mm=0.5))
    (known,) = solve_photograph(file, stated).solved
    assert (known.reading_sigma, known.reading_freedom) == (0.5, None)


def test_what_is_said_of_a_camera_or_a_position(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is handed on, with the stars as they are solved."""
    problem = photograph_problem(star_file_photographs(), REQUEST)
    (solved,) = solve_photograph(star_file_photographs(), REQUEST).solved
    said = [KindOfFinding("x", Finding("x"))]
    other = problem.stars.only(np.arange(5))
    position = problem._replace(position=SolvedCamera(other, solved, said))
    found = photograph._solutions(position, np.arange(8))
    assert (found[0] is problem.stars, found[1:]) == (True, ([solved], said))
    camera = SolvedCamera(other, solved, said)
    monkeypatch.setattr(photograph, "solve_calibration", lambda *given: camera)
    free = problem._replace(request=replace(REQUEST, free=("k1",)))
    found = photograph._solutions(free, np.arange(8))
    assert (found[0] is other, found[1:]) == (True, ([solved], said))


def test_an_unsolvable_camera_is_said_with_the_mistake(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = replace(REQUEST, free=("focal", "k1"))
    for judged, end in ((BAD_STAR, "; star 3 disagrees"), (Plausibility(0.1), "")):
        monkeypatch.setattr(photograph, "judge", lambda *given, judged=judged: judged)
        with pytest.raises(InputError) as caught:
            solve_photograph(star_file_photographs(2), asked)
        assert str(caught.value) == f"a.csv: --free focal,k1 takes 3 stars at least{end}"


def test_a_solution_that_is_refused_is_not_shown() -> None:
    """It is an error of the photograph, and the status 1; the other methods stay."""
    asked = replace(REQUEST, method="church")
    flat = [(float(k), 0.0, -float(k), 0.0) for k in range(1, 5)]
    (file,) = read_star_csv(written(flat), "a.csv")
    found = solve_photograph(file, asked)
    assert (found.solved, found.status) == ((), 1)
    (said, *_) = found.findings
    assert said.kind == f"church: {Failure.GREAT_CIRCLE.name}"
    assert said.finding.message.startswith("lines 2, 3, 4 and 5: church: the stars, or their")
