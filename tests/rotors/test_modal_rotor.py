"""The rotor reduced to modes and vectors: exact at its ports, and in modal form what its bearings are."""

import math

import numpy as np
import pytest

from gearwhine.rotors import (
    Bearing,
    Coupling,
    Disc,
    ModalRotor,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    modal_rotor,
    solve_axial_modes,
    solve_lateral_modes,
    solve_torsional_modes,
    solve_whirl,
)
from gearwhine.rotors.modes.residual_modes import add_rod_attachment_modes

STEEL = ShaftMaterial.from_poisson_ratio(2.1e11, 0.3, 7850.0)
BAR = Segment(0.25, 0.05, 0.0, STEEL)
SHAFT = Rotor("shaft", [BAR] * 4, [Disc(0.25, 12.0, 0.09, 0.05), Disc(1.0, 8.0, 0.05, 0.03)])
CROSSED = np.array([[4e7, 6e6], [-3e6, 5e7]])
TILTING = np.diag([4e7, 5e7, 2e7, 3e4, 2e4])
BEARINGS = (
    Bearing("left", 0.0, CROSSED, np.diag([800.0, 500.0])),
    Bearing("right", 0.75, TILTING, np.diag([300.0, 400.0, 0.0, 2.0, 3.0])),
)


def test_modal_matrices_give_the_whirl_of_the_whole_rotor() -> None:
    """Assembled by hand from its parts, the modal rotor has the eigenvalues of the exact solution."""
    speed = 300.0
    reduced = modal_rotor(SHAFT, BEARINGS, count=14, gears_at=[0.25])
    squared = np.tile(reduced.lateral.frequencies**2, 2)
    stiffness = np.diag(squared) + reduced.compensation + reduced.cross_coupling
    damping = speed * reduced.gyroscopic + reduced.bearing_damping
    size = len(squared)
    values = np.linalg.eigvals(np.block([[np.zeros((size, size)), np.eye(size)], [-stiffness, -damping]]))
    found = np.sort_complex(values[values.imag > 1.0])[np.argsort(np.abs(np.sort_complex(values[values.imag > 1.0])))]
    exact = solve_whirl(SHAFT, BEARINGS, speed, count=6).eigenvalues
    assert np.abs(found[:6] - exact).max() < 2e-5 * np.abs(exact[-1])


def test_compensation_and_averaged_stiffness_are_the_bearings_own() -> None:
    """The springs that the modes hold and the compensation make up the bearings' direct stiffness."""
    reduced = modal_rotor(SHAFT, BEARINGS, count=6)
    lateral = reduced.lateral
    whole = reduced.compensation + reduced.cross_coupling + np.kron(np.eye(2), lateral.support_matrix)
    expected = np.zeros_like(whole)
    for bearing in BEARINGS:
        displacement, slope = (part[:, 0] for part in lateral.evaluate([bearing.at]))
        k = bearing.spatial_stiffness
        expected += np.kron(k[:2, :2], np.outer(displacement, displacement))
        # Slope in x is the rotation about y, in y minus that about x.
        tilt = np.array([[k[4, 4], -k[4, 3]], [-k[3, 4], k[3, 3]]])
        expected += np.kron(tilt, np.outer(slope, slope))
    assert np.abs(whole - expected).max() < 1e-9 * np.abs(expected).max()
    assert np.array_equal(reduced.gyroscopic, -reduced.gyroscopic.T)


def test_static_error_is_what_the_vectors_repair() -> None:
    """A simply supported bar: the compliance under its middle is L³/48EI + L/4κGA with the vectors."""
    pins = [Bearing.isotropic(name, at, 1e14) for name, at in (("left", 0.0), ("right", 1.0))]
    reduced = modal_rotor(Rotor("bar", [BAR] * 4), pins, count=3, gears_at=[0.5])
    section = BAR.section(0.5)
    exact = 1.0 / (48.0 * section.bending_stiffness) + 1.0 / (4.0 * section.shear_stiffness)
    shares = (reduced.lateral.evaluate([0.5])[0][:, 0] / reduced.lateral.frequencies) ** 2
    assert shares.sum() == pytest.approx(exact, rel=1e-8)
    # At the pins the modes lack nearly everything.
    assert reduced.static_error > 0.9
    assert 1.0 - shares[:3].sum() / exact < reduced.static_error


