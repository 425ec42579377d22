"""Names in the JSON of commands, which other programs read: none is renamed, and every document has its warnings."""

from typing import Any

import pytest

COARSE = ("--set", "housing.box.mesh_size=45 mm")

# Where a name stands in a list, each entry has it; names after a blank share what stands before their colon.
NAMES = {
    ("modes", "steel-box", *COARSE): """
        modes: number frequency_hz damping_ratio strength discretisation_error
        certificate: limit_hz expected found complete max_residual
        mesh: nodes elements dofs
        seconds: mesh assembly factorisation eigensolver total
        : mass_kg""",
    ("rotors", "friswell-rotor"): """
        rotors: name mass_kg lateral_hz torsional_hz critical_speeds_rpm certificate
        rotors.whirl: speed_rpm frequency_hz damping_ratio""",
    ("gears", "spur-pair", "--without", "relief"): """
        pairs: driver driven contact_ratio mesh_frequency_hz roll_angle_rad stiffness
        pairs.stiffness_n_per_m: mean min max
        pairs.transmission_error_m: mean peak_to_peak""",
    ("load", "spur-pair"): """
        bearings: name force_n moment_n_m displacement_m life_h
        gear_pairs: driver driven force_n misalignment_rad k_h_beta mean_stiffness_n_per_m
        gear_pairs.misalignment_by_cause_rad: shafts bearings housing bodies
        gear_pairs.transmission_error_m: peak_to_peak
        : residual""",
    ("system", "spur-pair"): """
        modes: frequency_hz damping_ratio kind
        : speed_rpm coordinates""",
    ("vary", "gear-62-62", "-n", "2"): """
        quantities: name unit mean std quantiles
        quantities.quantiles: 0,05 0,5 0,95
        yield: share low high
        : samples failed""",
    ("examples",): "examples: name title",
}
VARIED = (
    'variation.vary={"operation.torque"={normal=["200 N*m","5 N*m"]}}',
    'variation.limit={"gear_pair.*.transmission_error_peak_to_peak_m"={at_most=1e-5}}',
)


def at(value: Any, path: str) -> list[Any]:
    """Return all that stands at a path, in every entry of the lists on the way."""
    found = [value]
    for step in filter(None, path.split(".")):
        found = [one[step] for one in found]
        found = [entry for one in found for entry in (one if isinstance(one, list) else [one])]
    return found


@pytest.mark.parametrize("command", NAMES, ids=lambda command: command[0])
def test_a_document_keeps_its_names(answer, command: tuple[str, ...]) -> None:
    changes = [part for change in VARIED for part in ("--set", change)] if command[0] == "vary" else []
    outcome = answer(*command[:2], "--json", "-q", *command[2:], *changes)
    assert outcome.code == 0, outcome.err
    assert isinstance(outcome.document["warnings"], list)
    for line in NAMES[command].strip().splitlines():
        path, _, names = line.partition(":")
        entries = at(outcome.document, path.strip())
        assert entries
        wanted = {name.replace(",", ".") for name in names.split()}
        assert all(wanted <= set(entry) for entry in entries), path
