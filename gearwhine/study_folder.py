"""Folder of a study of many solutions: the options that sweeps, variations, detection and optimisation share."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Required, TypedDict

from gearwhine.numerics.findings import Number, RefusedPartError, attribute_findings, refuse
from gearwhine.numerics.progress import Progress, silent

_WORKERS = Number(at_least=1, whole=True, optional=True)


class FolderOptions(TypedDict, total=False):
    """Options of a study of many solutions; one in the same folder is resumed.

    Attributes
    ----------
    folder : path
        Folder of the solutions; those that it holds already are not solved again.
    workers : int, optional
        Number of processes (default: number of cores).
    scheduler : str, optional
        Address of a running Dask scheduler; its workers replace the local ones.
    fresh : bool
        Solve again the solutions and modes that the folder holds.
    """

    folder: Required[str | os.PathLike[str]]
    workers: Annotated[int | None, _WORKERS]
    scheduler: str | None
    fresh: bool


@dataclass(frozen=True)
class StudyFolder:
    """Folder of a study of many solutions, with who solves them.

    Attributes
    ----------
    path : path
        Folder of the solutions; those that it holds already are not solved again.
    workers : int, optional
        Number of processes; as many as cores by default, where that is worth their start.
    scheduler : str, optional
        Address of a running Dask scheduler, whose workers are used instead, see :func:`gearwhine.workers.connected`.
    fresh : bool
        Whether to solve all anew.
    progress : callable
    """

    path: Path
    workers: int | None = None
    scheduler: str | None = None
    fresh: bool = False
    progress: Progress = silent

    def __post_init__(self) -> None:
        """Refuse a number of processes that is none."""
        refuse(attribute_findings(("study folder", ""), self, workers=_WORKERS), RefusedPartError)
