"""Remarks on properties that a file format cannot hold, each made once for all elements concerned."""

from collections import defaultdict


class Remarks:
    """Collects remarks on elements; equal texts become one."""

    def __init__(self) -> None:
        self._places: defaultdict[str, list[str]] = defaultdict(list)

    def add(self, place: str, text: str) -> None:
        """Add a remark on a place."""
        if place not in self._places[text]:
            self._places[text].append(place)

    def sentences(self) -> tuple[str, ...]:
        """One sentence for each text, in the order in which they came up."""
        return tuple(
            f"{places[0]}{f' and {len(places) - 1} more' if places[1:] else ''}: {text}"
            for text, places in self._places.items()
        )
