"""The steady state's part of the results file: one period of each motion, and the branch over speed."""

import numpy as np
import numpy.typing as npt

from gearwhine.stages.steady import SolvedSteady
from housing.netcdf import Variables

FloatArray = npt.NDArray[np.float64]

_RPM = 60.0 / (2.0 * np.pi)


def write_steady(solved: SolvedSteady, variables: Variables, coordinates: Variables) -> None:
    """Add motions at the speed of operation and the branch; what has no gears or sensors leaves theirs out."""
    if solved.superposed is not None:
        _superposed(solved, variables, coordinates)
        return
    motions = solved.motions
    coordinates["steady_motion"] = ("steady_motion", np.arange(1, len(motions) + 1), _unit("1", "motion at operation"))
    times = motions[0].histories.times
    coordinates["period_time"] = ("period_time", times, _unit("s", "time in the period"))
    variables["steady_stable"] = ("steady_motion", [motion.response.stable for motion in motions], {})
    multipliers = np.array([motion.response.floquet.values for motion in motions])
    coordinates["part"] = ("part", ["real", "imaginary"], {})
    variables["floquet_multiplier"] = (
        ("steady_motion", "multiplier", "part"),
        np.stack([multipliers.real, multipliers.imag], axis=-1),
        _unit("1", "Floquet multiplier: growth of a disturbance in a period"),
    )
    named = motions[0].histories
    for name, dimension, groups, unit, what in (
        (
            "steady_mesh_force",
            "contact",
            [motion.histories.mesh_force for motion in motions],
            "N",
            "gear-mesh force along the line of action",
        ),
        (
            "steady_sensor_acceleration",
            "sensor",
            [motion.histories.sensor_acceleration for motion in motions],
            "m/s2",
            "acceleration along the sensor",
        ),
    ):
        if groups[0]:
            coordinates[dimension] = (dimension, list(groups[0]), {})
            values = np.array([list(group.values()) for group in groups])
            variables[name] = (("steady_motion", dimension, "period_time"), values, _unit(unit, what))
    if solved.curve is not None:
        _branch(solved, list(named.sensor_acceleration), variables, coordinates)


def _superposed(solved: SolvedSteady, variables: Variables, coordinates: Variables) -> None:
    """One period of the motion of each group of excitations, over parts of the period: their sum has none."""
    motions = solved.motions
    coordinates["excitation"] = ("excitation", [motion.excitation for motion in motions], {})
    periods = [motion.response.period for motion in motions]
    variables["excitation_period"] = ("excitation", periods, _unit("s", "period of the motion"))
    variables["excitation_stable"] = ("excitation", [motion.response.stable for motion in motions], {})
    count = max(len(motion.histories.times) for motion in motions)
    part = np.arange(count) / count
    coordinates["period_part"] = ("period_part", part, _unit("1", "time as a part of the motion's period"))
    for name, dimension, groups, unit, what in (
        (
            "excitation_mesh_force",
            "contact",
            [motion.histories.mesh_force for motion in motions],
            "N",
            "gear-mesh force along the line of action in the motion of each group of excitations",
        ),
        (
            "excitation_sensor_acceleration",
            "sensor",
            [motion.histories.sensor_acceleration for motion in motions],
            "m/s2",
            "acceleration along the sensor in the motion of each group of excitations",
        ),
    ):
        if groups[0]:
            coordinates[dimension] = (dimension, list(groups[0]), {})
            values = np.array([[_resampled(signal, count) for signal in group.values()] for group in groups])
            variables[name] = (("excitation", dimension, "period_part"), values, _unit(unit, what))


def _resampled(signal: FloatArray, count: int) -> FloatArray:
    """A whole period at another number of samples, by its own lines."""
    if len(signal) == count:
        return signal
    lines = np.fft.rfft(signal)
    return np.asarray(np.fft.irfft(lines, count) * (count / len(signal)))


def _branch(solved: SolvedSteady, sensors: list[str], variables: Variables, coordinates: Variables) -> None:
    curve = solved.curve
    assert curve is not None
    point = "branch_point"
    told = {"ending": curve.ending, "account": curve.told(1.0 / _RPM, "rpm")}
    variables["branch_speed"] = (point, curve.speeds * _RPM, _unit("rpm", "speed of the first driver") | told)
    variables["branch_stable"] = (point, curve.stable, {"long_name": "whether no small disturbance grows"})
    contacts = [contact.name for contact in solved.machine.system.contacts]
    if contacts:
        coordinates["contact"] = ("contact", contacts, {})
        for name, values, unit, what in (
            ("branch_compression", curve.rms_compression, "m", "a.c. rms of the compression of the mesh"),
            ("branch_peak_force", curve.peak_force, "N", "largest gear-mesh force"),
            ("branch_contact_loss", curve.contact_loss, "1", "part of the period that the flanks are apart"),
        ):
            variables[name] = ((point, "contact"), values, _unit(unit, what))
    if sensors:
        rms = np.stack([solved.branch_rms[name] for name in sensors], axis=-1)
        variables["branch_sensor_rms"] = ((point, "sensor"), rms, _unit("m/s2", "rms of the sensor's acceleration"))
    coordinates["branch_event"] = ("branch_event", [event.kind for event in curve.bifurcations], {})
    speeds = np.array([event.speed for event in curve.bifurcations]) * _RPM
    variables["branch_event_speed"] = (
        "branch_event",
        speeds,
        _unit("rpm", "where the branch turns or its stability changes"),
    )


def _unit(unit: str, what: str) -> dict[str, str]:
    return {"units": unit, "long_name": what}
