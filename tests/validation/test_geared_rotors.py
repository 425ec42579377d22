"""Geared rotors from the literature.

Rao, Shiau & Chang, Theoretical analysis of lateral response due to torsional excitation of geared rotors (Mechanism
and Machine Theory 33, 1998), also in Friswell, Penny, Garvey & Lees, Dynamics of Rotating Machines (Cambridge, 2010):
a turbo-generator of two shafts. Printed with one beam element per span; the second row was computed apart from this
toolkit with eight elements per span, whose own error is 1.1e-3 % to 0.04 % in these modes.

Friswell et al., torsion of a geared branch: a motor drives a shaft with two rotors through gears of equal
size in rigid contact.

Torsion of other geared trains and of a long string, with data and frequencies as openTorsion holds itself against them
(github.com/Aalto-Arotor/openTorsion, opentorsion/tests/tests.py and examples/marine_steam_turbine_forced_response.py):
Friswell et al., example 9.6.3 and section 9.9; Chen & Gunter, Introduction to Dynamics of Rotor-Bearing Systems (2001),
example 8.1.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling import (
    CoupledMachine,
    CoupledSystem,
    GearMesh,
    MountedBearing,
    MountedGear,
    assemble_machine,
    coupled_modes,
    stability,
)
from gearwhine.coupling.gears import ConstantStiffness, Gear, GearPairGeometry, ToothContact, tooth_contact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.gears.geometry.involute import module_from_base_radius
from gearwhine.coupling.linear.complex_modes import CoupledModes
from gearwhine.coupling.linear.frequency_response import mesh_error_response
from gearwhine.coupling.machine.components import Component, rotor_component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.statics.mean_mesh import contact_at
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import (
    Bearing,
    Disc,
    ModalRotor,
    Rotor,
    Segment,
    ShaftMaterial,
    solve_lateral_modes,
    solve_torsional_modes,
)
from gearwhine.rotors.modes.residual_modes import add_attachment_modes
from gearwhine.rotors.modes.torsional_and_axial import solve_torsional_chain

Published = Callable[..., None]

TURBO_GENERATOR = "Rao, Shiau & Chang (1998), turbo-generator of two geared shafts"
REMARK = (
    "Printed with one beam element per span, which is coarse: ours, from exact shaft modes, lie below, as they must. "
    "The values beside ours were computed apart from this toolkit with eight of ROSS's elements per span."
)
BRANCH = "Friswell, Penny, Garvey & Lees (2010), torsion of a geared branch"

TWO_SHAFTS = "Friswell, Penny, Garvey & Lees (2010), example 9.6.3, an engine geared to two shafts"
STRING = "Friswell, Penny, Garvey & Lees (2010), section 9.9, string of 800 m in torsion"
STEAM_TURBINE = "Gunter & Chen (2001), example 8.1, marine steam turbine of two geared branches"

STEEL = ShaftMaterial(207e9, 79.5e9, 7800.0)
SPEED = 1500.0 * 2.0 * np.pi / 60.0
ONE_ELEMENT = [11.641, 12.284, 17.268, 18.458, 23.956, 37.681, 49.889, 50.861, 56.248, 57.752, 59.188, 63.113, 74.203]
EIGHT_ELEMENTS = [
    *(10.7504, 11.3214, 16.9663, 18.0645, 23.5118, 34.999, 43.137, 48.635, 53.651, 55.842, 56.539, 60.503, 73.125),
]


def turbo_generator(
    sense: int = 1, centre_line: float = 0.0, lateral: float = 3e3, torsion: float = 2e4
) -> CoupledMachine:
    """The machine, its first shaft turning in a sense, with bases up to frequency limits [rad/s]."""
    spans = ([(0.1, 0.3), (4.24, 0.3), (1.16, 0.22), (0.3, 0.22)], [(0.3, 0.15), (5.0, 0.15), (0.1, 0.15)])
    discs = (
        [Disc(0.1, 525.7, 32.2, 16.1), Disc(4.34, 116.04, 6.23, 3.115), Disc(5.8, 726.4, 113.9, 56.95)],
        [Disc(0.0, 5.0, 0.004, 0.002), Disc(5.3, 7.45, 0.149, 0.0745)],
    )
    places, stiffnesses, gears_at = ((0.0, 5.5), (0.3, 5.4)), ((183.9e6, 200.4e6), (10.1e6, 41.6e6)), (5.8, 0.0)
    components, bearings = [], []
    for i, name in enumerate(("generator", "turbine")):
        rotor = Rotor(name, [Segment(length, diameter, 0.0, STEEL) for length, diameter in spans[i]], discs[i])
        held = [Bearing(f"{name} {at}", at, np.diag(stiffnesses[i]), 3e3 * np.eye(2)) for at in places[i]]
        modes = solve_lateral_modes(rotor, [bearing.mean_support for bearing in held], frequency_limit=lateral)
        basis = add_attachment_modes(
            modes,
            forces_at=[*places[i], gears_at[i]],
            moments_at=[disc.at for disc in discs[i]],
        )
        twist = solve_torsional_modes(rotor, frequency_limit=torsion)
        # The gears stand opposite each other.
        components.append(rotor_component(name, ModalRotor(basis, twist), start=gears_at[0] - gears_at[i]))
        bearings += [MountedBearing(bearing, name, None) for bearing in held]
    angle = np.radians(22.5)
    wheels = [
        Gear(name, teeth, module_from_base_radius(radius, teeth, angle), angle, face_width=0.1)
        for name, teeth, radius in (("wheel", 328, 0.5086), ("pinion", 23, 0.03567))
    ]
    pair = GearPairGeometry(wheels[0], wheels[1])
    distance = pair.working_centre_distance
    mesh = GearMesh(
        MountedGear("wheel", "generator", gears_at[0], (0.0, 0.0)),
        MountedGear("pinion", "turbine", gears_at[1], (distance * np.cos(centre_line), distance * np.sin(centre_line))),
        pair,
        tooth_contact(pair, ConstantStiffness(1e8)),
    )
    speeds = {"generator": sense * SPEED, "turbine": -sense * SPEED * 328.0 / 23.0}
    return assemble_machine(components, None, speeds=speeds, bearings=bearings, meshes=[mesh])


def oscillating(machine: CoupledMachine) -> FloatArray:
    """Frequencies [Hz] of all but the train's rotation, the lowest 13."""
    modes = coupled_modes(machine.system)
    assert modes.kinds.count("rigid") == 1
    return np.asarray(modes.frequencies_hz[1:14])


