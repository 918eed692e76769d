"""Options and arguments that several commands share."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from copy import copy
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from vopd.errata import Fix, Fixes, fixes
from vopd.findings import VopdError, count_text
from vopd.geometry.ellipsoids import ELLIPSOIDS
from vopd.inputs import beyond_sigmas, plain_digits

if TYPE_CHECKING:
    from vopd.attitude.history import HistoryOptions
    from vopd.pipeline import SolveOptions


# Numbers on the command line.


class _Plain(click.ParamType[Any]):
    """A number in the digits 0 to 9: Python's also takes 2_0 and ٢٠. It is never `nan`."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if isinstance(value, str) and not plain_digits([value]):
            self.fail(f"{value!r} is not written in the digits 0 to 9.", param, ctx)
        number = super().convert(value, param, ctx)
        if number != number:  # math.isnan takes no whole number of 400 digits
            self.fail("nan is not a number.", param, ctx)
        return number


class _Number(_Plain, click.types.FloatParamType):
    """Any number."""


class _Whole(_Plain, click.types.IntParamType):
    """Any whole number."""


class NumberRange(_Plain, click.FloatRange):
    """A range of numbers."""


class WholeRange(_Plain, click.IntRange):
    """A range of whole numbers."""


NUMBER, WHOLE = _Number(), _Whole()


# Options that have one value


