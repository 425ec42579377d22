"""Gradients of sensors' lines, against lines of machines whose housing is moved, solved and assembled anew."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from case_housings import mesh_of
from kept_mesh_stiffness import without_stiffness

import gearwhine as gw
from gearwhine.case import Case, CaseError, UpdateParameter, case_document, load_case, parse_case
from gearwhine.case.model import housing_table
from gearwhine.coupling import MachineLoads, assemble_machine, machine_description
from gearwhine.coupling.gears.contact.contact_law import with_path_slope
from gearwhine.coupling.gears.contact.face_slices import face_stations
from gearwhine.coupling.gears.loaded.transmission_error import (
    loaded_transmission_error,
    mesh_period_phases,
    period_mean,
)
from gearwhine.coupling.linear import line_sensitivity
from gearwhine.coupling.linear.housing_rates import HousingRates
from gearwhine.coupling.linear.line_sensitivity import Line, LineField, LineModel
from gearwhine.coupling.load_analysis import ranking
from gearwhine.coupling.load_analysis.housing_fields import housing_fields
from gearwhine.coupling.load_analysis.line_model import SolvedLines, solve_lines
from gearwhine.coupling.machine.components import component_of_housing
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.statics.sensitivity import adjoint
from gearwhine.coupling.statics.static_model import RollingElementLaw, StaticBearing, static_bearing
from gearwhine.from_case.given_housing import given_housing
from gearwhine.from_case.machine import describe_machine
from gearwhine.from_case.parametric_housing import MeshedParameters, fitted_case, geometry_of
from gearwhine.housing import HousingModes
from gearwhine.housing.updating.housing_change import by_changes, slopes_of
from gearwhine.housing.updating.static_sensitivity import harmonic_surface_density
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray
from gearwhine.results.operating_point import sections
from gearwhine.rotors.rolling_bearings import linearised_bearing
from gearwhine.solve import housing_modes
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import reduce_housing
from gearwhine.solve.sensitivity.housing_changes import case_changes, housing_changes

LIMIT = 2.0 * np.pi * 5500.0
PARAMETERS = [
    UpdateParameter(name="front wall", keys=("housing.box.wall.front",), range=("5 mm", "20 mm")),
    UpdateParameter(name="bottom wall", keys=("housing.box.wall.bottom",), range=("5 mm", "20 mm")),
    UpdateParameter(name="top wall", keys=("housing.box.wall.top",), range=("5 mm", "20 mm")),
    UpdateParameter(
        name="length", keys=("housing.box.size[2]", "housing.seat.*.center[2]"), range=(0.9, 1.1), factor=True
    ),
    UpdateParameter(name="feet", keys=("housing.support.*.stiffness.y",), range=(0.5, 2.0), factor=True),
    UpdateParameter(name="modulus", keys=("material.iron.youngs_modulus",), range=("90 GPa", "130 GPa")),
]
BALLS = {
    "rolling": {
        "catalogue": {"type": "deep-groove", "bore": "25 mm", "outer_diameter": "52 mm", "width": "15 mm"},
        "clearance": "5 um",
    }
}


@pytest.fixture(scope="module")
def case() -> Case:
    """The small gearbox on ball bearings whose stiffness follows the load, its gears out of the middle.

    Its modes reach up to 6 kHz, the lines up to 5.1 kHz.
    """
    overrides = ["housing.box.mesh_size=60 mm", "gear.*.at=70 mm", "housing.frequency_limit=6 kHz"]
    document = case_document(load_case("small-gearbox", overrides).case)
    document["material"]["iron"] = {"youngs_modulus": "110 GPa", "poisson_ratio": 0.25, "density": "7200 kg/m^3"}
    document["housing"]["material"] = "iron"
    document["housing"]["support"][0]["stiffness"]["y"] = 2e9
    document["gear_pair"][0]["misalignment"] = "found"
    for bearing in document["bearing"]:
        bearing["stiffness"] = BALLS
    return parse_case(document)


Solved = tuple[HousingModes, OperatingPoint, SolvedLines]


def solve(case: Case, mesh: Mesh) -> Solved:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(housing_modes, "build_mesh", lambda *_: mesh)
        housing = solve_housing(case)
    machine = describe_machine(case, reduce_housing(case, housing))
    point = machine.operating_point()
    lines = solve_lines(machine, point, housing, count=9)
    assert lines is not None
    return housing, point, lines


@pytest.fixture(scope="module")
def solved(case: Case) -> Solved:
    return solve(case, mesh_of(case))


def chosen(lines: Sequence[Line]) -> list[Line]:
    """Lines up to the second mesh harmonic, by sensor and frequency."""
    return sorted((one for one in lines if one.frequency < LIMIT), key=lambda one: (one.output.sensor, one.frequency))


def amplitudes(solved: Solved) -> FloatArray:
    return np.array([one.value for one in chosen(solved[2].lines)])


@pytest.mark.slow
def test_the_whole_chain_by_the_housing(case: Case, solved: Solved) -> None:
    """Walls, length with its seats, springs and a modulus together: to 5e-4 of the sum of their parts.

    Differences of mesh, modes, equilibrium, assembly and line; over steps from 1e-6 to 3e-5 they err by at most 4e-5.
    The mean mesh stiffness over the solved phases is constant over these steps, as no slice of the face comes into
    touch at any of the phases; so its derivative, 1e-4 of the sum, is left out here. The motions at other harmonics,
    which the stiffness that varies couples with a line, are not exact in the basis.
    """
    housing, point, found = solved
    found = replace(found, model=without_stiffness(found.model))
    lines = chosen(found.lines)
    assert len(lines) == 4
    adjoints = [adjoint(point, found.model.by_static(one)) for one in lines]
    fields = housing_fields(housing, point, adjoints)
    changes = case_changes(case, housing.mesh, PARAMETERS)
    rates, slopes = found.rates(fields, changes), slopes_of(changes)
    own = by_changes(fields, changes) + np.array([found.model.by_housing(one, rates) for one in lines]) / slopes
    fitted = fitted_case(case, parameters=PARAMETERS)
    meshed = MeshedParameters(fitted, fitted.start, given_housing(case), housing.mesh)
    values = np.array([number.start for number in fitted.numbers])
    way = values * np.random.default_rng(1).normal(size=len(values))
    step, either = 2e-5, []
    for size in (step, -step):
        there = fitted.at((values + size * way).tolist())
        geometry = geometry_of(housing_table(there, "update"))
        assert geometry is not None
        near = solve(there, meshed.morph.moved(geometry))
        np.testing.assert_allclose(near[2].model.contact.stiffness, found.model.contact.stiffness, rtol=1e-9)
        either.append(amplitudes(near))
    expected = (either[0] - either[1]) / (2.0 * step)
    assert (np.abs(own @ way - expected) < 5e-4 * np.abs(own * way).sum(axis=1)).all()
    # Each line answers to the step as its slope says.
    number = [number.given.name for number in fitted.numbers].index("bottom wall")
    small = 1e-6 / slopes[number]
    stepped = [found.model.stepped_housing(one, rates, number, small) for one in lines]
    direct = np.array([found.model.by_housing(one, rates)[number] for one in lines])
    np.testing.assert_allclose(stepped, small * direct, rtol=1e-3)


@dataclass(frozen=True, eq=False)
class Scaled(RollingElementLaw):
    """Rolling elements with energy, force and tangent multiplied."""

    factor: float = 1.0

    def at(self, deflection: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        energy, force, tangent = super().at(deflection)
        return self.factor * energy, self.factor * force, self.factor * tangent


def at_point(case: Case, solved: Solved, point: OperatingPoint) -> FloatArray:
    """Amplitudes of the machine about another equilibrium, on the same modes."""
    _, _, found = solved
    part = component_of_housing(found.housing, participates=False, with_coarser=False)
    machine = describe_machine(case, part).at_operating_point(point)
    gaps = {one.names: (one.station_gap, one.path_slope) for one in point.pairs}
    flanks = [
        replace(pair, misalignment=0.0, face_gap=gap, path_slope=slope)
        for pair in machine.gear_pairs
        for gap, slope in [gaps[pair.driver, pair.driven]]
    ]
    pairs = replace(machine, gear_pairs=flanks).loaded_pairs()
    # The basis of the shafts stays, so that the difference has no part by it.
    assembled = machine.assemble(pairs, found.model.machine.rotors)
    model = LineModel(assembled, point, pairs, found.model.found, found.model.shared)
    return np.array([one.value for one in chosen(model.lines(2.0 * np.pi * 6e3, 9))])


@pytest.mark.slow
@pytest.mark.parametrize("typed_damping", [True, False])
def test_the_equilibrium_changes_tangents_and_flanks(case: Case, solved: Solved, typed_damping: bool) -> None:
    """A bearing's law that is stiffer in the equilibrium alone: by tangents, damping, mesh stiffness and errors.

    To 1e-4 over a step in which no slice of the face comes into touch at any of the solved phases, so that the mean
    mesh stiffness stays. Over longer ones to 1e-2, by which the differences differ: the stiffness moves in steps.
    """
    housing, point, found = solved
    if not typed_damping:  # damping in proportion to the stiffness, which follows the equilibrium as it does
        document = case_document(case)
        for entry in document["bearing"]:
            del entry["damping"]
        case = parse_case(document)
        machine = describe_machine(case, reduce_housing(case, housing))
        point = machine.operating_point()
        assert all(load.mounted.damping_time > 0.0 for load in point.bearings)
        lines = solve_lines(machine, point, housing, count=9)
        assert lines is not None
        solved = housing, point, found = housing, point, lines
    machine = describe_machine(case, reduce_housing(case, housing))
    name = point.bearings[0].name
    own = np.array(
        [adjoint(point, found.model.by_static(one)).by_bearing_stiffness(name) for one in chosen(found.lines)]
    )

    def stiffer(size: float) -> OperatingPoint:
        def made(mounted: MountedBearing, *how: Any) -> StaticBearing:
            bearing = static_bearing(mounted, *how)
            if mounted.bearing.name != name:
                return bearing
            assert isinstance(bearing.law, RollingElementLaw)
            return replace(bearing, law=Scaled(bearing.law.elements, 1.0 + size))

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(machine_description, "static_bearing", made)
            point = machine.operating_point()
        # The law of the equilibrium alone is scaled: the linear bearing keeps the tangent of its elements.
        bearings = []
        for load in point.bearings:
            assert load.rolling is not None
            tangent = linearised_bearing(load.rolling, load.name, load.mounted.bearing.at).stiffness
            bearings.append(replace(load, stiffness=tangent))
        return replace(point, bearings=tuple(bearings))

    model = without_stiffness(found.model)
    kept = np.array([adjoint(point, model.by_static(one)).by_bearing_stiffness(name) for one in chosen(found.lines)])
    for step, derivative, tolerance in ((1e-6, kept, 1e-4), (5e-4, own, 1e-2)):
        either = [at_point(case, solved, stiffer(size)) for size in (step, -step)]
        expected = (either[0] - either[1]) / (2.0 * step)
        assert (np.abs(derivative - expected) < tolerance * np.abs(expected).max()).all()
    assert np.abs(own).max() > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("over", ["face", "path"])
def test_flanks_by_assembly(case: Case, solved: Solved, over: str) -> None:
    """The gap of flanks whose whole face carries, tilted over face or path: transmission error, shuttling, to 1e-4.

    The step is so short that no slice of the face comes into touch, nor does the mean mesh stiffness change.
    """
    found = solved[2]
    model, lines, given = found.model, chosen(found.lines), found.model.machine
    (mesh,) = given.meshes
    faces = mesh.contact.faces
    assert faces is not None
    (pair,) = solved[1].pairs
    assert pair.carrying_part == 1.0
    places = face_stations(faces.face_width)
    tilt = np.append(2.0 * places / faces.face_width, 0.0) if over == "face" else np.append(0.0 * places, 1.0)
    step, either = 1e-11, []
    for way in (1.0, -1.0):
        gap = faces.gap + way * step * 2.0 * faces.z / faces.face_width
        if over == "face":
            contact = replace(mesh.contact, faces=replace(faces, gap=gap))
        else:
            contact = with_path_slope(mesh.contact, mesh.geometry, way * step / mesh.geometry.base_pitch)
        changed = replace(mesh, contact=contact)
        machine = assemble_machine(
            given.rotors,
            given.housing,
            speeds=given.speeds,
            bearings=given.bearings,
            meshes=[changed],
            loads=MachineLoads(torques=given.loads.torques),
        )
        there = replace(model, machine=machine)
        np.testing.assert_allclose(there.contact.stiffness, model.contact.stiffness, rtol=1e-9)
        either.append(np.array([one.value for one in chosen(there.lines(LIMIT, 9))]))
    expected = (either[0] - either[1]) / (2.0 * step)
    kept = without_stiffness(model)
    own = np.array([kept._by_flanks(one, 0, kept._gap_rates[0]) @ tilt for one in lines])
    np.testing.assert_allclose(own, expected, atol=1e-4 * np.abs(expected).max())
    assert np.abs(expected).max() > 0.0


@pytest.mark.slow
def test_mesh_stiffness_by_another_stiffness(solved: Solved) -> None:
    """The part of the gap through k, with k of the mesh changed and its damping as the root of k."""
    model = solved[2].model
    (rates,) = model._gap_rates.values()
    contact = model.machine.system.contacts[0]
    arms = np.append(1.0, model.machine.face(0, contact.contact).tangent(float(model.contact.force[0])).centre)  # type: ignore[index]
    by_stiffness = np.tile(np.outer(arms, arms), (len(rates.stiffness), 1, 1))
    even = replace(rates, stiffness=by_stiffness)
    for name in ("error", "loads", "varying"):
        even = replace(even, **{name: 0.0 * getattr(rates, name)})
    lines, either = chosen(solved[2].lines), []
    for size in (1e-5, -1e-5):
        # The damping of the flanks' resistance to tilting is in proportion to that stiffness by c/k.
        linear = [
            one if one.of_contact is None else replace(one, damping=one.damping / np.sqrt(1.0 + size))
            for one in model.machine.system.linear
        ]
        there = replace(
            model, machine=replace(model.machine, system=replace(model.machine.system, linear=tuple(linear)))
        )
        vars(there)["contact"] = replace(
            model.contact,
            stiffness=(1.0 + size) * model.contact.stiffness,
            damping=np.sqrt(1.0 + size) * model.contact.damping,
        )
        either.append(np.array([one.value for one in chosen(there.lines(LIMIT, 9))]))
    expected = (either[0] - either[1]) / (2e-5 * model.contact.stiffness[0])
    found = np.array([model._by_flanks(one, 0, even) for one in lines])
    np.testing.assert_allclose(found, np.broadcast_to(expected[:, None], found.shape), rtol=1e-5)


@pytest.mark.slow
def test_mesh_stiffness_by_the_gap(solved: Solved) -> None:
    """The mean mesh stiffness by a tilt and by a bow of the flanks, to a tenth of the larger, that by the tilt.

    It is compared with differences over so many phases that they hardly depend on their number or step.
    """
    model = solved[2].model
    contact, force = model.machine.meshes[0].contact, model.contact.force
    assert contact.faces is not None
    assert force is not None
    faces, step = contact.faces, 3e-3 * float(force[0] / model.contact.stiffness[0])
    along, places = (2.0 * one / faces.face_width for one in (faces.z, face_stations(faces.face_width)))
    expected, found = [], []
    for power in (1, 2):
        either = []
        for way in (step, -step):
            moved = replace(contact, faces=replace(faces, gap=faces.gap + way * along**power))
            phases = mesh_period_phases(moved, 16000)
            # All phases at once take ten times as long.
            tangents = [
                loaded_transmission_error(moved, float(force[0]), part).tangent_stiffness
                for part in np.array_split(phases, 16)
            ]
            either.append(period_mean(phases, np.concatenate(tangents)))
        expected.append((either[0] - either[1]) / (2.0 * step))
        found.append(model._gap_rates[0].stiffness[:-1, 0, 0] @ places**power)
    np.testing.assert_allclose(found, expected, atol=0.1 * abs(expected[0]))


@pytest.mark.slow
def test_bearings_by_assembly(case: Case, solved: Solved) -> None:
    """Tangent stiffness and position of a bearing at the same equilibrium, by another machine on the same modes."""
    found = solved[2]
    model, lines = found.model, chosen(found.lines)
    given = model.machine
    before = np.array([one.value for one in lines])

    def with_bearing(changed: MountedBearing) -> FloatArray:
        machine = assemble_machine(
            given.rotors,
            given.housing,
            speeds=given.speeds,
            bearings=[changed, *given.bearings[1:]],
            meshes=given.meshes,
            loads=MachineLoads(torques=given.loads.torques),
        )
        return np.array([one.value for one in chosen(replace(model, machine=machine).lines(LIMIT, 9))])

    first = given.bearings[0]
    name, made = first.bearing.name, first.bearing
    np.testing.assert_allclose(with_bearing(first), before, rtol=1e-9)
    for part in (1e-5, 0.2):
        stiffer = replace(first, bearing=replace(made, stiffness=(1.0 + part) * made.stiffness))
        change = with_bearing(stiffer) - before
        stepped = [model.stepped_bearing_stiffness(one, name, part) for one in lines]
        np.testing.assert_allclose(stepped, change, rtol=1e-5)
        if part == 1e-5:
            own = [part * model.by_bearing_stiffness(one, name) for one in lines]
            np.testing.assert_allclose(own, change, rtol=2e-3)
    slopes = [model.by_bearing_position(one, name) for one in lines]
    # The part by the bearing's own deflection is another test's.
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(line_sensitivity, "deflection_slope", lambda *_: np.zeros(5))
        own = np.array([model.by_bearing_position(one, name) for one in lines])
        stepped = [model.stepped_bearing_position(one, name, 1e-7) for one in lines]
    either = [with_bearing(replace(first, bearing=replace(made, at=made.at + way * 1e-5))) for way in (1.0, -1.0)]
    expected = (either[0] - either[1]) / 2e-5
    np.testing.assert_allclose(own, expected, atol=2e-3 * np.abs(expected).max())
    np.testing.assert_allclose(stepped, 1e-7 * own, atol=1e-3 * np.abs(1e-7 * own).max())
    assert not np.allclose(slopes, own, rtol=1e-6)


@pytest.mark.slow
def test_short_steps_of_either_way_are_the_slope(case: Case, solved: Solved, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bearings and flanks follow the equilibrium here, which has a part in the lines of its own."""
    monkeypatch.setattr(ranking, "_LENGTH_STEP", 1e-9)
    monkeypatch.setattr(ranking, "_RELATIVE_STEP", 1e-6)
    housing, point, _ = solved
    machine = describe_machine(case, reduce_housing(case, housing))
    changes, _ = housing_changes(case, housing.mesh)
    found = ranking.solve_load_sensitivity(machine, point, housing, changes)
    kinds = {one.kind for one in found.influences}
    assert kinds == {"housing", "bearing stiffness", "bearing position"}
    for kind in kinds:
        rows = [one for one in found.influences if one.kind == kind]
        slopes, there, back = (
            np.array([getattr(one, name) for one in rows]) for name in ("lines", "stepped", "reversed")
        )
        largest = np.abs(slopes).max(axis=0)
        assert (largest > 0.0).all()
        assert (np.abs(there - slopes) < 1e-3 * largest).all()
        assert (np.abs(back + slopes) < 1e-3 * largest).all()


