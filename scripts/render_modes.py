"""Draw a housing's mode shapes off-screen: render_modes.py CASE OUT [key.path=value ...]

Writes one picture for each mode, OUT/mode-NN-FFFFHz.png, and all of them on one sheet, OUT/modes.png.
"""

import sys
from pathlib import Path

from gearwhine.case import load_case
from gearwhine.failures import run_script
from gearwhine.output import staging
from gearwhine.stages.housing import solve_housing
from gearwhine.stages.kept_modes import keep_modes
from housing.pictures import render_gallery, render_modes


def main(case_name: str, folder: str, *changes: str) -> None:
    case = load_case(case_name, changes).case
    housing = solve_housing(case, folder=Path(folder))
    numbers = range(1, len(housing.modes.frequencies) + 1)
    with staging(Path(folder)) as place:
        keep_modes(place, housing)
        files = render_modes(housing.mesh, housing.modes, numbers, place)
        files.append(render_gallery(housing.mesh, housing.modes, numbers, place / "modes.png"))
    for file in files:
        print(Path(folder) / file.name)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    run_script(main, sys.argv[1:])
