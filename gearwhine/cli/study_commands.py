"""Commands on a case, declared in :mod:`gearwhine.commands`, each made of the method of a study that has its name.

The parameters of the method are the options of the command, their texts and the first paragraphs of its docstring the
help. The methods stand in :mod:`gearwhine.study`, those that only a case has in :mod:`gearwhine.case_study`.
"""

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Required, Unpack, get_args, get_origin, get_type_hints

from cyclopts import Parameter, Token, validators
from docstring_parser.numpydoc import parse

from gearwhine.case_study import CaseStudy
from gearwhine.cli.common import NONE_GIVEN, CaseName, Common, on_case, results_folder, written
from gearwhine.commands import STUDY_COMMANDS, Command
from gearwhine.failures import PartlyFailedError
from gearwhine.numerics.findings import Number

if TYPE_CHECKING:
    from gearwhine.case import LoadedCase
    from gearwhine.numerics.progress import Progress

_MOST_FAILED = 0.5
"""Part of the gearboxes of a varied case that may fail."""
_OUT = "Results go to OUT (default: ./<case>-results)."

# Options that are of the terminal alone.
_SHOWN = {"verbose": ("-v", "Show every part, with the origin of its values.")}


def method_of(entry: Command) -> Callable[..., Any]:
    """Return the method of a study that a command is made of."""
    return getattr(CaseStudy, entry.method or entry.name)  # type: ignore[no-any-return]


def composer_of(entry: Command) -> str:
    """Return the module of results and its function that compose what a command shows; empty for files alone."""
    return f"{entry.name}.sections" if entry.sections is None else entry.sections


def made_command(entry: Command) -> Callable[..., None]:
    """Return the function of a command, with the signature and the help that its method gives."""
    shown = [] if entry.longer[0] not in _SHOWN else [_shown_option(entry.longer[0])]
    options = [*_method_options(entry), *_pictures_option(entry), *shown, *_fresh_option(entry)]

    def command(case: str, *, common: Common = NONE_GIVEN, **given: Any) -> None:
        _perform(entry, case, common, given)

    positional, keyword = inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY
    first = inspect.Parameter("case", positional, annotation=CaseName)
    last = inspect.Parameter("common", keyword, default=NONE_GIVEN, annotation=Common)
    command.__name__ = command.__qualname__ = entry.name
    command.__doc__ = _described(entry)
    command.__signature__ = inspect.Signature([first, *options, last])  # type: ignore[attr-defined]
    command.__annotations__ = {one.name: one.annotation for one in (first, *options, last)}
    return command


def _described(entry: Command) -> str:
    """Return the help of a command: the summary of its method, where the results go, and what else the method says."""
    documented = parse(method_of(entry).__doc__ or "")
    summary = f"{documented.short_description} {_OUT if entry.always_writes else ''}".strip()
    return f"{summary}\n\n{documented.long_description or ''}".strip()


def _on_one_line(text: str) -> str:
    return " ".join(text.split())


def _documented_parameters(function: Callable[..., Any]) -> Iterator[tuple[inspect.Parameter, str]]:
    """Yield the parameters of a method but the first, with their texts; those of a class of options for its ``**``."""
    texts = {one.arg_name: _on_one_line(one.description or "") for one in parse(function.__doc__ or "").params}
    for parameter in list(inspect.signature(function).parameters.values())[1:]:
        if parameter.kind is not inspect.Parameter.VAR_KEYWORD:
            yield parameter, texts[parameter.name]
        elif get_origin(parameter.annotation) is Unpack:
            (options,) = get_args(parameter.annotation)
            texts |= {one.arg_name: _on_one_line(one.description or "") for one in parse(options.__doc__).params}
            for name, kind in get_type_hints(options, include_extras=True).items():
                kind = get_args(kind)[0] if get_origin(kind) is Required else kind
                default = False if kind is bool else None
                yield inspect.Parameter(name, parameter.KEYWORD_ONLY, default=default, annotation=kind), texts[name]


def _method_options(entry: Command) -> Iterator[inspect.Parameter]:
    """Yield the parameters of a method as options."""
    for parameter, text in _documented_parameters(method_of(entry)):
        if parameter.name in entry.without:
            continue
        kind, rules = parameter.annotation, list[Number]()
        if get_origin(kind) is Annotated:
            kind, *rules = get_args(kind)
        if get_origin(kind) is Sequence:
            (item,) = get_args(kind)
            kind = list[item]  # type: ignore[valid-type]
        name = entry.names.get(parameter.name, parameter.name).replace("_", "-")
        # A name of one letter stands beside the parameter's own.
        names = [f"--{name}"] if len(name) > 1 else [f"--{parameter.name.replace('_', '-')}", f"-{name}"]
        limits = [validators.Number(gte=rule.at_least, lte=rule.at_most) for rule in rules]
        # A flag that is off by default needs no option that puts it off.
        negative = None if parameter.default is True else ()
        is_whole = int in (kind, *get_args(kind))
        marker = Parameter(
            name=names,
            negative=negative,
            validator=limits,
            converter=_whole_number if is_whole else None,
            consume_multiple=False,
            help=text,
        )
        default = [] if parameter.default == () else parameter.default
        yield parameter.replace(
            kind=inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, marker]
        )