def test_the_damping_follows_the_modes() -> None:
    """DC against C = Rᵀ g(A) R of a stiffness and a mass that change, by differences; degenerate modes too."""
    generator = np.random.default_rng(3)
    omega = np.array([0.0, 1.0, 1.0, 2.0, 3.5])
    ratios = np.full(5, 0.03)
    stiffness, mass = generator.normal(size=(2, 5, 5))
    stiffness, mass = stiffness + stiffness.T, mass + mass.T
    stiffness[0] = stiffness[:, 0] = 0.0  # a rigid motion stays one
    mass[0] = mass[:, 0] = 0.0
    rates = HousingRates(omega, ratios, stiffness[None], mass[None], [{}], [{}], [{}], [{}])

    def damping(size: float) -> FloatArray:
        inertia = np.linalg.cholesky(np.eye(5) + size * mass)
        inner = np.linalg.solve(inertia, np.linalg.solve(inertia, np.diag(omega**2) + size * stiffness).T)
        values, vectors = np.linalg.eigh(0.5 * (inner + inner.T))
        modal = inertia @ vectors
        return np.asarray(2.0 * 0.03 * (modal * np.sqrt(np.maximum(values, 0.0))) @ modal.T)

    expected = (damping(1e-5) - damping(-1e-5)) / 2e-5
    np.testing.assert_allclose(rates.damping[0], expected, atol=1e-8)


