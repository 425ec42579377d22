"""What commands on a case take alike: the case's name, the common options, and starting afresh."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter, Token


def _folder(type_: object, tokens: Sequence[Token]) -> Path:
    """The folder that is named; nothing is no name, though as a path it stands for the present folder."""
    (token,) = tokens
    if not token.value.strip():
        raise ValueError("--output is empty; expected the name of a folder, such as results")
    return Path(token.value)


@Parameter(name="*")
@dataclass(frozen=True)
class Common:
    """What every command on a case takes."""

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
    bool, Parameter(name="--fresh", negative=(), help="Solve the housing's modes also where OUT keeps them unchanged.")
]
FreshRun = Annotated[
    bool,
    Parameter(
        name="--fresh",
        negative=(),
        help="Begin anew also where OUT keeps the housing's modes, or a transient that was interrupted.",
    ),
]
CaseName = Annotated[str, Parameter(help="A case file (TOML), or the name of a bundled case.")]
