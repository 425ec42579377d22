"""Coordinates that are too stiff to be worth following in time answer statically.

A residual coordinate of the housing has a stiffness that matters and a frequency that does not. Where this frequency
lies within those of the other coordinates it is marched like them, and its inertia improves the response below. Where
it lies above, no step should be refined for it: it is taken to be in equilibrium at all times,

    K_rr q_r + K_rk q_k = 0,        q = T q_k,        T = [I; -K_rr⁻¹ K_rk],

which takes K, C, the contacts' directions and the loads to Tᵀ K T and so on (Guyan's condensation of the stiffness;
MacNeal's residual flexibility without its mass), and keeps the static compliance exact. Dampers that act on q_r hold it
back in truth: at a circular frequency w it errs by w C/K of its bearing, the kept coordinates by the square of that.
"""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from coupling.component import Component
from coupling.system import CoupledSystem, HarmonicLoad

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Condensed:
    """A system without some of its coordinates, and what brings them back.

    Attributes
    ----------
    system : CoupledSystem
        One component of the m kept coordinates, in their order.
    kept : ndarray of int, shape (m,)
        Which of the n coordinates these are.
    recovery : ndarray, shape (n, m)
        T: all coordinates from the kept ones.
    """

    system: CoupledSystem
    kept: npt.NDArray[np.int64]
    recovery: FloatArray


def condensed(system: CoupledSystem) -> Condensed:
    """The system without the residual coordinates that are stiffer than all others; the same where it has none."""
    stiff = _stiff(system)
    if not stiff.any():
        return Condensed(system, np.arange(system.size), np.eye(system.size))
    kept = ~stiff
    recovery = np.zeros((system.size, int(kept.sum())))
    recovery[kept] = np.eye(recovery.shape[1])
    stiffness = system.stiffness
    recovery[stiff] = -np.linalg.solve(stiffness[np.ix_(stiff, stiff)], stiffness[np.ix_(stiff, kept)])
    kinds = tuple(kind for kind, stays in zip(system.kinds, kept, strict=True) if stays)
    whole = Component(
        name="machine",
        kinds=kinds,
        stiffness=recovery.T @ stiffness @ recovery,
        damping=recovery.T @ system.damping @ recovery,
        gyroscopic=np.zeros((len(kinds), len(kinds))),
    )
    less = CoupledSystem(
        components=(whole,),
        speeds=(0.0,),
        contacts=tuple(replace(contact, direction=contact.direction @ recovery) for contact in system.contacts),
        load=system.load @ recovery,
        harmonic_loads=tuple(HarmonicLoad(one.frequency, one.amplitude @ recovery) for one in system.harmonic_loads),
    )
    return Condensed(less, np.flatnonzero(kept), recovery)


def highest_frequency(system: CoupledSystem) -> float:
    """Highest natural frequency of the coordinates that are to be resolved, the residual ones held [rad/s]."""
    stiffness = system.mean_stiffness()[np.ix_(system.resolved, system.resolved)]
    return float(np.sqrt(np.abs(np.linalg.eigvals(stiffness)).max(initial=0.0)))


def _stiff(system: CoupledSystem) -> npt.NDArray[np.bool_]:
    """Residual coordinates beyond the highest frequency of the others, unless a load or a contact acts on them."""
    loaded = system.load != 0.0
    for amplitude in [load.amplitude for load in system.harmonic_loads]:
        loaded = loaded | (amplitude != 0.0)
    for direction in system.contact_directions.T:
        loaded = loaded | (direction != 0.0)
    beyond = np.diag(system.stiffness) > highest_frequency(system) ** 2
    return np.asarray(~system.resolved & beyond & ~loaded)
