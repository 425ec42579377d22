"""Warnings of a machine's operation: idle gear pairs, torque lines, loads over time, and loads of its bearings.

Gear pairs without torque, and lines of torque that miss the torque of operation, are warned of before anything is
solved. Loads that an analysis finds are compared with those that the bearings' stiffness was computed for.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.machine.base_motion import BaseHistory
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.coupling.machine.speed_profile import FreeRun
from gearwhine.coupling.machine_description import Machine
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.result_warnings import ResultWarning, warning

_UNWARNED_DIFFERENCE = 0.1  # difference of both forces up to which no warning is given, as a part of the larger one
_LOAD_ROUNDING = 1e-6  # part of the load below which a component counts as zero
_OFF_LINE = 0.05  # difference of a line from the torque of operation without a warning, as a part of the larger torque


def operation_warnings(machine: Machine) -> list[ResultWarning]:
    """Warn of gear pairs without torque, of several outputs without names, and of torque lines that miss the torque.

    Outputs that are named may leave a pair idle, or share the torque, on purpose.
    """
    if not machine.gear_pairs:
        return []
    warnings = []
    torques = np.abs(machine.pair_torques)
    for pair, torque in zip(machine.gear_pairs, torques, strict=True):
        if not machine.outputs and torques.max() > 0.0 and torque <= _LOAD_ROUNDING * torques.max():
            message = (
                f"{pair.label} carries no torque, as nothing is taken off behind it: are its driver and driven "
                "exchanged, or does an [[operation.output]] lack?"
            )
            warnings.append(warning("idle gear pair", message, gear_pair=f"{pair.driver} -> {pair.driven}"))
    outputs = machine.train.output_shafts
    if not machine.outputs and torques.max() > 0.0 and len(outputs) > 1:
        first, shaft = machine.gear_pairs[0], machine.train.first
        names = ", ".join(f'"{name}"' for name in outputs)
        message = (
            f'torque and speed of operation are those of "{shaft}", the shaft of the first driver, and {names} take '
            f"equal power, as no [[operation.output]] says otherwise: are driver and driven of {first.label} exchanged?"
        )
        warnings.append(warning("several outputs", message, input=shaft, outputs=list(outputs)))
    for name, line in (("motor", machine.motor), ("load", machine.load)):
        if line is None:
            continue
        torque = line.at(abs(machine.speed))
        if abs(torque - machine.torque) > _OFF_LINE * max(abs(torque), abs(machine.torque)):
            message = (
                f"[operation.{name}] has {torque:.4g} N·m at the speed of operation, where the torque is "
                f"{machine.torque:.4g} N·m: only a [transient.run] whose speed is free follows the line, all else "
                "has the torque"
            )
            warnings.append(warning("torque line", message, line=name, line_n_m=torque, torque_n_m=machine.torque))
    return warnings


def unbalanced_torque_warnings(machine: Machine, run: Run | None) -> list[ResultWarning]:
    """Warn of torques over time that do not balance, so that a train turns away from its nominal rotation."""
    net, free = machine.unbalanced_torque, isinstance(run, FreeRun)
    if net == 0.0:
        return []
    speed = "the speed told is that of motor and load alone" if free else "its speed is no longer that of operation"
    remedy = "put them into [operation.motor] and [operation.load]" if free else "balance them, or take a free run"
    message = (
        f"torques `over_time` leave up to {net:.4g} N·m at the first driver unbalanced: the train turns away from its "
        f"nominal rotation, {speed}, and meshes, unbalance and spectra follow the nominal one; {remedy}"
    )
    return [warning("unbalanced torque", message, torque_n_m=net)]


def constant_speed_warnings(machine: Machine) -> list[ResultWarning]:
    """Warn of loads over time, which have no part in a motion that repeats at constant speed and torque."""
    left_out = [key for key in ("over_time",) if machine.torque_over_time is not None]
    left_out += ["output.over_time" for output in machine.outputs if output.over_time is not None][:1]
    if machine.base is not None and any(isinstance(part, BaseHistory) for part in machine.base.parts):
        left_out.append("base.over_time")
    if not left_out:
        return []
    keys = " and ".join(f"operation.{key}" for key in left_out)
    message = f"{keys} take no part in a motion that repeats, which is that at constant torque; `run` has them"
    return [warning("loads over time", message, keys=[f"operation.{key}" for key in left_out])]


def bearing_load_warnings(
    bearings: Sequence[MountedBearing],
    mean_force: Mapping[str, FloatArray],
    found_by: str = "the run",
    known: Sequence[ResultWarning] = (),
) -> list[ResultWarning]:
    """Warn of bearings whose stiffness was made for another load than the mean force of the shaft on them.

    The stiffness of rolling bearings and stops depends on their load. Radial forces are compared as
    vectors, since elements are pressed where the load points; the axial ones beside them. A difference counts against
    the resultant load, so that a small component does not matter.

    Parameters
    ----------
    bearings : sequence of MountedBearing
    mean_force : mapping of str to ndarray, shape (3,)
        Mean force on each bearing along x, y, z [N].
    found_by : str
        Analysis that finds the force, for the message.
    known : sequence of mapping
        Warnings that exist already; bearings that they name are left out.
    """
    warnings = []
    named = {entry["bearing"] for entry in known if entry["name"] == "bearing load"}
    for mounted in bearings:
        name = mounted.bearing.name
        if mounted.design_load is None or name not in mean_force or name in named:
            continue
        assumed = np.array(mounted.design_load)
        actual = np.asarray(mean_force[name], dtype=np.float64)
        scale = max(float(np.linalg.norm(assumed)), float(np.linalg.norm(actual)))
        radial = float(np.hypot(*(actual - assumed)[:2]))
        axial = abs(float(actual[2] - assumed[2]))
        if max(radial, axial) <= _UNWARNED_DIFFERENCE * scale:
            continue
        # The message proposes a load for the case, which must be free of rounding errors.
        actual = np.where(np.abs(actual) > _LOAD_ROUNDING * scale, actual, 0.0)
        sizes = [(float(np.hypot(*force[:2])), float(force[2])) for force in (assumed, actual)]
        warnings.append(
            warning(
                "bearing load",
                f'bearing "{name}": its stiffness was made for a load of {sizes[0][0]:.4g} N radial and '
                f"{sizes[0][1]:.4g} N axial, {found_by} finds {sizes[1][0]:.4g} N radial and "
                f"{sizes[1][1]:.4g} N axial; "
                f"give it the load {{ x = {actual[0]:.4g}, y = {actual[1]:.4g}, z = {actual[2]:.4g} }} N",
                bearing=name,
                assumed_force_n=assumed.tolist(),
                mean_force_n=actual.tolist(),
            )
        )
    return warnings