def test_turbo_generator(published: Published, remark: Callable[[str, str], None]) -> None:
    remark(TURBO_GENERATOR, REMARK)
    found = oscillating(turbo_generator())
    for number, (value, ours) in enumerate(zip(EIGHT_ELEMENTS, found, strict=True), start=1):
        published(TURBO_GENERATOR, f"mode {number}, eight elements per span", value, ours, "Hz", rel=1e-3)
    np.testing.assert_array_less(found, ONE_ELEMENT)


def test_turbo_generator_turning_the_other_way() -> None:
    # Mirrored in the plane of the shafts the machine is the same, its bearings having no cross terms.
    np.testing.assert_allclose(oscillating(turbo_generator(sense=-1)), oscillating(turbo_generator()), rtol=1e-7)


def test_turbo_generator_basis_is_converged() -> None:
    finer = oscillating(turbo_generator(lateral=6e3, torsion=4e4))
    np.testing.assert_allclose(oscillating(turbo_generator()), finer, rtol=3e-4)


def test_turbo_generator_knows_the_centre_line() -> None:
    # Bearings four times stiffer in y than in x: the second shaft above the first is another machine.
    turned = oscillating(turbo_generator(centre_line=np.pi / 2.0))
    assert np.abs(turned / oscillating(turbo_generator()) - 1.0).max() > 5e-3


def test_turbo_generator_at_an_instant() -> None:
    """Under a load that presses the teeth, contact of an instant: the stiffness being constant, the same modes."""
    machine = turbo_generator()
    pressed = replace(machine.system, load=1e4 * machine.system.contacts[0].direction)
    modes = coupled_modes(pressed, contact_at(pressed, 0.0123))
    np.testing.assert_allclose(modes.frequencies_hz[1:14], oscillating(machine), rtol=1e-9)


