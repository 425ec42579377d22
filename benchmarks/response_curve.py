"""A response curve over speed against one transient of the same machine, in processor time.

    python benchmarks/response_curve.py

The bundled spur pair as it is, whose unbalance makes a period of 28 mesh periods, and balanced, when it repeats with
the mesh; from half its speed to beyond it. The transient is the case's own, twenty revolutions by Newmark's method and
by the exact march. Everything compiled is compiled before it is timed. ``--torque 20 --damping 0.01`` make a machine
that rattles: its branch turns through four folds and loses its stability in every other way, and takes more points for
it. Each curve says how far it was followed.
"""

import time
from collections.abc import Callable

import numpy as np
from timing import Result, arguments, machine

from gearwhine.case import Case, load_case
from gearwhine.coupling import periodic_response, response_curve
from gearwhine.coupling.analyses.steady_state import CURVE_TOLERANCE
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.coupling.periodic.continuation import ResponseCurve
from gearwhine.from_case.machine import describe_machine
from gearwhine.solve.machine import plan_of

RPM = 2.0 * np.pi / 60.0
BALANCED = "rotor.input.unbalance="


def processor_seconds(work: Callable[[], Result]) -> tuple[float, Result]:
    """How long something keeps the processor busy."""
    start = time.process_time()
    done = work()
    return time.process_time() - start, done


def curve_of(case: Case, low: float, high: float, points: int) -> ResponseCurve:
    """The branch between two speeds [rpm]."""
    built = describe_machine(case).assembled
    return response_curve(
        lambda speed: built.at_speed(speed).system, low * RPM, high * RPM, points=points, tolerance=CURVE_TOLERANCE
    )


def main() -> None:
    given = arguments(
        __doc__,
        points=(int, 100, "points of a straight branch"),
        low=(float, 2750.0, "lowest speed [rpm]"),
        high=(float, 6600.0, "highest speed [rpm]"),
        torque=(float, 71.77, "torque [N m]"),
        damping=(float, 0.05, "damping ratio of the mesh"),
    )
    print(machine())
    common = [f"operation.torque={given.torque}", f"gear_pair.0.damping_ratio={given.damping}"]
    for name, changes in (("as it is", common), ("balanced", [*common, BALANCED])):
        case = load_case("spur-pair", changes).case
        built = describe_machine(case).assembled
        print(f"\n{name}, {built.system.size} coordinates")
        transients = {}
        for method in ("newmark", "exact"):
            by = load_case("spur-pair", [*changes, f"transient.method={method}"]).case
            solve_transient(built, plan_of(by))
            transients[method], _ = processor_seconds(lambda by=by, built=built: solve_transient(built, plan_of(by)))
            print(f"  transient, {method:8s} {transients[method]:8.2f} s")
        speed = built.speeds[built.leading_rotor]
        periodic_response(built.at_speed(speed).system)
        seconds, curve = processor_seconds(lambda case=case: curve_of(case, given.low, given.high, given.points))
        told = ", ".join(f"{seconds / taken:.1f} x {method}" for method, taken in transients.items())
        print(f"  curve of {len(curve.speeds)} points, {len(curve.bifurcations)} events: {seconds:8.2f} s   {told}")
        print(f"  {curve.description(RPM, 'rpm')}")
        print(f"  a hundred points of it: {100 * seconds / len(curve.speeds):.2f} s")


if __name__ == "__main__":
    main()