def test_attached_torques_make_the_static_twist_exact() -> None:
    """Opposite torques at two places of a free shaft twist the length between them by M L / GJ."""
    shaft = Rotor("shaft", [BAR] * 4, [Disc(0.0, 1.0, 0.02, 0.01), Disc(1.0, 1.0, 0.05, 0.03)])
    modes = solve_torsional_modes(shaft, count=3)
    attached = add_rod_attachment_modes(modes, [0.25, 0.75])
    assert attached.count == 5
    assert np.array_equal(attached.frequencies[:3], modes.frequencies)

    def twist(count: int) -> float:
        angles = attached.evaluate([0.25, 0.75])[1:count]
        return float((((angles[:, 1] - angles[:, 0]) / attached.frequencies[1:count]) ** 2).sum())

    exact = 0.5 / BAR.section(0.0).torsional_stiffness
    assert twist(3) < 0.99 * exact
    assert twist(5) == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize(
    "discs", [[], [Disc(0.0, 30.0, 0.5, 0.3)], [Disc(0.3, 1e3, 2.0, 1.0), Disc(1.0, 0.1, 1e-4, 1e-4)]]
)
@pytest.mark.parametrize("length", [0.2, 0.05, 0.015])
def test_free_shaft_without_an_elastic_mode_below_the_limit_has_its_exact_compliance(
    length: float, discs: list[Disc]
) -> None:
    """Opposite forces along the axis, or torques, at two places of a short shaft: F l / EA and M l / GJ."""
    bar = Segment(length, 0.4 * length, 0.0, STEEL)
    placed = [Disc(disc.at * length, disc.mass, disc.polar_inertia, disc.diametral_inertia) for disc in discs]
    rotor, section = Rotor("short", [bar], placed), bar.section(0.5)
    for modes, stiffness in (
        (solve_axial_modes(rotor, frequency_limit=500.0), section.axial_stiffness),
        (solve_torsional_modes(rotor, count=1), section.torsional_stiffness),
    ):
        assert modes.count == 1
        places = np.array([0.1, 0.5, 0.8]) * length
        attached = add_rod_attachment_modes(modes, places.tolist())
        motion = attached.evaluate(places)[1:] / attached.frequencies[1:, None]
        for one, other in ((0, 1), (0, 2), (1, 2)):
            compliance = ((motion[:, other] - motion[:, one]) ** 2).sum()
            assert compliance * stiffness / (places[other] - places[one]) == pytest.approx(1.0, abs=1e-6)


def test_free_shafts_on_a_soft_coupling_have_their_exact_compliance_without_an_elastic_mode() -> None:
    """Their first elastic frequency is a fortieth of that of a bar: heavy discs on a spring."""
    bar = Segment(0.1, 0.03, 0.0, STEEL)
    soft = bar.section(0.5).axial_stiffness / (100.0 * bar.length)
    coupling = Coupling(0.05, 1e8, 1e4, torsional_stiffness=1e4, axial_stiffness=soft)
    rotor = Rotor("coupled", [bar, coupling, bar], [Disc(at, 50.0, 0.1, 0.1) for at in (0.0, 0.25)])
    places = [0.02, 0.1, 0.15, 0.23]
    attached = add_rod_attachment_modes(solve_axial_modes(rotor, count=1), places)
    motion = attached.evaluate(places)[1:] / attached.frequencies[1:, None]
    shaft = 0.08 / bar.section(0.5).axial_stiffness
    for one, other, exact in ((0, 1, shaft), (1, 2, 1.0 / soft), (0, 3, 2.0 * shaft + 1.0 / soft)):
        assert ((motion[:, other] - motion[:, one]) ** 2).sum() / exact == pytest.approx(1.0, abs=1e-7)