class GroupOfCommands(click.Group):
    """Commands whose options have one value, unless they are repeatable: click takes the last."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name, command, rest = super().resolve_command(ctx, args)
        if command is not None and not ctx.resilient_parsing:
            _refuse_two_values(click.Context(command, parent=ctx, info_name=name), rest)
        return name, command, rest


def _refuse_two_values(ctx: click.Context, args: list[str]) -> None:
    """Refuse an option that is given twice with two values; with one value no harm is done.

    Many programs take the last, so that an alias has values that a line overrides. Here a value
    is mostly a number that moves angles or their standard deviations: of two in one line, one
    left over from an earlier line, the one that is dropped would be dropped in silence.
    """
    once = [
        one
        for one in ctx.command.params
        if isinstance(one, click.Option)
        and not (one.multiple or one.count or (one.is_flag and not one.secondary_opts))
    ]
    repeatable = copy(ctx.command)
    repeatable.params = [_repeatable(one) if one in once else one for one in ctx.command.params]
    try:
        values, _, _ = repeatable.make_parser(ctx).parse_args([*args])
    except click.UsageError:  # which the command says itself
        return
    for option in once:
        first, *others = values.get(str(option.name)) or [None]
        if any(one != first for one in others):
            names = "/".join([max(option.opts, key=len), *option.secondary_opts])
            raise click.UsageError(f"{names} is given twice: write it once.", ctx)


def _repeatable(option: click.Parameter) -> click.Parameter:
    """Make an option that keeps all values that it is given."""
    found = copy(option)
    found.multiple = True
    return found


# The options that several commands share, each with one meaning everywhere.

AnyCommand = Callable[..., Any]

quiet_option = click.option("-q", "--quiet", is_flag=True, help="Print no warnings.")

_SOLVE_OPTIONS: dict[str, dict[str, Any]] = {
    "--fix": {
        "metavar": "NAME",
        "multiple": True,
        "shell_complete": lambda ctx, option, begun: [
            one for one in ("all", *(fix.value for fix in Fix)) if one.startswith(begun)
        ],
        "help": "Correct an erratum, or all; repeatable.",
    },
    "--ellipsoid": {
        "type": click.Choice(list(ELLIPSOIDS)),
        "help": "Ellipsoid of the Earth for --fix earth.  [default: wgs84]",
    },
    "--initial": {
        "type": click.Choice(["deck", "closed-form"]),
        "default": "deck",
        "show_default": True,
        "help": "Start a frame from the one before (the first from group 8), or from two "
        "landmarks.",
    },
    "--compare-initial": {
        "is_flag": True,
        "help": "With closed-form: solve from the deck's start too, and name frames that differ.",
    },
    "--limits-1974": {
        "is_flag": True,
        "help": "A deck that exceeds the original's array sizes is an error.",
    },
}
"""The options of decks, by name."""


def _of_decks(
    names: Iterable[str], hidden: bool = False
) -> tuple[Callable[[AnyCommand], AnyCommand], ...]:
    return tuple(click.option(name, hidden=hidden, **_SOLVE_OPTIONS[name]) for name in names)


def _show_deck_options(ctx: click.Context, option: click.Parameter, asked: bool) -> None:
    """Print the options that a command has for decks alone, which its help leaves out."""
    if not asked or ctx.resilient_parsing:
        return
    rows = []
    for one in ctx.command.params:
        if isinstance(one, click.Option) and one.hidden:
            one.hidden = False
            rows.append(one.get_help_record(ctx) or ("", ""))
            one.hidden = True
    formatter = ctx.make_formatter()
    with formatter.section("Options of decks"):
        formatter.write_dl(rows)
    click.echo(formatter.getvalue(), nl=False)
    ctx.exit()


_SIGMAS = (
    (
        "--reading-sigma",
        "reading",
        "of an image coordinate, mm on film or px; by default from the residuals of all frames.",
    ),
    (
        "--fiducial-sigma",
        "fiducial",
        "of a fiducial's film coordinate, mm; by default from the fiducials.",
    ),
    (
        "--landmark-sigma",
        "landmark",
        "of a landmark's position, along each axis, ft or m; it takes part in the solve of a "
        "flight, and moves its angles.",
    ),
    (
        "--position-sigma",
        "position",
        "of the camera's position, along each axis, ft or m; it takes part in the solve of a "
        "flight, and moves its angles.",
    ),
    ("--focal-sigma", "focal_length", "of the focal length, mm or px."),
    ("--time-sigma", "time_s", "of the times of the frames, s."),
    ("--velocity-sigma", "velocity", "of the velocity, along each axis, ft/s or m/s."),
    ("--wind-sigma", "wind", "of the wind, along north and east, ft/s or m/s."),
    ("--mount-sigma", "mount_deg", "of the camera's mounting in the vehicle, degrees."),
)
"""Option, field of `Sigmas`, meaning; of two units the first is a deck's, the second a flight's."""


def above_zero(ctx: click.Context, option: click.Parameter, value: float | None) -> float | None:
    """Refuse a number that is not above 0: a callback of options."""
    if value is not None and not value > 0.0:
        raise click.UsageError(f"{option.opts[0]}: must be above 0, not {value:g}.")
    return value


def stated_sigma(ctx: click.Context, option: click.Parameter, value: float | None) -> float | None:
    """Refuse a number that is no standard deviation above 0: a callback of options."""
    if above_zero(ctx, option, value) is not None and (beyond := beyond_sigmas([value or 0.0])):
        raise click.UsageError(f"{option.opts[0]}: {beyond}.")
    return value


_OF_HISTORY = {
    "max_rate_deg_s": click.option(
        "--max-rate",
        "max_rate_deg_s",
        type=NUMBER,
        metavar="DEG/S",
        callback=above_zero,
        help="Flag frames that turn faster than this.",
    ),
    "vertical": click.option(
        "--vertical",
        type=click.Choice(["geodetic", "geocentric"]),
        help="Vertical of the local axes of angles and quaternion.  [default: geocentric for a "
        "deck; geodetic for a flight and with --fix earth]",
    ),
}
"""The options of a history besides its sigmas, by the fields of `HistoryOptions`."""


def _with(
    options: tuple[Callable[[AnyCommand], AnyCommand], ...], command: AnyCommand
) -> AnyCommand:
    for option in reversed(options):
        command = option(command)
    return command


def _chosen_fixes(names: tuple[str, ...], ellipsoid: str | None) -> Fixes:
    if ellipsoid and not {"earth", "all"} & set(names):
        raise click.UsageError("--ellipsoid is only for --fix earth or --fix all.")
    try:
        return fixes(*names, ellipsoid=ellipsoid or "wgs84")
    except VopdError as error:
        raise click.UsageError(f"--fix: {error}.") from error


def fix_options(function: AnyCommand) -> AnyCommand:
    """Add --fix and --ellipsoid; the command is given one argument, `fixes`."""

    @wraps(function)
    def with_fixes(*, fix: tuple[str, ...], ellipsoid: str | None, **others: Any) -> Any:
        return function(**others, fixes=_chosen_fixes(fix, ellipsoid))

    return _with(_of_decks([*_SOLVE_OPTIONS][:2]), with_fixes)


def solve_options(function: AnyCommand, hidden: bool = False) -> AnyCommand:
    """Add the options of a solve; the command is given one argument, `solve`.

    Args:
        function: the command
        hidden: whether its help leaves them out
    """

    @wraps(function)
    def with_solve(
        *,
        fix: tuple[str, ...],
        ellipsoid: str | None,
        initial: Any,
        compare_initial: bool,
        limits_1974: bool,
        **others: Any,
    ) -> Any:
        from vopd.pipeline import SolveOptions

        chosen = _chosen_fixes(fix, ellipsoid)
        if compare_initial and initial == "deck":
            raise click.UsageError("--compare-initial is only for --initial closed-form.")
        return function(**others, solve=SolveOptions(chosen, initial, compare_initial, limits_1974))

    return _with(_of_decks(_SOLVE_OPTIONS, hidden), with_solve)


@dataclass(frozen=True)
class SharedOptions:
    """The values of the options that all commands with attitude histories share."""

    solve: SolveOptions
    history: HistoryOptions
    strict: bool
    quiet: bool

    def doubtful(self, flagged: int, mistaken: int, errata: int, unread: int) -> bool:
        """Say what `--strict` makes status 3, where it is given; tell whether there is anything.

        Args:
            flagged: frames with any flag
            mistaken: flights whose residuals or track speak for an error of their inputs
            errata: jobs in which errata change an angle by more than its standard deviation
            unread: decks with cards that are not read
        """
        flights = "a flight" if mistaken == 1 else f"{mistaken} flights"
        reasons = (
            (flagged, f"{count_text(flagged, 'frame is', 'frames are')} flagged"),
            (mistaken, f"residuals or track of {flights} speak for an error of the inputs"),
            (errata, f"the errata of the program change {count_text(errata, 'job')} by more than "
                     "a sigma"),
            (unread, f"{count_text(unread, 'deck')} with cards that are not read"),
        )  # fmt: skip
        found = [text for count, text in reasons if count and self.strict]
        for text in () if self.quiet else found:
            click.echo(f"--strict: {text}", err=True)
        return bool(found)


def history_options(function: AnyCommand) -> AnyCommand:
    """Add the options of a solve, of standard deviations and of flags.

    The command is given one argument, `options`, of `SharedOptions`.
    """

    @wraps(function)
    def with_options(
        *,
        solve: SolveOptions,
        strict: bool,
        quiet: bool,
        **rest: Any,
    ) -> Any:
        from vopd.attitude.history import HistoryOptions
        from vopd.attitude.sigmas import Sigmas

        names = {option[2:].replace("-", "_"): field for option, field, _ in _SIGMAS}
        values = {field: rest.pop(name) for name, field in names.items()}
        try:
            sigmas = Sigmas(**{name: one for name, one in values.items() if one is not None})
        except VopdError as error:
            raise click.UsageError(f"{error}.") from error
        history = HistoryOptions(sigmas, **{field: rest.pop(field) for field in _OF_HISTORY})
        shared = SharedOptions(solve, history, strict, quiet)
        return function(**rest, options=shared)

    options = (
        *(
            click.option(
                name,
                type=NUMBER,
                metavar="SIGMA",
                hidden=field == "fiducial",
                help=f"Standard deviation {text}",
            )
            for name, field, text in _SIGMAS
        ),
        *_OF_HISTORY.values(),
        click.option(
            "--strict",
            is_flag=True,
            help="Exit with status 3 if any frame has a flag, if the residuals of a flight show an "
            "error in its inputs, if errata of a deck turn an angle by more than a sigma, or if "
            "cards of a deck are not read.",
        ),
        quiet_option,
        click.option(
            "--help-decks",
            is_flag=True,
            is_eager=True,
            expose_value=False,
            callback=_show_deck_options,
            help="Show the options of decks: --fix, --initial and others.",
        ),
    )
    return _with(options, solve_options(with_options, hidden=True))


OF_DECKS = (*_SOLVE_OPTIONS, "--fiducial-sigma", "--spread")
"""The options that only decks have a use for, in commands that take flights, too."""


def tell_unused(sources: Iterable[str], quiet: bool) -> None:
    """Say which options of decks are given where all sources are flights, and so have no use.

    Args:
        sources: the decks and flights that the command is given or has found
        quiet: whether nothing is said
    """
    from vopd.pipeline import is_flight

    if quiet or not all(map(is_flight, sources)):
        return
    ctx = click.get_current_context()
    for option in ctx.command.params:
        source = ctx.get_parameter_source(option.name or "")
        if option.opts[0] in OF_DECKS and source is click.core.ParameterSource.COMMANDLINE:
            click.echo(f"{option.opts[0]}: not used: it is for decks", err=True)


# Arguments and options for file names, shared by all commands.


class _FileName(click.Path):
    """A name of a file, or `-`, which is not empty, as that of a variable without value.

    Shells complete it; whether it can be read is seen when it is read.
    """

    needed = "the name of a file is needed."

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not value:
            self.fail(self.needed, param, ctx)
        return super().convert(value, param, ctx)


FILE_NAME = _FileName(readable=False)


class _FolderName(_FileName):
    """A name of a folder to be written."""

    needed = "the name of a folder is needed; . is this one."

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "-" and not self.allow_dash:
            self.fail("- is standard output, and no folder.", param, ctx)
        return super().convert(value, param, ctx)


FOLDER_NAME = _FolderName(readable=False)
FOLDER_OR_FILE = _FolderName(readable=False, allow_dash=True)

decks_argument = click.argument("decks", type=FILE_NAME, metavar="DECK...", nargs=-1, required=True)
"""One deck or several; `-` is standard input."""


class _SourceName(_FileName):
    """A name of a file, or of a folder with `flight.toml` in it, which stands for that file.

    `-` is standard input.
    """

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        name = super().convert(value, param, ctx)
        project = os.path.join(name, "flight.toml")  # noqa: PTH118
        return project if name != "-" and os.path.isfile(project) else name  # noqa: PTH113


SOURCE_NAME = _SourceName(readable=False)


class _ProjectName(_SourceName):
    """A name of a flight project, or of its folder."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        from vopd.pipeline import is_flight

        name = super().convert(value, param, ctx)
        if not is_flight(name):
            raise click.UsageError(f"{name}: a flight project ends in .toml.", ctx)
        return name


project_argument = click.argument("project", type=_ProjectName(readable=False), metavar="PROJECT")
"""A flight project, whose name ends in .toml, or its folder."""

sources_argument = click.argument(
    "sources", type=SOURCE_NAME, metavar="SOURCE...", nargs=-1, required=True
)
"""Flight projects, whose names end in .toml, and decks; `-` is a deck on standard input."""


def output_option(help_text: str, required: bool = False) -> Callable[[Any], Any]:
    """Make the option `-o FILE`; unless it is required, the default is standard output."""
    needed: dict[str, Any] = {"required": True} if required else {"default": "-"}
    return click.option("-o", "--output", type=FILE_NAME, metavar="FILE", help=help_text, **needed)


def text_or_json_option(help_text: str) -> Callable[[Any], Any]:
    """Make the option `--format text|json`; the command is given it as `output_format`."""
    return click.option(
        "--format",
        "output_format",
        type=click.Choice(["text", "json"]),
        default="text",
        show_default=True,
        help=help_text,
    )
