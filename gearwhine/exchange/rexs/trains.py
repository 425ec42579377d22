"""Gear train of a REXS file: which gear of each pair drives, planetary sets, and what the casing holds."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from gearwhine.coupling.description.gear_train import GearTrain, gear_train
from gearwhine.coupling.description.train_matrix import GearedShafts
from gearwhine.exchange.rexs.errors import wrong
from gearwhine.exchange.rexs.gear_unit import GearUnit
from gearwhine.exchange.rexs.gears import Mesh, Teeth
from gearwhine.exchange.rexs.model import Component
from gearwhine.exchange.rexs.quantities import mm, of
from gearwhine.exchange.rexs.shafts import RIGID_TILT, Bodies, Body


@dataclass
class PlanetSet:
    """A planetary stage: its carrier, planets, sun and ring.

    Attributes
    ----------
    stage : Component
    carrier : Body
    planets : list of Teeth
        All gears on the shafts of planets.
    sun, ring : Teeth or None
    """

    stage: Component
    carrier: Body
    planets: list[Teeth]
    sun: Teeth | None
    ring: Teeth | None


@dataclass
class Train:
    """Pairs of gears by their bodies, planetary sets and held bodies.

    Attributes
    ----------
    meshes : list of Mesh
        In the order of the power.
    sets : list of PlanetSet
    carriers : dict of Body to Body
        Carrier of each planet's body.
    held : list of Body
        Bodies with gears that the casing holds.
    """

    meshes: list[Mesh]
    sets: list[PlanetSet]
    carriers: dict[Body, Body]
    held: list[Body] = field(default_factory=list)

    def built(self, first: str) -> GearTrain:
        """Return the solved train whose first shaft is of a name."""
        pairs = [
            GearedShafts(
                mesh.first.body.name,
                mesh.second.body.name,
                (mesh.first.number, mesh.second.number),
                self._carrier_name(mesh),
            )
            for mesh in self.meshes
        ]
        gears = [gear for mesh in self.meshes for gear in (mesh.first, mesh.second)]
        planets = [gear.body.name for gear in gears if gear.body in self.carriers]
        return gear_train(
            pairs, held=[body.name for body in self.held], planets=list(dict.fromkeys(planets)), first=first
        )

    def ratios_to(self, body: Body) -> dict[str, float]:
        """Return the speed of each body over that of one, by name."""
        return {name: float(ratio) for name, ratio in self.built(body.name).ratios.items()} | {body.name: 1.0}

    def _carrier_name(self, mesh: Mesh) -> str | None:
        carrier = self.carriers.get(mesh.first.body) or self.carriers.get(mesh.second.body)
        return None if carrier is None else carrier.name


def find_train(unit: GearUnit, bodies: Bodies, meshes: list[Mesh], teeth: dict[int, Teeth]) -> Train:
    """Return the train of the pairs in mesh.

    Raises
    ------
    RexsError
        Where a planetary stage has no carrier or no planets, or a shaft with gears is held outside one.
    """
    sets, carriers = [], dict[Body, Body]()
    for stage in unit.model.of_kind("planetary_stage"):
        one = _planet_set(unit, bodies, stage, meshes, teeth)
        sets.append(one)
        carriers |= {gear.body: one.carrier for gear in one.planets}
    geared = dict.fromkeys(gear.body for mesh in meshes for gear in (mesh.first, mesh.second))
    geared |= dict.fromkeys(one.carrier for one in sets)
    held = [body for body in geared if any(_takes_torque(one.component) for one in bodies.holds(body))]
    central = {body for one in sets for body in (one.carrier, *(g.body for g in (one.sun, one.ring) if g))}
    for body in held:
        if body not in central:
            raise wrong(
                body.label, "a shaft that turns: a coupling holds it in the casing, and it is in no planetary set"
            )
    return Train(meshes, sets, carriers, held)


def _takes_torque(coupling: Component) -> bool:
    """Whether a coupling holds a shaft from turning; without a stiffness it does."""
    stiffness = coupling.number_of("rotational_stiffness", "N*m/rad")
    return stiffness is None or stiffness > 0.0


def _planet_set(
    unit: GearUnit, bodies: Bodies, stage: Component, meshes: list[Mesh], teeth: dict[int, Teeth]
) -> PlanetSet:
    """Return a planetary set."""
    shafts = _shafts(unit, stage, "planet_shaft")
    planet_bodies = {body for shaft in shafts if (body := bodies.of(shaft)) is not None}
    planets = [gear for gear in teeth.values() if gear.body in planet_bodies]
    if not planets:
        raise wrong(stage.label, "planets: relations planet_shaft to shafts with gears")
    carrier = next(
        (
            body
            for body in bodies.bodies
            if body.carrier is not None
            and body.carrier in (stage, *unit.model.parts_of(stage.number, "planet_carrier"))
        ),
        None,
    )
    if carrier is None:
        raise wrong(
            stage.label, "a carrier: an assembly planet_carrier with plates or shafts, or a planet_carrier_shaft"
        )
    mates = []
    for mesh in meshes:
        for gear, other in ((mesh.first, mesh.second), (mesh.second, mesh.first)):
            if gear.body in planet_bodies and other.body not in planet_bodies and other not in mates:
                mates.append(other)
    suns, rings = [one for one in mates if one.number > 0], [one for one in mates if one.number < 0]
    for further in (*suns[1:], *rings[1:]):
        unit.notes.changed(
            further.component.label, f"a further central gear of {stage.label}: it is in its pairs alone"
        )
    if not mates:
        raise wrong(stage.label, "a sun or a ring in mesh with its planets")
    return PlanetSet(stage, carrier, planets, suns[0] if suns else None, rings[0] if rings else None)


def _shafts(unit: GearUnit, stage: Component, kind: str) -> list[Component]:
    """Return the shafts of a planetary stage by a relation."""
    found = []
    for relation in unit.model.of_relation(kind):
        shaft = unit.component(relation.role("shaft"))
        if relation.role("planetary_stage") == stage.number and shaft is not None:
            found.append(shaft)
    return found


def in_order_of_power(meshes: list[Mesh], first: Body | None) -> list[Mesh]:
    """Return pairs each with its driver first, in the order in which power reaches them from a body."""
    if first is None or not any(first in (mesh.first.body, mesh.second.body) for mesh in meshes):
        first = meshes[0].first.body
    of_body: dict[Body, list[Mesh]] = {}
    for mesh in meshes:
        for gear in (mesh.first, mesh.second):
            of_body.setdefault(gear.body, []).append(mesh)
    ordered: dict[Mesh, Mesh] = {}
    # Each train that is apart from the first one begins at its first pair.
    for start in (first, *(mesh.first.body for mesh in meshes)):
        reached = {start: None}
        for body in (waiting := [start]):
            for mesh in of_body.get(body, ()):
                if mesh in ordered:
                    continue
                ahead = body is mesh.first.body
                driver, driven = (mesh.first, mesh.second) if ahead else (mesh.second, mesh.first)
                ordered[mesh] = Mesh(mesh.stage, driver, driven, mesh.centre_distance)
                if driven.body not in reached:
                    reached[driven.body] = None
                    waiting.append(driven.body)
    return list(ordered.values())


def pair_table(unit: GearUnit, mesh: Mesh) -> dict[str, Any]:
    """Return the `[[gear_pair]]` of a mesh."""
    table: dict[str, Any] = {
        "driver": unit.names.of(mesh.first.component),
        "driven": unit.names.of(mesh.second.component),
    }
    limits = [mesh.stage.number_of(f"{name}_normal_backlash", "m") for name in ("minimum", "maximum")]
    given = [value for value in limits if value is not None]
    if given and min(given) >= 0.0:
        # Along the line of action, in the transverse plane.
        table["backlash"] = mm(sum(given) / len(given) / _cosine_of_base_helix(mesh.first))
    return table


def _cosine_of_base_helix(gear: Teeth) -> float:
    """Cosine of the base helix angle: sin(beta_b) = sin(beta) cos(alpha_n) (ISO 21771)."""
    return math.sqrt(1.0 - (math.sin(gear.helix_angle) * math.cos(gear.pressure_angle)) ** 2)


def planetary_table(unit: GearUnit, one: PlanetSet, train: Train, bodies: Bodies) -> dict[str, Any]:
    """Return the `[[planetary]]` of a set."""
    table: dict[str, Any] = {"name": unit.names.of(one.stage)}
    if one.sun is not None:
        table["sun"] = unit.names.of(one.sun.component)
    if one.ring is not None:
        table["ring"] = unit.names.of(one.ring.component)
    table["planets"] = [unit.names.of(gear.component) for gear in one.planets]
    table["carrier"] = one.carrier.name
    members = [gear.body for gear in (one.ring, one.sun) if gear is not None] + [one.carrier]
    for body in members:
        if body in train.held:
            table["fixed"] = _fixed(unit, body, bodies)
            break
    return table


def _fixed(unit: GearUnit, body: Body, bodies: Bodies) -> dict[str, Any]:
    """Return what holds a member from turning: the sum of the couplings' stiffness, unless it is rigid."""
    total = 0.0
    for coupling in bodies.holds(body):
        stiffness = coupling.component.number_of("rotational_stiffness", "N*m/rad")
        total += RIGID_TILT if stiffness is None else stiffness
    return {"member": body.name} | ({} if total >= RIGID_TILT else {"stiffness": of(total, "N*m/rad")})