def _whole_number(kind: Any, tokens: Sequence[Token]) -> int:
    """Return a whole number as it is written; cyclopts alone rounds one that is not whole."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"expected a whole number, got {tokens[0].value!r}") from None


def _shown_option(name: str) -> inspect.Parameter:
    short, text = _SHOWN[name]
    marker = Parameter(name=[f"--{name}", short], negative=(), help=text)
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Annotated[bool, marker])


def _fresh_option(entry: Command) -> Iterator[inspect.Parameter]:
    if entry.fresh:
        marker = Parameter(name="--fresh", negative=(), help=entry.fresh)
        yield inspect.Parameter(
            "fresh", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=Annotated[bool, marker]
        )


def _pictures_option(entry: Command) -> Iterator[inspect.Parameter]:
    """Yield the option of the method that stores its own results, for the others that draw."""
    if entry.draws and not entry.stores:
        (stores,) = (one for one in STUDY_COMMANDS if one.stores)
        yield from (one for one in _method_options(stores) if one.name == "pictures")


def _perform(entry: Command, case: str, common: Common, given: dict[str, Any]) -> None:
    """Make a study of the case, call its method, and show the result."""
    from gearwhine.output.terminal import shown_by
    from gearwhine.results import composer

    fresh = given.pop("fresh", False)
    shows_more = given.pop(entry.longer[0], False) if entry.longer[0] in _SHOWN else given.get(entry.longer[0], False)
    drawn = {} if entry.stores else {"pictures": given.pop("pictures", True)}
    writes = entry.always_writes or bool(given.get(entry.writes_with, False))

    def work(loaded: "LoadedCase", progress: "Progress") -> dict[str, Any]:
        folder = results_folder(case, common) if writes else common.output
        study = CaseStudy(loaded, progress, folder=folder, fresh=fresh)
        to_folder = {"folder": folder} if "folder" in entry.without else {}
        result = method_of(entry)(study, **given, **to_folder)
        document: dict[str, Any] = result.document if entry.stores else written(result, folder, progress, **drawn)
        return document

    composed_by = entry.longer[1] if shows_more else composer_of(entry)
    show = shown_by(composer(composed_by) if composed_by else lambda document: (), timed=entry.timed)
    files = _mesh_files(entry, given)
    _require_whole(on_case(case, common, work, show, entry.name, writes=files, always_writes=entry.always_writes))


def _mesh_files(entry: Command, given: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the names of the files of a mesh in the format that is given, else in the method's own."""
    options = inspect.signature(method_of(entry)).parameters
    if "suffix" not in options:
        return ()
    suffix = given.get("suffix", options["suffix"].default)
    return (f"mesh.{suffix}", "mesh.h5") if suffix == "xdmf" else (f"mesh.{suffix}",)


def _require_whole(document: Mapping[str, Any]) -> None:
    """Refuse to end well where points of a sweep failed; what is there is shown and written before."""
    # A varied case goes without the gearboxes that cannot be, and says so, up to half of them.
    if "points" in document and (failed := document["failed"]):
        total = len(document["points"])
        raise PartlyFailedError(f"{failed} of {total} points failed; they are tried again on the next run")
    if "quantities" in document and (failed := len(document["failed"])) > _MOST_FAILED * document["samples"]:
        raise PartlyFailedError(
            f"{failed} of {document['samples']} gearboxes cannot be solved: the others stand for no production; the "
            f"first fails by {document['failed'][0]['message']}"
        )
    if "designs" in document and len(document["failed"]) == document["designs"]:
        raise PartlyFailedError(f"no design can be solved: {document['failed'][0]['message']}")
    if missed := document.get("missed"):
        # The nearest design is shown and written; what is asked for cannot be had.
        from gearwhine.case import CaseError, Problem
        from gearwhine.case.errors import UNSAID, key_of

        count = document["designs"]
        raise CaseError(
            Problem(
                key_of(("optimisation", "limit", one["limit"])),
                UNSAID,
                f"limits that one of the {count} designs meets; the nearest misses {one['text']}",
            )
            for one in missed
        )
