"""Names: those that look alike, whatever characters they are made of, and those to choose from."""

import unicodedata
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from functools import lru_cache

# Cyrillic and Greek letters with the look of Latin ones (Unicode TS 39, confusables), most of them capital.
_LOOKS = dict(
    zip(
        "АВЕЗКМНОРСТХУІЈЅаеорсухіјѕԁһӏґвкмнтΑΒΕΖΗΙΚΜΝΟΡΤΥΧαικνορυχγ",
        "ABE3KMHOPCTXYIJSaeopcyxijsdhlrbkmhtABEZHIKMNOPTYXaiknopuxy",
        strict=True,
    )
)


@lru_cache(maxsize=4096)
def look_of(name: str) -> str:
    """Return what a reader sees of a name: letters of other scripts as the Latin ones that they look like.

    Composed and decomposed forms are one (NFKC), characters without a width are left out, and dashes and blanks of any
    kind are the plain ones.
    """
    text = unicodedata.normalize("NFKC", name)
    seen = []
    for character in text:
        category = unicodedata.category(character)
        if category in ("Cf", "Cc"):
            continue
        if category == "Pd":
            character = "-"
        elif category == "Zs":
            character = " "
        seen.append(_LOOKS.get(character, character))
    return " ".join("".join(seen).split())


def has_hidden_characters(name: str) -> bool:
    """Whether a name has characters that nobody sees: without a width, of control, or that no script has."""
    return any(unicodedata.category(character) in ("Cf", "Cc", "Co", "Cn", "Zl", "Zp") for character in name)


def twin_of(name: str, names: Iterable[str]) -> str | None:
    """Return another name that looks the same as this one; None where there is none."""
    look = look_of(name)
    return next((other for other in names if other != name and look_of(other) == look), None)


def did_you_mean(word: str, candidates: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for the nearest candidate, or nothing."""
    near = get_close_matches(word, list(candidates), n=1, cutoff=0.6)
    return f"; did you mean {near[0]!r}?" if near else ""


_MOST_NAMES = 12


def one_of(what: str, word: str, names: Sequence[str]) -> str:
    """Return ``what (a, b, c, and 5 more)`` with the names to choose from, and the nearest to a word among them all."""
    further = len(names) - _MOST_NAMES
    listed = ", ".join(names[:_MOST_NAMES]) + (f", and {further} more" if further > 0 else "")
    return f"{what} ({listed or 'there is none'}){did_you_mean(word, names)}"