def test_the_density_of_even_strains(block_of: Callable[..., Mesh]) -> None:
    """Linear fields u = A x and (1 + 2i) B x have Re G = ω² ρ u · λ - σ(A) : ε(B); in the imaginary u it turns over."""
    mesh = block_of("tetra10", (0.3, 0.2, 0.1), (3, 2, 1))
    lam, mu, rho = 1.1e11, 0.8e11, 7800.0
    constants = np.tile(np.array([[lam], [mu], [rho]]), (1, mesh.n_elements))
    gradient, other = np.random.default_rng(2).normal(size=(2, 3, 3))
    motion, against = mesh.points @ gradient.T, mesh.points @ other.T
    strain, twin = 0.5 * (gradient + gradient.T), 0.5 * (other + other.T)
    stress = lam * np.trace(strain) * np.eye(3) + 2.0 * mu * strain
    expected = 25e6 * rho * np.sum(motion * against, axis=1) - np.sum(stress * twin)
    for phase, part in ((1.0, 1.0), (1.0j, -2.0)):
        found = harmonic_surface_density(mesh, constants, phase * motion + 0j, (1.0 + 2.0j) * against, 5e3)
        np.testing.assert_allclose(found, part * expected, rtol=1e-9)
    # Of a line it is the sum over all harmonics that are coupled with it.
    solved_lines = cast(Any, SimpleNamespace(field=lambda coordinates: coordinates))
    both = (LineField(5e3, motion + 0j, against + 0j), LineField(-1e4, 0.5j * motion, 1j * against))
    fields, line = SimpleNamespace(mesh=mesh, constants=constants), SimpleNamespace(fields=both)
    density = ranking.Ranking(cast(Any, None), solved_lines)._response_density(cast(Any, fields), cast(Any, line))
    further = 1e8 * rho * np.sum(motion * against, axis=1) - np.sum(stress * twin)
    np.testing.assert_allclose(density, expected - 0.5 * further, rtol=1e-9)