def test_turbo_generator_energies() -> None:
    """What the source says of its machine: the lowest modes bend the shafts, and every dashpot only takes."""
    modes = coupled_modes(turbo_generator().system)
    assert modes.certificate.found == modes.certificate.expected
    assert modes.certificate.max_residual < 1e-9
    np.testing.assert_allclose(modes.shares.kinetic.sum(axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(modes.shares.strain[1:].sum(axis=1), 1.0, rtol=1e-9)
    np.testing.assert_allclose(modes.shares.damping.sum(axis=1), modes.damping_ratios, rtol=1e-9, atol=1e-12)
    assert stability(modes).stable
    # The bearings are the only dashpots, and the mesh has none.
    dashpots = np.array([part.kind == "connector" for part in modes.shares.parts])
    assert not modes.shares.damping[:, ~dashpots].any()
    assert np.all(modes.shares.damping[1:, dashpots].sum(axis=1) > 0.0)


def test_turbo_generator_error_finds_its_modes() -> None:
    """At a mode that strains the teeth, the force by a transmission error has a peak: there."""
    machine = turbo_generator()
    modes = coupled_modes(machine.system)
    teeth = np.array([part.kind == "contact" for part in modes.shares.parts])
    strained = 1 + int(np.argmax(modes.shares.strain[1:14, teeth].sum(axis=1)))
    centre = modes.eigenvalues[strained].imag
    w = np.linspace(0.97 * centre, 1.03 * centre, 801)
    force = np.abs(next(iter(mesh_error_response(machine, w, modes=modes).mesh_force.values())))
    assert w[np.argmax(force)] == pytest.approx(centre, rel=2e-3)
    assert force.max() > 2.0 * max(force[0], force[-1])


def geared_chains(
    chains: dict[str, tuple[list[float], list[float]]],
    meshes: list[tuple[str, int, float, str, int, float]],
    stiffness: float,
) -> CoupledModes:
    """Modes in torsion of chains of discs [kg m²] and shafts [N m/rad], geared together.

    A mesh names a chain, its disc and a radius, twice; its stiffness along the line of action is in N/m.
    """
    solved = {name: solve_torsional_chain(*chain) for name, chain in chains.items()}
    components = tuple(
        Component(
            name, ("torsion",) * chain.count, np.diag(chain.frequencies**2), *np.zeros((2, chain.count, chain.count))
        )
        for name, chain in solved.items()
    )
    contact = ToothContact(1.0, piecewise.constant(stiffness, 1.0), piecewise.constant(0.0, 1.0))
    springs = []
    for number, (first, disc, radius, second, mate, mate_radius) in enumerate(meshes):
        arms = {first: radius * solved[first].angle[:, disc], second: mate_radius * solved[second].angle[:, mate]}
        direction = np.concatenate([arms.get(name, np.zeros(chain.count)) for name, chain in solved.items()])
        springs.append(ContactConnector(f"gears {number}", direction, contact, 0.0, 0.0, np.empty((0, 3))))
    load = np.zeros(sum(chain.count for chain in solved.values()))
    rest = (0.0,) * len(components)
    return coupled_modes(CoupledSystem(components, rest, contacts=tuple(springs), load=load))


def test_geared_branch_in_torsion(published: Published) -> None:
    """Rigid contact stands in as a spring 1e5 times as stiff as the shafts, in torsion about the base circles.

    The printed values are those of 50e-6 kg m² in gears: 25e-6 on the motor's shaft, 25e-6 between the two rotors.
    """
    chains = {"motor": ([400e-6, 25e-6], [1e4]), "rotors": ([700e-6, 25e-6, 700e-6], [5e3, 5e3])}
    modes = geared_chains(chains, [("motor", 1, 0.1, "rotors", 1, 0.1)], stiffness=1e11)
    for number, (value, ours) in enumerate(zip([0.0, 425.4, 634.1, 3247.2], modes.frequencies_hz[:4], strict=True)):
        published(BRANCH, f"torsional {number}" if number else "rigid rotation", value, ours, "Hz", abs=0.051)
    assert modes.kinds == ("rigid", "torsion", "torsion", "torsion", "mesh")
    assert modes.where[1] == "rotors"
    assert modes.eigenvalues[0] == 0.0
    # Rigid contact strains nothing; the gears stand still while the two rotors swing against each other.
    np.testing.assert_allclose(modes.shares.strain[1:4, 2], 0.0, atol=1e-4)
    np.testing.assert_allclose(modes.shares.strain[1], [0.0, 1.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(modes.shares.kinetic[1], [0.0, 1.0], atol=1e-9)
    # The two rotors against each other, the gears at rest: √(5e3 / 700e-6).
    assert modes.frequencies_hz[1] == pytest.approx(np.sqrt(5e3 / 700e-6) / (2.0 * np.pi), rel=1e-9)


def test_engine_geared_to_two_shafts(published: Published) -> None:
    """Two pinions of 0.5 m on an engine's shaft drive wheels of 0.8 m."""

    def shaft(diameter: float, length: float) -> float:
        return 68e9 * np.pi / 32.0 * diameter**4 / length

    branch = ([800.0, 450.0], [shaft(0.25, 3.5)])
    chains = {"engine": ([3200.0, 2.0 * 200.0], [shaft(0.2, 2.5)]), "left": branch, "right": branch}
    meshes = [("engine", 1, 0.5, name, 0, 0.8) for name in ("left", "right")]
    found = geared_chains(chains, meshes, stiffness=1e12).frequencies_hz
    for number, (value, ours) in enumerate(zip([10.304, 20.479, 24.423], found[1:4], strict=True), start=1):
        published(TWO_SHAFTS, f"torsional {number}", value, ours, "Hz", abs=0.51e-3)


def test_marine_steam_turbine(published: Published) -> None:
    """Two turbines, each by two reductions, on one propeller; inertias and stiffnesses in lbf in s² and lbf in/rad.

    The ends of quill shafts are discs of no inertia there; 1e-9 of the smallest other is none in these modes.
    """
    inch = 0.11298
    given = {
        "propeller": ([2.454e6, 0.826e6], [826e6]),
        "low pressure, first": ([1e-6, 1.283e4], [203.94e6]),
        "low pressure, turbine": ([1e-6, 1.509e4], [30.51e6]),
        "high pressure, first": ([1e-6, 2.723e4], [24.17e6]),
        "high pressure, turbine": ([1e-6, 2.612e2], [14.26e6]),
    }
    chains = {name: ([inch * i for i in discs], [inch * k for k in shafts]) for name, (discs, shafts) in given.items()}
    meshes = []
    for side, ratio in (("low", 40.0424), ("high", 78.2365)):
        meshes.append(("propeller", 1, 9.4094, f"{side} pressure, first", 0, 1.0))
        meshes.append((f"{side} pressure, first", 1, ratio / 9.4094, f"{side} pressure, turbine", 0, 1.0))
    found = 60.0 * geared_chains(chains, meshes, stiffness=1e13).frequencies_hz
    for number, (value, ours) in enumerate(zip([177.7, 220.2, 1282.6], found[1:4], strict=True), start=1):
        published(STEAM_TURBINE, f"torsional {number}", value, ours, "1/min", abs=0.051)


def test_long_string_in_torsion(published: Published) -> None:
    """A shaft of 800 m with an inertia at either end: exact here, n² π² / 6e4 too high with elements of 16 m."""
    steel = ShaftMaterial(2.0 * 75e9 * 1.3, 75e9, 8000.0)
    ends = [Disc(0.0, 1e3, 200.0, 100.0), Disc(800.0, 100.0, 10.0, 5.0)]
    found = solve_torsional_modes(Rotor("string", [Segment(800.0, 0.78, 0.65, steel)], ends), count=5).frequencies
    # Of 8 and of 50 elements, whose error goes as their length squared.
    for number, (coarse, fine) in enumerate(
        ((1.9225, 1.9106), (3.9187, 3.8232), (6.0625, 5.7394), (8.4185, 7.6613)), 1
    ):
        limit = fine - (coarse - fine) / (50.0**2 / 8.0**2 - 1.0)
        ours = found[number] / (2.0 * np.pi)
        published(STRING, f"torsional {number}, of elements of no length", limit, ours, "Hz", rel=1e-4 * number**2)
        assert ours < fine
