"""Compare a housing's modes with measured ones: compare_modes.py CASE OUT [key.path=value ...]

Writes OUT/comparison.json, .csv and .png and prints the pairs. Frequencies alone are paired by dominance, in order.
"""

import sys
from pathlib import Path

from gearwhine.case import load_case
from gearwhine.comparison_files import draw_comparison_pictures, write_comparison
from gearwhine.failures import run_script
from gearwhine.output import finite, json_text, staging
from gearwhine.results.comparison import comparison_document
from gearwhine.stages.comparison import compare_housing
from gearwhine.stages.housing import solve_housing
from gearwhine.stages.kept_modes import keep_modes


def main(case_name: str, folder: str, *changes: str) -> None:
    case = load_case(case_name, changes).case
    housing = solve_housing(case, folder=Path(folder))
    comparison = compare_housing(case, housing)
    document = comparison_document(comparison, housing)
    with staging(Path(folder)) as place:
        keep_modes(place, housing)
        write_comparison(place, comparison)
        draw_comparison_pictures(place, case.title, comparison, housing.modes.frequencies)
        (place / "comparison.json").write_text(json_text(finite(document)) + "\n", encoding="utf-8")
    print("measured [Hz]  model [Hz]  error")
    for pair in document["pairs"]:
        print(f"{pair['measured_hz']:13.0f}  {pair['model_hz']:10.1f}  {pair['error_percent']:+.2f} %")
    print(f"largest {document['max_error_percent']:.2f} %, rms {document['rms_error_percent']:.2f} %,", end=" ")
    print(f"gap ln {document['gap']:.3f}, measures agree: {document['measures_agree']}")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    run_script(main, sys.argv[1:])
