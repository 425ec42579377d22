"""Modes near the edges of the measured band, found in noisy responses of a housing that has modes beyond it, too.

The housing is the free box of the tests. Its elastic mode 12 stands at 0.9924 of the highest measured frequency, as a
mode of 3175.7 Hz does in responses up to 3200 Hz, and there are twelve more above. Responses are the sum over all of
its modes, Σ (iω)² φ φᵀ / (ω₀² - ω² + 2iζω₀ω), with noise; so their shapes are known.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.housing import Housing, HousingModes, Material
from gearwhine.housing.measured import MeasuredGeometry, MeasuredResponses, identify_modes
from gearwhine.housing.measured.common_denominator import common_denominator_poles
from gearwhine.housing.modal_test import ModalTest, compare_test, comparison_warnings
from gearwhine.meshes import Mesh

RIGID, AT_THE_EDGE, BEYOND = 6, 12, 12
SHARE_OF_THE_BAND = 3175.7 / 3200.0


class Measurement(NamedTuple):
    """A housing, and what its responses are made of."""

    housing: HousingModes
    geometry: MeasuredGeometry
    shapes: npt.NDArray[np.float64]
    natural: npt.NDArray[np.float64]
    ratios: npt.NDArray[np.float64]
    lines: npt.NDArray[np.float64]
    hit: int

    def responses(self, seed: int | None, noise: float = 0.01, lines: slice = slice(None)) -> MeasuredResponses:
        """Accelerances at all degrees of freedom by one force; noise as a part of their root mean square."""
        omega = self.lines[lines]
        squared = self.natural[:, None] ** 2 - omega**2 + 2j * (self.ratios * self.natural)[:, None] * omega
        values = -np.einsum("md,m,mw->dw", self.shapes, self.shapes[:, self.hit], omega**2 / squared)
        if seed is not None:
            rng = np.random.default_rng(seed)
            size = noise * np.sqrt(np.mean(np.abs(values) ** 2) / 2.0)
            values += size * (rng.normal(size=values.shape) + 1j * rng.normal(size=values.shape))
        point, direction = self.geometry.points[[self.hit]], self.geometry.directions[[self.hit]]
        return MeasuredResponses(self.geometry, point, direction, omega, values[:, None])


@pytest.fixture(scope="module")
def measurement(box: Mesh, steel: Material) -> Measurement:
    """Twenty points of the box with three directions each, hit where no mode of the band is at rest; 1600 lines."""
    housing = Housing(box, steel).modes(count=RIGID + AT_THE_EDGE + BEYOND)
    low, high = box.points.min(axis=0), box.points.max(axis=0)
    outer = np.flatnonzero(np.any(np.isclose(box.points, low) | np.isclose(box.points, high), axis=1))
    nodes = outer[:: len(outer) // 20][:20]
    labels = tuple(str(node + 1) for node in nodes)
    geometry = MeasuredGeometry(labels, box.points[nodes], np.repeat(np.arange(20), 3), np.tile(np.eye(3), (20, 1)))
    natural = np.where(np.arange(RIGID + AT_THE_EDGE + BEYOND) < RIGID, 0.0, housing.modes.frequencies)
    highest = natural[RIGID + AT_THE_EDGE - 1] / SHARE_OF_THE_BAND
    ratios = np.random.default_rng(0).uniform(0.003, 0.008, len(natural))
    shapes = housing.modes.shapes[:, nodes].reshape(len(natural), -1)
    hit = int(np.argmax(np.abs(shapes[RIGID : RIGID + AT_THE_EDGE]).min(axis=0)))
    return Measurement(housing, geometry, shapes, natural, ratios, highest * np.arange(1, 1601) / 1600, hit)


def macs(found: npt.NDArray[np.complex128], true: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    norms = np.linalg.norm(found, axis=1) * np.linalg.norm(true, axis=1)
    return np.asarray(np.abs((found * true).sum(axis=1) / norms) ** 2)


@pytest.mark.parametrize("seed", range(5))
def test_a_mode_at_the_end_of_the_band_is_found_and_spoils_no_other(measurement: Measurement, seed: int) -> None:
    """Every mode of the band is found with its shape, and paired with itself."""
    modes = identify_modes(measurement.responses(seed)).modes
    in_band = slice(RIGID, RIGID + AT_THE_EDGE)
    np.testing.assert_allclose(modes.frequencies, measurement.natural[in_band], rtol=1e-3)
    inner = modes.frequencies < 0.98 * measurement.lines[-1]
    assert np.count_nonzero(~inner) == 1
    shares = macs(modes.shapes, measurement.shapes[in_band])
    assert shares[inner].min() > 0.9999
    assert shares[~inner] > 0.999  # of a mode whose neighbour, 0.3 % beyond the band, is a residual
    pairs = compare_test(measurement.housing, ModalTest(modes)).comparison.pairs
    assert [(pair.measured_mode, pair.mode) for pair in pairs] == [
        (number, RIGID + number) for number in range(1, AT_THE_EDGE + 1)
    ]


def test_the_seventh_digit_of_the_responses_decides_nothing(measurement: Measurement) -> None:
    given = measurement.responses(1)
    rounded = np.array([complex(f"{value.real:.6e}{value.imag:+.6e}j") for value in given.values.ravel()])
    other = MeasuredResponses(
        given.geometry,
        given.reference_points,
        given.reference_directions,
        given.frequencies,
        rounded.reshape(given.values.shape),
    )
    one, two = identify_modes(given).modes, identify_modes(other).modes
    np.testing.assert_allclose(two.frequencies, one.frequencies, rtol=1e-7)
    np.testing.assert_allclose(two.shapes, one.shapes, atol=1e-4)


def test_poles_beyond_the_band_take_part_and_are_no_modes(measurement: Measurement) -> None:
    """The band ends between two modes: the upper one is a residual, and the lower one has its shape."""
    ends = RIGID + AT_THE_EDGE - 1
    below, above = measurement.natural[ends - 1 : ends + 1]
    limit = 0.1 * below + 0.9 * above
    count = int(np.searchsorted(measurement.lines, limit))
    found = identify_modes(measurement.responses(0, 0.001, slice(0, count)))
    np.testing.assert_allclose(found.modes.frequencies[-1], below, rtol=1e-4)
    assert np.abs(np.abs(found.beyond) / above - 1.0).min() < 0.01
    assert macs(found.modes.shapes, measurement.shapes[RIGID:ends]).min() > 0.999


def test_a_band_within_the_responses_leaves_no_mode_beside_it_in_the_shapes(measurement: Measurement) -> None:
    """Of two modes the band holds the lower one; the other stands on its edge, just outside."""
    ends = RIGID + AT_THE_EDGE - 1
    below, above = measurement.natural[ends - 1 : ends + 1]
    found = identify_modes(measurement.responses(0), band=(0.97 * below, 0.999 * above))
    np.testing.assert_allclose(found.modes.frequencies, [below], rtol=1e-4)
    assert macs(found.modes.shapes, measurement.shapes[ends - 1 : ends]).min() > 0.999


def test_modes_may_stand_at_the_lower_end_of_the_band(measurement: Measurement) -> None:
    """Responses from 0.995 of a mode on, far above 0: a denominator of real coefficients knows no such band."""
    first = int(np.searchsorted(measurement.lines, 0.995 * measurement.natural[RIGID + 3]))
    found = identify_modes(measurement.responses(0, lines=slice(first, None))).modes
    np.testing.assert_allclose(found.frequencies, measurement.natural[RIGID + 3 : RIGID + AT_THE_EDGE], rtol=1e-3)
    inner = found.frequencies < 0.98 * measurement.lines[-1]
    inner[0] = False
    assert macs(found.shapes, measurement.shapes[RIGID + 3 : RIGID + AT_THE_EDGE])[inner].min() > 0.99


@pytest.mark.parametrize(("half_widths", "cut"), [(0.5, [AT_THE_EDGE - 1]), (1.3, [])])
def test_an_edge_that_cuts_a_resonance_is_warned_of(
    measurement: Measurement, half_widths: float, cut: list[int]
) -> None:
    """The band ends so many half-power half-widths ζω beyond mode 11, and 300 Hz before the next."""
    last = RIGID + AT_THE_EDGE - 2
    end = measurement.natural[last] * (1.0 + half_widths * measurement.ratios[last])
    count = int(np.searchsorted(measurement.lines, end))
    modes = identify_modes(measurement.responses(0, lines=slice(0, count))).modes
    comparison = compare_test(measurement.housing, ModalTest(modes)).comparison
    warnings = comparison_warnings(comparison, measurement.housing.modes, modes)
    assert [one["modes"] for one in warnings if one["name"] == "edge of the band"] == ([cut] if cut else [])


def test_poles_stand_on_both_sides_of_both_edges() -> None:
    """Lines from 500 to 1000 Hz, modes at 494, 502, 730, 998 and 1004 Hz: on the full circle the edges would meet."""
    hertz = np.arange(500.0, 1001.0)
    natural, ratio = 2.0 * np.pi * np.array([494.0, 502.0, 730.0, 998.0, 1004.0]), 0.004
    poles = natural * complex(-ratio, np.sqrt(1.0 - ratio**2))
    residues = np.random.default_rng(0).normal(size=(12, 5)) * natural
    s = 2j * np.pi * hertz
    responses = np.einsum("rp,pw->rw", residues, 1.0 / (s - poles[:, None]) + 1.0 / (s - poles.conj()[:, None]))
    (*_, found) = common_denominator_poles(responses, 2.0 * np.pi * 500.0, 2.0 * np.pi, 20)
    apart = np.abs(found[:, None] / poles - 1.0).min(axis=0)
    assert apart[1:4].max() < 2e-5
    assert apart[[0, 4]].max() < 2e-4
