"""What follows from a case without solving anything: speeds, torques and mesh frequencies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from gearwhine.case.gears import Gear
from gearwhine.case.model import Case
from gearwhine.case.require import require
from gearwhine.case.train import Train, gear_train, shaft_of


@dataclass(frozen=True)
class AppliedTorque:
    """A torque from outside on a shaft.

    Attributes
    ----------
    shaft
        The rotor; the gear itself in a case without rotors.
    at
        Station from the rotor's left end [m]; None in a case without rotors.
    torque
        About +z, counter-clockwise positive [N m].
    """

    shaft: str
    at: float | None
    torque: float


def train_of(case: Case) -> Train:
    """Return the gear train of a case."""
    return gear_train(case.gear, enumerate(case.gear_pair))


def speed_ratios(case: Case) -> dict[str, Fraction]:
    """Return each shaft's speed over the first driver's, exact and signed; 1 for every rotor without gear pairs.

    Keys are rotor names, or gear names in a case without rotors.
    """
    if not case.gear_pair:
        return {name: Fraction(1) for name in _shafts(case)}
    return dict(train_of(case).ratios)


def rotor_speeds(case: Case, speed: float | None = None) -> dict[str, float]:
    """Return each shaft's speed [rad/s], positive counter-clockwise from +z.

    Parameters
    ----------
    case
        With gear pairs; without, every rotor turns at the same speed.
    speed
        Of the first driver's rotor [rad/s]; None: that of `[operation]`.

    Raises
    ------
    CaseError
        When no speed is given and the case has no `[operation]`.
    """
    if speed is None:
        require(case, "operation", command="rotor speeds")
        assert case.operation is not None
        speed = case.operation.speed
    return {name: speed * float(ratio) for name, ratio in speed_ratios(case).items()}


def mesh_frequencies(case: Case, speed: float | None = None) -> tuple[float, ...]:
    """Return the tooth-mesh frequency of each gear pair [Hz], in the order of the file; see `rotor_speeds`."""
    speeds = rotor_speeds(case, speed)
    drivers = (case.gear_named(pair.driver) for pair in case.gear_pair)
    return tuple(abs(speeds[shaft_of(gear)]) * gear.teeth / (2.0 * math.pi) for gear in drivers)


def applied_torques(case: Case, torque: float | None = None) -> tuple[AppliedTorque, ...]:
    """Return the torques from outside: the input first, then the outputs. They balance through the gears.

    Parameters
    ----------
    case
        With an `[operation]`.
    torque
        What comes in [N m], the outputs taking it in their proportions; None: the torque of `[operation]`.

    The input drives the first driver's shaft in its direction of turning; outputs work against the turning of theirs.
    Without outputs, the shafts that drive no other take equal power. Outputs are scaled, within the 1 % that a case
    may be off, to balance the input exactly. Without an `at`, the input is at the left end of its rotor, an output at
    the right end.

    Raises
    ------
    CaseError
        When the case has no `[operation]`.
    """
    require(case, "operation", command="torques")
    operation = case.operation
    assert operation is not None
    ratios = speed_ratios(case)
    entering = operation.torque if torque is None else torque
    if entering == 0.0 or not ratios or not (case.gear_pair or operation.output):
        return ()
    first = next(iter(ratios)) if case.gear_pair else operation.output[0].rotor
    turning = math.copysign(1.0, operation.speed)
    applied = [AppliedTorque(first, _station(case, first, operation.at, 0.0), turning * entering)]
    taken = [(output.rotor, output.torque, output.at) for output in operation.output]
    if not any(share for _, share, _ in taken):
        last = [(output.rotor, output.at) for output in operation.output]
        last = last or [(shaft, None) for shaft in train_of(case).last]
        taken = [(shaft, entering / len(last) / abs(float(ratios[shaft])), at) for shaft, at in last]
    power = sum(share * abs(float(ratios[shaft])) for shaft, share, _ in taken)
    for shaft, share, at in taken:
        against = -turning * math.copysign(1.0, ratios[shaft])
        balanced = share * entering / power
        applied.append(AppliedTorque(shaft, _station(case, shaft, at, 1.0), against * balanced))
    return tuple(applied)


def pair_torques(case: Case) -> tuple[float, ...]:
    """Return the mean torque that each gear pair takes off its driver [N m], in the order of the file.

    Positive where power flows from driver to driven. Speeds fix the power through every pair of a tree; where pairs
    form a loop, the smallest flows that balance are taken, which is what equal contacts would carry.

    Raises
    ------
    CaseError
        When the case has no `[operation]`.
    """
    ratios = speed_ratios(case)
    ends = [(shaft_of(case.gear_named(pair.driver)), shaft_of(case.gear_named(pair.driven))) for pair in case.gear_pair]
    entering = dict.fromkeys(ratios, 0.0)  # power over the first driver's speed, hence torques on one shaft
    for applied in applied_torques(case):
        turning = 1.0 if case.operation is None else math.copysign(1.0, case.operation.speed)
        entering[applied.shaft] += applied.torque * turning * float(ratios[applied.shaft])
    potential = _potentials(list(ratios), ends, entering)
    flows = [potential[driver] - potential[driven] for driver, driven in ends]
    return tuple(flow / abs(float(ratios[driver])) for flow, (driver, _) in zip(flows, ends, strict=True))


def _potentials(shafts: list[str], ends: list[tuple[str, str]], entering: dict[str, float]) -> dict[str, float]:
    """Solve the flow network of a connected train: L p = entering, the first shaft's potential zero.

    The least-norm flow f with B f = entering is f = Bᵀ p, L = B Bᵀ the graph's Laplacian. It is positive definite
    without the first shaft, so elimination needs no pivoting.
    """
    place = {shaft: index for index, shaft in enumerate(shafts)}
    size = len(shafts)
    rows = [[0.0] * size + [entering[shaft]] for shaft in shafts]
    for driver, driven in ends:
        i, j = place[driver], place[driven]
        rows[i][i] += 1.0
        rows[j][j] += 1.0
        rows[i][j] -= 1.0
        rows[j][i] -= 1.0
    for pivot in range(size - 1, 0, -1):
        for row in range(pivot):
            factor = rows[row][pivot] / rows[pivot][pivot]
            if factor != 0.0:
                rows[row] = [a - factor * b for a, b in zip(rows[row], rows[pivot], strict=True)]
    solution = [0.0] * size
    for row in range(1, size):
        known = sum(rows[row][column] * solution[column] for column in range(row))
        solution[row] = (rows[row][size] - known) / rows[row][row]
    return dict(zip(shafts, solution, strict=True))


def _shafts(case: Case) -> list[str]:
    return [rotor.name for rotor in case.rotor] or [gear.name for gear in case.gear]


def _station(case: Case, shaft: str, at: float | None, default: float) -> float | None:
    """Return the station of a torque; by default at this fraction of the rotor's length."""
    if not case.rotor:
        return None
    return at if at is not None else default * case.rotor_named(shaft).length


def gears_on(case: Case, shaft: str) -> tuple[Gear, ...]:
    """Return the gears that turn with a shaft."""
    return tuple(gear for gear in case.gear if shaft_of(gear) == shaft)
