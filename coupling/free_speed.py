"""Free speed of a machine: run-up of the rigid train under motor and load torque.

The nominal rotation, about which the coordinates move, is that of the rigid train,

    J dω/dt = T_motor(ω) - T_load(ω),

J = Σ J_r (ω_r/ω)² at the first driver's rotor. Where a shaft is a little faster or slower than its nominal rotation,
the torques change by their slope over speed: :class:`coupling.loads.TorqueSlope`.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from coupling.errors import TransientError
from coupling.turning import SpeedProfile

FloatArray = npt.NDArray[np.float64]

_PIECES = 1024
_RPM = 60.0 / (2.0 * np.pi)


def free_speed(
    motor: Callable[[float], float],
    load: Callable[[float], float],
    inertia: float,
    *,
    start: float,
    duration: float,
    nominal: float,
) -> SpeedProfile:
    """Speed of the rigid train over time, piecewise linear with pieces of equal duration.

    Parameters
    ----------
    motor, load : callable
        Torque [N m] by speed [rad/s], at the first driver's rotor.
    inertia : float
        Of the train, at the same rotor [kg m²].
    start : float
        Speed at t = 0 [rad/s], not negative.
    duration : float
        [s].
    nominal : float
        Nominal speed, to which the result is relative [rad/s], positive.

    Raises
    ------
    TransientError
        Where the machine cannot start, or stalls.
    """
    from scipy.integrate import solve_ivp

    def surplus(speed: float) -> float:
        return motor(max(speed, 0.0)) - load(max(speed, 0.0))

    def stopped(_: float, state: FloatArray) -> float:
        return float(state[0])

    stopped.terminal = True  # type: ignore[attr-defined]
    stopped.direction = -1.0  # type: ignore[attr-defined]
    if start == 0.0 and surplus(0.0) <= 0.0:
        raise TransientError(
            f"the machine cannot start: at rest its motor gives {motor(0.0):.6g} N m against a load of "
            f"{load(0.0):.6g} N m; lower the load at rest, or start from a speed at which the motor is the stronger"
        )
    times = duration * np.arange(_PIECES + 1) / _PIECES
    # Torque lines have corners: steps no longer than a piece keep their places.
    found = solve_ivp(
        lambda _, state: [surplus(float(state[0])) / inertia],
        (0.0, duration),
        [start],
        t_eval=times,
        events=stopped,
        rtol=1e-10,
        atol=1e-12 * nominal,
        max_step=duration / _PIECES,
    )
    if found.status == 1:
        assert found.t_events is not None
        when = float(found.t_events[0][0])
        raise TransientError(
            f"the machine stalls at t = {when:.6g} s: it started at {start * _RPM:.6g} rpm and stands still, its "
            f"motor giving {motor(0.0):.6g} N m against a load of {load(0.0):.6g} N m; lower the load, or end the "
            "run before"
        )
    if not found.success:
        raise TransientError(f"the free speed cannot be followed beyond t = {found.t[-1]:.6g} s: {found.message}")
    return SpeedProfile(times, np.maximum(found.y[0], 0.0) / nominal)
