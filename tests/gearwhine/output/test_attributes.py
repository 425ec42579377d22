"""Attributes of solved objects by name: their values, and the long names that their docstrings give."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.output.attributes import meaning_at, meaning_of, value_at
from gearwhine.output.dataset import arrays_of
from gearwhine.output.quantity import HERTZ, RPM, Quantity, document_of, factor_of, unit_of
from gearwhine.results.gears import GEARS
from gearwhine.results.rotors import ROTORS

pytestmark = pytest.mark.usefixtures("few_reliefs_tried")


@dataclass(frozen=True)
class Part:
    """A part.

    Attributes
    ----------
    frequency : float
        Natural frequency of the part [rad/s]; 0 where it is free.
    width, height : ndarray, shape (n,)
        Sides of the part [m], see :class:`gearwhine.rotors.Shaft`. Both are outer ones.
    bare : float
    """

    frequency: float
    width: float = 0.0
    height: float = 0.0
    bare: float = 0.0

    @property
    def speed(self) -> float:
        """Speed ``n`` at rest [rad/s], shape (n, 2).

        It has a second paragraph.
        """
        return 2.0 * self.frequency

    @cached_property
    def frequency_hz(self) -> float:
        """Frequency of ISO 1.5 in hertz [Hz]."""
        return 7.0


class Heavier(Part):
    """A part with more to it."""


class Pair(NamedTuple):
    """Parts beside each other.

    Attributes
    ----------
    first : Part
        The first one.
    """

    first: Part
    second: Part | None


@pytest.mark.parametrize(
    ("attribute", "meaning"),
    [
        ("frequency", "natural frequency of the part"),
        ("width", "sides of the part, see Shaft"),
        ("height", "sides of the part, see Shaft"),
        ("speed", "speed n at rest"),
        ("frequency_hz", "frequency of ISO 1.5 in hertz"),
        ("bare", ""),
        ("none", ""),
    ],
)
def test_the_first_sentence_is_the_meaning(attribute: str, meaning: str) -> None:
    assert meaning_of(Part, attribute) == meaning
    assert meaning_of(Heavier, attribute) == meaning


def test_a_path_goes_through_attributes_and_places_and_ends_where_nothing_is() -> None:
    pair = Pair(Part(3.0), None)
    assert value_at(pair, ".") is pair
    assert value_at(pair, "first.frequency") == value_at(pair, "0.frequency") == 3.0
    assert value_at(pair, "second.frequency") is None
    assert meaning_at(pair, "first") == "the first one"
    assert meaning_at(pair, "first.frequency") == "natural frequency of the part"
    assert meaning_at(pair, "0") == meaning_at(pair, "second.frequency") == ""
    with pytest.raises(AttributeError):
        value_at(pair, "third")


def test_a_quantity_has_the_unit_of_its_key_and_is_converted_to_it() -> None:
    part = Part(HERTZ * 5.0, width=0.25)
    fields = (
        Quantity("frequency_hz", "frequency", "a"),
        Quantity("same_hz", "frequency_hz", "b"),
        Quantity("speed_rpm", name="c"),
        Quantity("width_m"),
        Quantity("", "frequency", "d", unit="rad s-1"),
        Quantity("bare", lambda _: None, optional=True),
    )
    assert document_of(fields, part) == {"frequency_hz": 5.0, "same_hz": 7.0, "speed_rpm": 600.0, "width_m": 0.25}
    units = {name: attributes["units"] for name, (_, _, attributes) in arrays_of(fields, part).items()}
    assert units == {"a": "Hz", "b": "Hz", "c": "rpm", "d": "rad s-1"}
    assert arrays_of(fields, part)["d"][1] == pytest.approx(10.0 * np.pi)
    assert arrays_of(fields, part)["c"][1] == pytest.approx(20.0 * np.pi * RPM)


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("force_n", "N"),
        ("stiffness_n_per_m", "N/m"),
        ("moment_n_m.0", "N m"),
        ("amplitude_m_per_s2", "m/s2"),
        ("level_db_a", "dB"),
        ("transmission_error_m.mean", "m"),
        ("number", ""),
        ("n", ""),
    ],
)
def test_the_end_of_a_key_is_its_unit(key: str, unit: str) -> None:
    assert unit_of(key) == unit


def test_a_heading_s_unit_gives_the_factor() -> None:
    assert factor_of("mean_stiffness_n_per_m", "stiffness\nunder load [N/µm]") == 1e-6
    assert factor_of("largest_m", "largest [µm, peak]") == 1e6
    assert factor_of("share", "share [%]") == 100.0
    assert factor_of("error_percent", "error [%]") == 1.0
    assert factor_of("force_n", "force [N]") == factor_of("force_n", "force") == 1.0


def test_every_array_of_numbers_has_a_long_name() -> None:
    study = gw.load("helical-pair")
    for fields, solved in ((GEARS, study.gears().solved), (ROTORS, study.rotors().solved)):
        for name, (_, values, attributes) in arrays_of(fields, solved).items():
            assert attributes.get("long_name") or np.asarray(values).dtype.kind not in "fi", name
