"""Common command-line options: the case's name, output folder, JSON, settings, quiet, fresh."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter, Token


def _folder(type_: object, tokens: Sequence[Token]) -> Path:
    """The named folder; an empty name is refused, though as a path it is the current folder."""
    (token,) = tokens
    if not token.value.strip():
        raise ValueError("--output is empty; expected the name of a folder, such as results")
    return Path(token.value)


@Parameter(name="*")
@dataclass(frozen=True)
class Common:
    """Options of every command on a case."""

    output: Annotated[
        Path | None, Parameter(name=["--output", "-o"], converter=_folder, help="Folder for the results.")
    ] = None
    json: Annotated[bool, Parameter(name="--json", negative=(), help="Print one JSON document and nothing else.")] = (
        False
    )
    settings: Annotated[
        list[str],
        Parameter(
            name=["--set"],
            negative=(),
            consume_multiple=False,
            help="Change the case: key.path=value, such as --set housing.box.mesh_size='20 mm'. May be repeated.",
        ),
    ] = field(default_factory=list)
    quiet: Annotated[bool, Parameter(name=["--quiet", "-q"], negative=(), help="Show no progress.")] = False


NONE_GIVEN = Common()
Fresh = Annotated[
    bool,
    Parameter(name="--fresh", negative=(), help="Solve the housing's modes again, even if OUT holds them."),
]
FreshRun = Annotated[
    bool,
    Parameter(
        name="--fresh",
        negative=(),
        help="Start again, even if OUT holds the housing's modes or an interrupted transient.",
    ),
]
CaseName = Annotated[str, Parameter(help="A case file (TOML), or the name of a bundled case.")]
