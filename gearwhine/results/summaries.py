"""Summaries of commands in a results folder: which analyses a document holds, its own or as a part."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from gearwhine.output.sections import Document

_NOTHING: Document = {}


@dataclass(frozen=True)
class Summary:
    """Document of a command, and the analyses that it holds; a part that it does not have is an empty document.

    The document of ``run`` has an analysis under a key; that of the analysis's own command is the analysis itself.

    Attributes
    ----------
    document : Document
    """

    document: Document

    def _part(self, key: str, *own: str) -> Document:
        """Return the part under a key, or the document itself where it has keys of the analysis's own."""
        part = self.document.get(key, self.document if own and all(name in self.document for name in own) else _NOTHING)
        return part if isinstance(part, dict) else _NOTHING

    @property
    def housing(self) -> Document:
        """Modes of the housing."""
        return self._part("housing", "certificate", "mesh")

    @property
    def load(self) -> Document:
        """Operating point."""
        return self._part("load", "gear_pairs", "seats")

    @property
    def system(self) -> Document:
        """Modes of the coupled system."""
        return self._part("system", "stability")

    @property
    def sound(self) -> Document:
        """Sound of a motion."""
        return self._part("sound", "total_db_a")

    @property
    def compared(self) -> Document:
        """Comparison of measured modes with the model's."""
        return self._part("compare", "pairing")

    @property
    def rotors(self) -> Sequence[Document]:
        """Rotors on grounded bearings that have a proof of their modes."""
        return [rotor for rotor in self.document.get("rotors", ()) if rotor.get("certificate")]

    @property
    def motions(self) -> Sequence[Document]:
        """Steady motions."""
        return list(self.document.get("motions", ()))

    @property
    def points(self) -> Sequence[Document]:
        """Points of a sweep."""
        return list(self.document.get("points", ())) if self.document.get("command") == "sweep" else []

    @property
    def energy_error(self) -> float | None:
        """Part of the energy that is missing from the balance of a transient."""
        error: float | None = self.document.get("energy_error")
        return error

    @property
    def steps(self) -> int:
        """Time steps of a transient."""
        return int(self.document.get("steps", 0))

    @property
    def sensors(self) -> Sequence[Document]:
        """Sensors of a transient."""
        return list(self.document.get("sensors", ()))

    @property
    def lines(self) -> Iterator[tuple[Sequence[Document], str]]:
        """Sensors of each motion with the key of their lines; a spectrum over a run has no lines."""
        if self.document.get("run") is None:
            yield self.sensors, "peaks"
        for motion in self.motions:
            yield motion["sensors"], "lines"

    @property
    def warnings(self) -> Sequence[Document]:
        """Warnings of the command."""
        return [warning for warning in self.document.get("warnings", ()) if isinstance(warning, dict)]
