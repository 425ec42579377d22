"""Modes of planetary sets by their kind: rotational, translational and planet modes (Lin & Parker 1999).

Sun, ring and carrier of a set with equal planets at equal angles move in each mode in one way alone: in rotational
modes they turn, in translational modes, which come in pairs, they move across the axis, and in planet modes they stand
still. With helical gears rotational modes have motion along the axis too, and translational ones tilts (Eritenel &
Parker, J. Sound Vib. 325 (2009) 397). What breaks the symmetry mixes the kinds.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.machine.components import RotorComponent
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.frames import orders_and_quarter_turn
from gearwhine.numerics.arrays import BoolArray, FloatArray

_SET_SHARE = 0.5  # least part of the kinetic energy in a set for which a mode is one of it
_STANDS = 1e-6  # part of a set's kinetic energy below which a motion of its central members is none


@dataclass(frozen=True, eq=False)
class _Set:
    """Coordinates of a set's parts by their motion, (n,) each."""

    carrier: str
    planets: BoolArray
    across: BoolArray
    about: BoolArray


def planetary_kinds(system: CoupledSystem, moving: FloatArray) -> tuple[str, ...]:
    """Kind of each mode in the planetary set that moves most; empty for modes of other parts.

    Parameters
    ----------
    system : CoupledSystem
    moving : ndarray, shape (m, n)
        Share of each coordinate in the modes' kinetic energy.

    Returns
    -------
    tuple of str
        ``rotational``, ``translational``, ``planet`` or ``mixed``, with the carrier's name: ``rotational: carrier``.
    """
    sets = _sets(system)
    return tuple(_kind(sets, shares) for shares in moving)


def _kind(sets: Sequence[_Set], shares: FloatArray) -> str:
    for one in sets:
        planets, across, about = (float(shares[part].sum()) for part in (one.planets, one.across, one.about))
        total = planets + across + about
        if total < _SET_SHARE:
            continue
        turns, shifts = about > _STANDS * total, across > _STANDS * total
        kind = {(True, True): "mixed", (True, False): "rotational", (False, True): "translational"}
        return f"{kind.get((turns, shifts), 'planet')}: {one.carrier}"
    return ""


def _sets(system: CoupledSystem) -> list[_Set]:
    """Find the sets of the system: planets by their carrier, with it and the rotors in mesh with them."""
    owners = np.repeat(np.arange(len(system.components)), [part.size for part in system.components])
    orders = np.concatenate([orders_and_quarter_turn(part)[0] for part in system.components])
    carriers = {
        place: part.carrier
        for place, part in enumerate(system.components)
        if isinstance(part, RotorComponent) and part.carrier is not None
    }
    names = [part.name for part in system.components]
    sets = []
    for carrier in dict.fromkeys(carriers.values()):
        planets = [place for place, name in carriers.items() if name == carrier]
        central = {names.index(carrier)}
        for contact in system.contacts:
            touched = set(np.unique(owners[contact.direction != 0.0]).tolist())
            if touched & set(planets):
                central |= {
                    place for place in touched - set(carriers) if isinstance(system.components[place], RotorComponent)
                }
        of_central = np.isin(owners, sorted(central))
        sets.append(_Set(carrier, np.isin(owners, planets), of_central & (orders > 0), of_central & (orders == 0)))
    return sets