def test_torsional_set_stays_orthonormal_with_its_vectors() -> None:
    attached = add_rod_attachment_modes(solve_torsional_modes(SHAFT, count=4), [0.3, 0.9, 0.9])
    mass, stiffness = attached.fields.energies(attached.mixture)
    assert np.abs(mass - np.eye(attached.count)).max() < 1e-9
    off = stiffness - np.diag(np.diag(stiffness))
    assert np.abs(off).max() < 1e-7 * np.diag(stiffness).max()


def test_limit_keeps_every_mode_below_it() -> None:
    reduced = modal_rotor(SHAFT, BEARINGS, frequency_limit=2.0 * math.pi * 3000.0)
    assert reduced.lateral.certificate.complete
    assert reduced.torsional.certificate.complete
    assert reduced.lateral.certificate.limit == pytest.approx(2.0 * math.pi * 3000.0)


def test_moments_and_thrusts_have_vectors_where_they_are_asked_for() -> None:
    """A bar clamped in all but name: slope under a moment at its end, stretch between opposite forces along it."""
    held = [Bearing("end", 0.0, np.diag([1e14, 1e14, 1e14, 1e12, 1e12]), np.zeros((5, 5)))]
    rotor = Rotor("bar", [BAR] * 4)
    few = modal_rotor(rotor, held, count=3)
    asked = modal_rotor(rotor, held, count=3, moments_at=[1.0], thrusts_at=[0.5, 1.0])
    section = BAR.section(0.5)

    def slope(reduced: ModalRotor) -> float:
        return float(((reduced.lateral.evaluate([1.0])[1][:, 0] / reduced.lateral.frequencies) ** 2).sum())

    exact = 1.0 / section.bending_stiffness  # M L / EI over one metre
    assert slope(asked) == pytest.approx(exact, rel=1e-6)
    assert slope(few) < 0.995 * exact

    def stretch(reduced: ModalRotor) -> float:
        assert reduced.axial is not None
        motions = reduced.axial.evaluate([0.5, 1.0])[1:]
        return float((((motions[:, 1] - motions[:, 0]) / reduced.axial.frequencies[1:]) ** 2).sum())

    # Opposite forces at the ends of one half of a free bar stretch that half by F L / EA.
    exact = 0.5 / section.axial_stiffness
    assert stretch(asked) == pytest.approx(exact, rel=1e-6)
    assert stretch(few) < 0.99 * exact


def test_a_higher_limit_never_keeps_less() -> None:
    """Below the first mode and up: at least four modes, and never fewer at a higher limit."""
    sizes = []
    for hertz in (1.0, 30.0, 100.0, 300.0, 1000.0, 3000.0, 9000.0):
        reduced = modal_rotor(SHAFT, BEARINGS, frequency_limit=2.0 * math.pi * hertz)
        sizes.append((reduced.lateral.certificate.found, reduced.torsional.certificate.found))
    assert sizes[0] == (4, 4)
    assert sizes == sorted(sizes)
    assert sizes[-1] > (4, 4)


def test_no_mode_below_a_limit_is_an_empty_set() -> None:
    modes = solve_lateral_modes(SHAFT, [bearing.mean_support for bearing in BEARINGS], frequency_limit=1.0)
    assert modes.count == 0
    assert modes.certificate.complete
    assert modes.displacement.shape == (0, len(modes.stations))
    assert modes.support_matrix.shape == (0, 0)


def test_a_limit_or_a_count() -> None:
    with pytest.raises(RotorError, match="one of the two"):
        modal_rotor(SHAFT, BEARINGS)
    with pytest.raises(RotorError, match="one of the two"):
        modal_rotor(SHAFT, BEARINGS, count=3, frequency_limit=1e4)
