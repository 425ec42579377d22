"""Regenerate a housing's modes from its geometry: regenerate_modes.py CASE OUT [key.path=value ...]

Writes OUT/modes.csv (number, frequency, damping ratio, strength), OUT/modes.vtu (every shape, for ParaView) and
OUT/modes.nc, from which later commands and scripts on OUT read the modes in place of solving them again.
"""

import csv
import sys
from pathlib import Path

from gearwhine.case import load_case
from gearwhine.failures import run_script
from gearwhine.output import staging
from gearwhine.results import write_shapes
from gearwhine.results.housing import modes_document
from gearwhine.stages.housing import solve_housing
from gearwhine.stages.kept_modes import keep_modes


def main(case_name: str, folder: str, *changes: str) -> None:
    case = load_case(case_name, changes).case
    housing = solve_housing(case, progress=lambda message, fraction=None: print(f"  {message}", file=sys.stderr))
    document = modes_document(housing)
    with staging(Path(folder)) as place:
        with (place / "modes.csv").open("w", newline="") as file:
            writer = csv.DictWriter(file, ["number", "frequency_hz", "damping_ratio", "strength"])
            writer.writeheader()
            writer.writerows(document["modes"])
        write_shapes(place / "modes.vtu", housing)
        keep_modes(place, housing)
    for mode in document["modes"]:
        print(f"{mode['number']:3d} {mode['frequency_hz']:10.2f} Hz")
    certificate = document["certificate"]
    print(f"complete below {certificate['limit_hz']:.0f} Hz: {certificate['found']} of {certificate['expected']}")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    run_script(main, sys.argv[1:])
