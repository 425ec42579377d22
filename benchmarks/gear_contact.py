"""Gear contact: curves of a pair, a Harris map, and the compiled law in a loop.

    python benchmarks/gear_contact.py

The pairs are the gear noise rig's (spur, relieved) and a crowned helical one. Compiled code is compiled before it is
timed; the least of some runs is shown, in seconds of the processor, as other work on the machine only adds. The law is
called in stretches so short that few are interrupted.
"""

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numba import njit
from timing import arguments, machine, timed

from gearwhine.coupling.gears import (
    ElasticRingStiffness,
    Gear,
    GearPairGeometry,
    HelixDeviation,
    PotentialEnergyStiffness,
    StiffnessModel,
    TipRelief,
    ToothContact,
    harris_map,
    loaded_transmission_error,
    mesh_stiffness,
    optimal_tip_relief,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force

PHASES = np.arange(256) / 256.0
CALLS, STRETCHES = 7000, 40
RELIEF = TipRelief(23e-6, math.radians(24.0))
SPUR = Gear("rig", 28, 3.175e-3, math.radians(20.0), 6.35e-3, tip_relief=RELIEF)
HELIX = math.radians(15.0)
CROWNED = Gear(
    "helical", 28, 3e-3, math.radians(20.0), 25e-3, helix_angle=HELIX, helix_deviation=HelixDeviation(crowning=6e-6)
)
PAIRS = {
    "spur": GearPairGeometry(SPUR, SPUR),
    "helical": GearPairGeometry(CROWNED, replace(CROWNED, helix_angle=-HELIX)),
}
MODELS: dict[str, StiffnessModel] = {
    "potential-energy": PotentialEnergyStiffness(),
    "elastic-ring": ElasticRingStiffness(),
}


@njit
def summed(calls, compression, law, at):  # type: ignore[no-untyped-def]
    """All that the law says of a mesh that turns on by a seventieth of a period at each call, so that all is made."""
    total = 0.0
    for call in range(calls):
        said = tooth_force(call / 70.0, compression, 0.01, law, at)
        total += said[0] + said[1] + said[2] + said[3] + said[4] + said[5]
    return total


def contact_of(pair: GearPairGeometry, model: StiffnessModel) -> ToothContact:
    """The whole way from gears to their law, with nothing kept from the last time."""
    fresh = replace(pair, driver=replace(pair.driver), driven=replace(pair.driven))
    faces = face_slices(fresh) if fresh.overlap_ratio > 0.0 else None
    return tooth_contact(fresh, model, 100.0, corner_contact=True, faces=faces)


def least(work: Callable[[], object], repeats: int) -> float:
    """Processor seconds of the quickest run, after one that does not count."""
    work()
    seconds = []
    for _ in range(repeats):
        begin = time.process_time()
        work()
        seconds.append(time.process_time() - begin)
    return min(seconds)


def main() -> None:
    options = arguments(__doc__.splitlines()[0], repeats=(int, 7, "runs of each, of which the least is shown"))
    print(f"{machine()}\n")
    for name, pair in PAIRS.items():
        force = 71.77 / pair.driver.base_radius
        for model_name, model in MODELS.items():

            def curves(pair: GearPairGeometry = pair, model: StiffnessModel = model, force: float = force) -> None:
                contact = contact_of(pair, model)
                mesh_stiffness(contact, PHASES)
                loaded_transmission_error(contact, force, PHASES)

            seconds = least(curves, options.repeats)
            print(
                f"{name:8}  {model_name:17} stiffness and transmission error, 256 positions   {1e3 * seconds:8.2f} ms"
            )
        contact = contact_of(pair, MODELS["potential-energy"])
        torques = force * np.linspace(0.1, 2.0, 20)
        seconds = least(lambda contact=contact, torques=torques: harris_map(contact, torques, PHASES), options.repeats)
        print(f"{name:8}  {'':17} Harris map of 20 torques, 256 positions            {1e3 * seconds:8.2f} ms")
        law = contact.kernel_arguments
        seconds = least(lambda law=law: summed(CALLS, 2e-5, *law), STRETCHES * options.repeats) / CALLS
        print(f"{name:8}  {'':17} compiled law in a loop, a call                    {1e9 * seconds:8.1f} ns")
    plain = GearPairGeometry(replace(SPUR, tip_relief=None), replace(SPUR, tip_relief=None))
    seconds = timed(lambda: optimal_tip_relief(plain, MODELS["potential-energy"], [71.77 / SPUR.base_radius]))[1]
    print(f"{'spur':8}  {'potential-energy':17} best tip relief                                   {seconds:8.2f} s")


if __name__ == "__main__":
    main()
