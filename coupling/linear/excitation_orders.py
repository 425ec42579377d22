"""Excitation orders of a machine: shafts, mesh harmonics, sidebands, passing of rolling elements."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from coupling.assembly import CoupledMachine
from coupling.errors import CouplingError
from coupling.machine.connectors import RollingLaw
from rotors.rolling_bearings import characteristic_frequencies


@dataclass(frozen=True)
class ExcitationLine:
    """An excitation whose frequency is proportional to the speed.

    Attributes
    ----------
    name : str
        Name such as ``2× input``, ``3× pinion -> wheel`` or ``1× pinion -> wheel + 1× input`` for a sideband.
    kind : str
        ``shaft``, ``mesh``, ``sideband`` or ``bearing``.
    order : float
        Frequency over the speed of the leading rotor, positive.
    """

    name: str
    kind: Literal["shaft", "mesh", "sideband", "bearing"]
    order: float


def excitation_lines(
    machine: CoupledMachine,
    *,
    shaft_orders: Sequence[float] = (1.0, 2.0),
    mesh_harmonics: Sequence[int] = (1, 2, 3),
    sidebands: int = 0,
    element_passes: Sequence[int] = (),
) -> tuple[ExcitationLine, ...]:
    """Orders of all shafts, meshes and rolling elements in motion; shafts of equal speed share a line.

    Parameters
    ----------
    machine : CoupledMachine
    shaft_orders : sequence of float
        Multiples of each shaft's speed: 1 is its unbalance.
    mesh_harmonics : sequence of int
        Multiples of each mesh frequency.
    sidebands : int
        Number of sidebands on either side of each mesh harmonic, spaced by the speed of either gear's shaft.
    element_passes : sequence of int
        Multiples of the passing of rolling elements over the outer raceway, of bearings whose law follows them.

    Raises
    ------
    CouplingError
        For a machine that stands still.
    """
    speeds = machine.speeds
    leading = abs(speeds[machine.leading_rotor])
    if leading == 0.0:
        raise CouplingError(f"rotor {machine.leading_rotor!r} stands still; expected a machine that turns")
    ratios = {name: abs(speed) / leading for name, speed in speeds.items() if speed != 0.0}
    together: dict[float, list[str]] = {}
    for name, ratio in ratios.items():
        together.setdefault(round(ratio, 12), []).append(name)
    lines = [
        ExcitationLine(f"{multiple:g}× {', '.join(names)}", "shaft", multiple * ratios[names[0]])
        for names in together.values()
        for multiple in shaft_orders
    ]
    for mesh in machine.meshes:
        teeth = mesh.geometry.driver.teeth * ratios[mesh.driver.rotor]
        name = mesh.name
        shafts = {round(ratios[rotor], 12): rotor for rotor in (mesh.driven.rotor, mesh.driver.rotor)}
        for harmonic in mesh_harmonics:
            lines.append(ExcitationLine(f"{harmonic}× {name}", "mesh", harmonic * teeth))
            for rotor in shafts.values():
                for number in range(1, sidebands + 1):
                    for sign, word in ((-1, "-"), (1, "+")):
                        order = harmonic * teeth + sign * number * ratios[rotor]
                        text = f"{harmonic}× {name} {word} {number}× {rotor}"
                        lines.append(ExcitationLine(text, "sideband", order))
    for connector in machine.system.nonlinear:
        if isinstance(connector.law, RollingLaw) and connector.speed != 0.0:
            # Rows of one bearing are mostly alike.
            for order in sorted(
                {
                    round(characteristic_frequencies(row, connector.speed).outer_pass / leading, 12)
                    for row in connector.law.state.bearing.rows
                }
            ):
                lines += [
                    ExcitationLine(f"{multiple}× elements of {connector.name}", "bearing", multiple * order)
                    for multiple in element_passes
                ]
    return tuple(lines)