@pytest.mark.slow
@pytest.mark.usefixtures("lines_solved_once")
def test_the_document_ranks_by_a_line() -> None:
    study = gw.load("small-gearbox", {"housing.box.mesh_size": "60 mm", "gear_pair.0.misalignment": "0 rad"})
    result = study.operating_point(line="right wall")
    lines = result.document["sensor_lines"]
    assert [line["sensor"] for line in lines if line["ranked"]] == ["right wall"]
    assert [line["amplitude_m_per_s2"] for line in lines] == sorted(
        (line["amplitude_m_per_s2"] for line in lines), reverse=True
    )
    assert lines[0]["excitation"] == "1× pinion -> wheel"
    number = next(n for n, line in enumerate(lines) if line["ranked"])
    levels = {}
    for row in result.document["sensitivity"]:
        change = row["lines"][number]
        levels[row["parameter"], row["kind"]] = max(abs(change["level_db"]), abs(change["reverse_level_db"]))
        relative = change["reverse_amplitude_m_per_s2"] / lines[number]["amplitude_m_per_s2"]
        assert change["reverse_level_db"] == pytest.approx(20.0 * np.log10(1.0 + relative))
        relative = change["amplitude_m_per_s2"] / lines[number]["amplitude_m_per_s2"]
        assert change["level_db"] == pytest.approx(20.0 * np.log10(1.0 + relative))
        first = change["first_order_m_per_s2"] / lines[number]["amplitude_m_per_s2"]
        assert change["first_order_db"] == pytest.approx(20.0 / np.log(10.0) * first)
    (section,) = sections(result.document)
    tables = [one for one in section.tables if one.caption.startswith("Change of the line of right wall at 2567 Hz")]
    assert len(tables) == 2
    for table in tables:
        shown = [levels[row["parameter"], row["kind"]] for row in table.rows]
        assert shown == sorted(shown, reverse=True)
    # Typed misalignment does not follow the walls.
    assert "misalignment" in result.document["lines_without"]
    data = result.dataset["line_amplitude_change"]
    assert (data.dims, data.attrs["units"]) == (("influence", "sensor_line"), "m/s2")
    with pytest.raises(CaseError, match="'top@2567'"):
        study.operating_point(line="roof")
