"""Sentences and tables of what few results have, word for word: documents by hand, all of their numbers distinct."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest

from gearwhine.coupling.sound.solution import SolvedSound
from gearwhine.coupling.sweep.missed_peaks import MissedPeak
from gearwhine.output.sections import Finding, Table
from gearwhine.results import (
    check,
    comparison,
    condition,
    first_page,
    gears,
    housing,
    mesh_lines,
    operating_point,
    optimisation,
    sound,
    steady_state,
    survey,
    system,
    update,
)
from gearwhine.results import run as motion
from gearwhine.results.motion import plain
from gearwhine.results_folder import export_sections
from gearwhine.sweep.resolution import peak_warnings

Document = dict[str, Any]


def told(content: Iterable[str | Table | Finding]) -> list[str]:
    """Return sentences as they are, and of a table its caption, its heads and its rows with the cells apart by bars."""
    lines = list[str]()
    for one in content:
        if isinstance(one, Table):
            columns, rows = one.filled()
            lines.append(f"[{one.caption}]")
            lines += [" | ".join(cells).replace("\n", " ") for cells in ([c.heading for c in columns], *rows)]
        else:
            lines.append(str(one))
    return lines


def test_condition_of_gears_with_the_reasons_of_what_is_undefined() -> None:
    """A reason that holds for two indicators is said once, and the limit is that of the averages."""
    reason, steady = "the average has no mesh harmonics", "the speed varies over the record"
    of_top = {"rms_m_per_s2": 1.25, "difference_rms_m_per_s2": 0.5, "fm4": 3.125, "m6a": None, "na4": 7.0}
    of_top |= {"sideband_index_m_per_s2": 0.0625, "sideband_level_factor": None, "spectral_kurtosis": None}
    top = {"sensor": "top", "indicators": of_top}
    top |= {"undefined": {"m6a": reason, "sideband_level_factor": reason, "spectral_kurtosis": steady}}
    side = {"sensor": "side", "indicators": dict.fromkeys(of_top, 2.0)}
    watched = [{"gear": "pinion", "sensors": [top, side]}, {"gear": "wheel", "sensors": [], "undefined": "it stands"}]
    tones = [{"tone": "outer race of front", "frequency_hz": 187.25, "envelope": {"top": 0.375, "side": None}}]
    lines = told(condition.content({"limit_hz": 4321.0, "gears": watched, "tones": tones}))
    assert lines[:-1] == [
        "[Condition of the gears]",
        "gear | sensor | rms [m/s²] | difference rms [m/s²] | FM4 | M6A | NA4 | sideband index [m/s²] | "
        "sideband level factor",
        "pinion | top | 1.25 | 0.5 | 3.125 | – | 7 | 0.0625 | –",
        " | side | 2 | 2 | 2 | 2 | 2 | 2 | 2",
        "[]",
        "gear | sensor | spectral kurtosis",
        "pinion | top | –",
        " | side | 2",
        f"Undefined of gear 'pinion' at sensor 'top': M6A, sideband level factor, as {reason}.",
        f"Undefined of gear 'pinion' at sensor 'top': spectral kurtosis, as {steady}.",
        "Gear 'wheel' has no indicators: it stands.",
        "[Envelope spectra at the tones of rolling bearings]",
        "bearing tone | Hz | sensor | envelope line / mean",
        "outer race of front | 187.2 | top | 0.375",
        "outer race of front | 187.2 | side | –",
    ]
    assert "up to 4321 Hz, the trusted limit" in lines[-1]


def _updated(**changes: Any) -> Document:
    stiffness = {"name": "support.k", "before": 2e8, "after": 1.5e8, "standard_deviation": 1.25e7}
    stiffness |= {"written_unit": "N/µm", "written_unit_in_si": 1e6, "left_of_prior_spread": 0.996}
    pair = {"mode": 3, "measured_hz": 812.0, "before_hz": 850.5, "before_error_percent": 4.74, "model_hz": 808.25}
    mode = {"measured_hz": 633.0, "predicted_hz": 640.5, "error_percent": 1.18, "standard_deviation_percent": 2.25}
    return {
        "parameters": [stiffness | {"at_end_of_range": True}, stiffness | {"name": "b", "at_end_of_range": False}],
        "pairs": [
            pair | {"error_percent": -0.46, "mac": 0.87},
            dict.fromkeys(pair) | {"measured_hz": 977.0, "error_percent": None, "mac": None},
        ],
        "pairing_rule": "shapes",
        "max_error_percent": 3.21,
        "rms_error_percent": 1.98,
        "before": {"rms_error_percent": 6.54, "max_error_percent": 9.87},
        "model_modes": {"count": 11, "below_hz": 2345.0},
        "wrong_pairs": 2,
        "search": {"steps": [0, 1, 2, 3], "mesh_dofs": 1234},
        "mesh": {"dofs": 56789},
        "seconds": {"total": 77.0},
        "identifiability": {
            "parameters": 5,
            "learned_combinations": 1,
            "confounded": [{"parameters": ["E", "rho"], "correlation": -0.93}],
        },
        "held_back": [mode | {"before_error_percent": 5.5, "rms_error_percent_of_the_others": 0.75}],
        "null": {
            "sets": 20,
            "within_5_percent": 0.65,
            "within_2_percent": 0.4,
            "within_1_percent": 0.15,
            "all_met": 0.1,
            "as_good_in_rms": 0.3,
            "measured_likewise": {"rms_error_percent": 2.22, "max_error_percent": 4.44},
        },
        "warnings": [{"message": "something is odd"}],
    } | changes


_PAIRED = "Paired by shapes: largest error 3.21 %, rms 1.98 % (before: 6.54 %); 11 model modes below 2345 Hz; "
_RANDOM = (
    "Of 20 random sets of as many frequencies the same search on the coarser mesh fits 65 % within 5 %, 40 % within 2 "
    "% and 15 % within 1 % each, and meets for 10 % all that is asked for.",
    "The measured ones come there to 2.22 % root mean square, 4.44 % at most; 30 % of the random sets do as well.",
)


def test_a_fitted_housing_with_all_its_tests() -> None:
    assert told(update._content(_updated())) == [
        "[]",
        "parameter | before | after | give or take | of the prior's | ",
        "support.k | 200 N/µm | 150 N/µm | 12.5 N/µm | 100 % | at the end of its range",
        "b | 200 N/µm | 150 N/µm | 12.5 N/µm | 100 % | ",
        "[]",
        "mode | measured [Hz] | before [Hz] | error | after [Hz] | error",
        "3 | 812 | 850.5 | +4.74 % | 808.2 | -0.46 %",
        "none | 977 | none | none | none | none",
        f"{_PAIRED}MAC from 0.87 to 0.87, 2 without a partner.",
        "4 designs solved on the way, the first on a mesh of 1234 degrees of freedom, verified on one of 56789; 77 s.",
        "Of 5 parameters the data tell 1 combination better than the prior did; the rest stays what was assumed.",
        "  not told apart: E and rho (correlation -0.93)",
        "[]",
        "held back [Hz] | predicted [Hz] | error | expected | error before | rms of others",
        "633 | 640.5 | +1.18 % | ± 2.25 % | +5.50 % | 0.75 %",
        *_RANDOM,
        "So the errors alone say little of this housing: it is a plausible one, calibrated.",
        "Mind: something is odd.",
    ]
    chapter = update.report(_updated())
    assert told(chapter.sentences)[:4] == [
        "Before: 6.54 % root mean square, 9.87 % at most.",
        "The data tell 1 combination of the 5 numbers better than the prior.",
        *_RANDOM,
    ]
    assert [table.caption for table in chapter.tables] == ["", "Each mode predicted by a fit to the others"]


@pytest.mark.parametrize(
    ("changes", "choice"),
    [
        ({}, "no shapes and no dominance tell which modes are which"),
        ({"gap": None, "measures_agree": True}, "no mode of the band is left out of the pairs"),
        ({"gap": 0.34, "measures_agree": True}, "gap 0.34, the three measures of dominance agree"),
        ({"gap": 0.34, "measures_agree": False}, "gap 0.34, the three measures of dominance do not all agree"),
    ],
)
def test_how_sure_a_pairing_without_shapes_is(changes: Document, choice: str) -> None:
    document = _updated(pairs=[pair | {"mac": None} for pair in _updated()["pairs"]], **changes)
    del document["null"], document["held_back"], document["warnings"]
    lines = told(update._content(document))
    assert f"{_PAIRED}{choice}." in lines
    assert lines[-1] == "How often random frequencies are fitted as well: --null 20. Modes held back: --held-back."


def test_comparison_by_shapes_with_modes_of_every_kind() -> None:
    document = {
        "pairing_rule": "MAC",
        "pairs": [],
        "model_modes": {"count": 9, "below_hz": 3000.0},
        "unpaired_measured": [{"measured_mode": 4, "measured_hz": 1717.0, "most_like": 6, "mac": 0.31}],
        "unpaired_model": [{"mode": 7, "model_hz": 1818.0}, {"mode": 8, "model_hz": 1919.0}],
        "duplicates": [{"modes": [2, 3], "mac": 0.96}],
        "look_alikes": {"measured": [{"modes": [1, 5], "mac": 0.84}], "model": [{"modes": [9, 10], "mac": 0.91}]},
        "close_modes": [
            {"modes": [11, 12], "measured_modes": [13, 14], "largest_angle_deg": 12.3},
            {"modes": [15], "measured_modes": [16, 17], "largest_angle_deg": None},
            {"modes": [18, 19], "measured_modes": [20, 21], "largest_angle_deg": float("nan")},
        ],
        "auto_mac_off_diagonal": {"measured": 0.22, "model": 0.99},
        "phase_collinearity": [0.99, 0.12, 0.98, 0.23],
        "responses": {
            "lines": 801,
            "from_hz": 100.0,
            "to_hz": 2600.0,
            "mean": 0.55,
            "frac": [[0.25, None], [0.75, 0.66]],
        },
        "cross_orthogonality": {"missing_because": "the survey has too few points"},
    }
    lines = told(comparison._by_shapes(document))
    bent = lines.pop(-3)
    assert bent.startswith("Complex shapes (phase collinearity below 0.")
    assert bent.endswith("): measured 2, 4.")
    assert lines == [
        "Paired by MAC: no measured mode is like one of 9 model modes.",
        "Measured mode 4 (1717 Hz) has no partner: most like mode 6, MAC 0.31.",
        "Model modes in the measured band that no measured mode is: 7 (1818 Hz), 8 (1919 Hz).",
        "Measured modes 2 and 3 may be one mode found twice (MAC 0.96).",
        "The survey cannot tell measured modes 1 and 5 apart (MAC 0.84): it needs more points.",
        "The survey cannot tell model modes 9 and 10 apart (MAC 0.91): it needs more points.",
        "Modes 11, 12 are close and compared as one space: measured 13, 14, largest angle 12.3°.",
        "Modes 15 are close and compared as one space: measured 16, 17.",
        "Modes 18, 19 are close and compared as one space: measured 20, 21.",
        "Largest MAC between different modes: 0.22 of the test, 0.99 of the model; a survey with more points would "
        "tell modes apart better.",
        "Likeness of 3 responses over 801 lines from 100 to 2600 Hz (FRAC): mean 0.55, from 0.25 to 0.75; a resonance "
        "a few per cent off costs most of it.",
        "No cross-orthogonality: the survey has too few points.",
    ]
    assert told(comparison._responses({"missing_because": "none"})) == ["No likeness of responses: none."]
    assert told(comparison._by_frequency(document | {"pairing": "order", "chance_error_percent": 2.5})) == [
        "Measured modes for which the model has none: 4 (1717 Hz).",
        "Model modes between the measured ones that are left out of the pairs: 7 (1818 Hz), 8 (1919 Hz).",
        "Weak evidence: a frequency at random in the band is 2.5 % (rms) from the nearest mode of the model.",
    ]
    assert told(comparison._by_frequency({"pairing": "frequency", "pairs": [1], "unpaired_measured": []})) == []
    assert told(comparison._by_frequency({"pairing": "order"})) == [
        "Weak evidence where either side lacks a mode: all pairs above it are then shifted by one."
    ]


def test_optimised_designs_by_the_transient() -> None:
    """A design whose transient fails has a sentence and no column; only a whole comparison confirms the ranking."""
    start = {
        "linear_level_db": {"top": 81.25},
        "motion_level_db": {"top": 79.5},
        "peak_force_ratio": {"a → b": 1.5},
        "contact_loss": {"a → b": 0.125},
        "highest_level_db": {"top": 93.75},
        "loudest_speed_rpm": {"top": 4321.0},
    }
    best = {key: {of: 0.5 * value for of, value in one.items()} for key, one in start.items()} | {"contact_loss": {}}
    chosen = [{"design": "best"}, {"design": "other"}]
    checked = {"speeds_rpm": [-3000.0, 1234.56], "start": start, "designs": [best, best], "contradicted": []}
    document = {"chosen": chosen, "verification": checked}
    lines = [
        "[Start and proposed designs by the full machine at 1234.6, -3000 rpm]",
        "of | quantity | start | best",
        "sensor top | lines of the teeth, linear [dB re 1 µm/s²] | 81.2 | 40.6",
        "sensor top | transient [dB re 1 µm/s²] | 79.5 | 39.8",
        "a → b | largest tooth force / mean | 1.500 | 0.750",
        "a → b | part of the time without contact | 0.125 | ",
        "sensor top | highest over the speed range, linear [dB re 1 µm/s²] | 93.8 | 46.9",
        "sensor top | at the speed [rpm] | 4321 | 2160",
    ]
    confirmed = "The transient confirms the ranking by the linear machine."
    assert told(optimisation._checked(document))[-1] == confirmed
    for changes in ({"contradicted": ["top"]}, {"start": start | {"linear_level_db": {}}}):
        assert confirmed not in told(optimisation._checked(document | {"verification": checked | changes}))
    checked["designs"] = [best, {"failure": "no equilibrium"}]
    failed = "The transient of the design 'other' cannot be solved: no equilibrium"
    assert told(optimisation._checked(document)) == [failed, *lines]


@pytest.mark.parametrize(("scale", "passed"), [(1e-9, True), (1.0, False)])
def test_proofs_of_a_sweep_are_those_of_its_worst_point(scale: float, passed: bool) -> None:
    points = [
        {"settings": {"speed": f"{n} rpm", "torque": "7 N m"}, "steps": 100 + n, "load": {"residual": scale * 0.25 * n}}
        | {"energy_error": scale * (4 - n) * 0.25}
        for n in (1, 2, 3)
    ]
    energy, forces = first_page._point_proofs(SimpleNamespace(points=points))  # type: ignore[arg-type]
    assert energy.text.startswith(
        f"Sweep: the energy balance of 3 points closes to {0.75 * scale:.0e} or better; worst at speed=1 rpm, torque=7 "
        "N m, over 101 steps (bound: "
    )
    assert forces.text.startswith(
        f"Sweep: at the operating points forces balance to {0.75 * scale:.0e} of the largest load or better; worst at "
        "speed=3 rpm, torque=7 N m (bound: "
    )
    assert (energy.passed, forces.passed) == (passed, passed)
    assert (energy.link, forces.link) == (("section Sweep",), ("section Sweep",))


def test_superposed_motions_with_what_they_leave_out() -> None:
    closed = {"stable": True, "period_s": 0.00125, "residual": 1e-12, "error": 2e-5, "largest_multiplier": 0.1}
    excitation = {"name": "mesh a → b"} | closed
    pair = {"driver": "a", "driven": "b", "neglected_force_n": 12.5, "neglected_part": 0.0375}
    line = {"amplitude_m_per_s2": 0.125, "frequency_hz": 812.5, "name": "2× mesh"}
    quiet = {"name": "side", "neglected_rms_m_per_s2": 0.5}
    sensors = [{"name": "top", "neglected_rms_m_per_s2": 0.75, "neglected_lines": [line, line]}, quiet]
    document = {"excitations": [excitation], "hunting_mesh_cycles": 1519, "gear_pairs": [pair], "sensors": sensors}
    said = steady_state._motion(document, "", ())
    lines = [next(said) for _ in range(6)]
    assert "superposed" in str(lines[0])
    assert str(lines[1]).startswith("The same teeth meet after 1519 mesh cycles: ")
    assert lines[2:] == [
        # A disturbance that falls to a tenth over a period does so in 1.25 ms.
        "  mesh a → b: period 1.25 ms, stable, the slowest disturbance falls to a tenth in 0.00125 s; closes to 1e-12, "
        "changes by 2e-05 with steps half as long",
        "  left out in a → b: 12.5 N rms, 3.75 % of its varying force",
        "  by that at top, estimated: 0.75 m/s² rms, highest 0.125 m/s² at 812.5 Hz (2× mesh)",
        "  by that at side, estimated: 0.5 m/s² rms",
    ]
    undecided = closed | {"stable": False, "stability": "not decided", "largest_multiplier_error": 0.03, "switches": 4}
    assert steady_state._proof(undecided, "") == (
        "period 1.25 ms, stability not decided (largest Floquet multiplier 0.1 ± 0.03); closes to 1e-12, changes by "
        "2e-05 with elements half as long"
    )


def test_bearings_and_walls_that_change_lines_most() -> None:
    """Each table has the parameters of its kind alone, the strongest first, by the level of either step."""

    def influence(name: str, kind: str, level: float, **more: Any) -> Document:
        row = {"level_db": level, "first_order_db": 0.5 * level, "reverse_level_db": -0.25 * level} | more
        other = dict.fromkeys(row, 99.0)
        step = {"parameter": name, "kind": kind, "step_words": f"+{len(name)} %", "reverse_words": "reverse"}
        return step | {"lines": [other, row], "sound": [row, other], "sound_a": row}

    strengths = [
        influence("rib", "thickness", 0.5),
        influence("wall", "thickness", -1.5, first_order_is_off=True),
        influence("front", "bearing stiffness", 0.25, reverse_level_db=-3.0),
        influence("back", "bearing preload", 1.0),
    ]
    line = {"sensor": "top", "frequency_hz": 812.0, "ranked": True}
    document: Document = {"sensitivity": strengths, "sensor_lines": [line | {"sensor": "side", "ranked": False}, line]}
    heads = "parameter | of | step | level [dB] | first order [dB] | reverse | level [dB]"
    tables = [
        [
            heads,
            "wall | thickness | +4 % | -1.50 | -0.75 (off) | reverse | +0.38",
            "rib | thickness | +3 % | +0.50 | +0.25 | reverse | -0.12",
        ],
        [
            heads,
            "front | stiffness | +5 % | +0.25 | +0.12 | reverse | -3.00",
            "back | preload | +4 % | +1.00 | +0.50 | reverse | -0.25",
        ],
    ]

    def expected(quantity: str) -> list[str]:
        captions = (f"[Change of {quantity} by a step of one parameter of {of}]" for of in ("the housing", "a bearing"))
        return [line for caption, rows in zip(captions, tables, strict=True) for line in (caption, *rows)]

    for place, row in enumerate(document["sensor_lines"]):
        row |= {"excitation": f"{place + 1}× mesh", "amplitude_m_per_s2": 0.125 + place}
    lines = told(operating_point._lines(document | {"lines_without": "bearing rates"}))
    assert lines[:4] == [
        "[Sensors' lines at mesh harmonics, linear about the mean load]",
        "sensor | excitation | [Hz] | [m/s²]",
        "side | 1× mesh | 812.0 | 0.125",
        "top | 2× mesh | 812.0 | 1.12",
    ]
    at = lines.index("[Change of the line of top at 812 Hz by a step of one parameter of the housing]")
    assert lines[at:-2] == expected("the line of top at 812 Hz")
    assert lines[-2].startswith("(off): ")
    assert lines[-1] == (
        "In these changes damping ratios, friction of the teeth and mean mesh forces are kept; the case fixes bearing "
        "rates, which do not follow the walls"
    )
    del document["sensor_lines"]
    loud = [
        {"excitation": f"{n}× mesh", "frequency_hz": hertz, "sound_power_db": 80.5 + n, "sound_power_db_a": 70.25 - n}
        | {"ranked": n == 1}
        for n, hertz in ((1, 633.0), (2, 977.0))
    ]
    for second, quantity in (
        (True, "the A-weighted sound power of 2 lines together"),
        (False, "the sound power at 633 Hz"),
    ):
        loud[1]["ranked"] = second
        lines = told(operating_point._lines(document | {"loudest_lines": loud, "lines_without": None}))
        at = lines.index(f"[Change of {quantity} by a step of one parameter of the housing]")
        assert lines[:at] == [
            "[Loudest mesh harmonics, A-weighted, linear about the mean load: sound power level re 1 pW]",
            "excitation | [Hz] | L_W [dB] | L_WA [dB]",
            "1× mesh | 633.0 | 81.5 | 69.2",
            "2× mesh | 977.0 | 82.5 | 68.2",
        ]
        assert lines[at:-2] == expected(quantity)
        assert lines[-1].endswith("mean mesh forces are kept, and the radiating surface is held")


def test_planets_over_a_turn_of_their_carrier() -> None:
    """K_γ over the turn is the number of planets times the largest share of any of them."""
    planets = [{"name": f"p{n}", "pin_error_m": error} for n, error in enumerate([[0.0, 0.0], [3e-6, -4e-6]])]
    one = {"name": "epicyclic", "mesh_load_factor": 1.0625, "planets": planets, "members": []}
    turn = {"sets": [{"name": "epicyclic", "load_share": [[0.5, 0.375, 0.5], [0.5, 0.625, 0.5]]}]}
    document = {"carrier_turns": [turn], "planetary": [one | {"planets": []}]}
    assert told(operating_point._planetary(document)) == [
        "Mesh load factor K_γ of epicyclic: 1.0625 (1 where all planets carry alike)",
        "Over a turn of the carrier the load shares are 0.3750 to 0.6250, K_γ at most 1.2500",
    ]
    assert told(operating_point._pin_error_note({"planetary": [one]})) == [
        "Deflections are from the places of pins without errors, which they contain: p1 5 µm"
    ]


def test_how_far_lines_and_sidebands_are_followed() -> None:
    meshes = [
        {"name": name, "harmonics": within, "most_harmonics": most, "frequency_hz": hertz}
        for name, within, most, hertz in (("a → b", 3, 5, 812.5), ("c → d", 1, 1, 633.25), ("e → f", 0, 4, 9876.0))
    ]
    carriers = [
        {"name": name, "frequency_hz": hertz, "turns": turns, "outermost_turns": outermost, "outermost_share": share}
        for name, hertz, turns, outermost, share in (("carrier", 12.5, 7, 5.0, 0.0375), ("other", 3.75, 2, 2.0, 9e-5))
    ]
    left_out = "is left out, above 2500 Hz, up to which all modes of the housing are there: raise "
    left_out += "housing.frequency_limit for it."
    forced = "turns, which its bores and frames force; the outermost, at"
    assert told(mesh_lines._limit_sentences({"limit_hz": 2500.0, "meshes": meshes, "carriers": carriers})) == [
        f"Mesh frequency of a → b: 812.5 Hz and its harmonics up to 3×; 4× {left_out}",
        "Mesh frequency of c → d: 633.25 Hz; higher ones are left out.",
        f"Mesh frequency of e → f: 9876 Hz; 1× {left_out}",
        f"Sidebands by carrier, 12.5 Hz, are followed up to k = ±7 {forced} ±5, have 3.75 % of the highest line.",
        f"Sidebands by other, 3.75 Hz, are followed up to k = ±2 {forced} ±2, have less than 0.01 % of the highest "
        "line.",
    ]
    assert mesh_lines._beside_harmonic({"harmonic": 2, "turns": {"carrier": -1.0}}) == "2f_m-1f_c"
    assert mesh_lines._beside_harmonic({"cause": "1× shaft"}) == "1× shaft"


@pytest.mark.parametrize(
    ("aim", "words", "values"),
    [
        ({"kind": "harmonics", "weights": {1: 0.75, 2: 0.25}}, "weighted harmonics of the mesh frequency (0.75 at 1, "
         "0.25 at 2)", ("3.250 µm", "4.500 µm", "1.125 µm")),
        ({"kind": "sensor", "sensor": "top", "given": True}, "level at top by transmission error and load shuttling, "
         "rms over the mesh harmonics", ("3.25e-06 m/s²", "4.5e-06 m/s²", "1.125e-06 m/s²")),
        ({"kind": "sensor", "sensor": "top", "given": False}, "level at top, the loudest sensor, by transmission error "
         "and load shuttling, rms over the mesh harmonics", ("3.25e-06 m/s²", "4.5e-06 m/s²", "1.125e-06 m/s²")),
    ],
)  # fmt: skip
def test_the_best_relief_for_another_aim(aim: Document, words: str, values: tuple[str, str, str]) -> None:
    best = {"torque_n_m": 77.0, "amount_m": 12.5e-6, "length_m": 2.25e-3, "shape": "linear"}
    best |= {"peak_to_peak_without_relief_m": 4.75e-6, "peak_to_peak_as_given_m": 3.5e-6, "peak_to_peak_m": 1.25e-6}
    best |= {"driver_start_roll_angle_rad": 0.4, "driven_start_roll_angle_rad": 0.4}
    best["aim"] = aim | {"as_given": 3.25e-6, "without_relief": 4.5e-6, "best": 1.125e-6}
    pair = {"optimal_tip_relief": best, "gears": [{"tip_relief": None}] * 2}
    pair["transmission_error_m"] = {"over_hunting_period": None}
    lines = gears._best_relief(pair)
    given, without, least = values
    assert lines[0] == "Without relief 3.50 µm peak to peak at 77 N·m"
    assert lines[1] == f"Aim, the {words}: {given} as given, {without} without relief, {least} with the best"
    assert lines[-1] == (
        "Best linear relief: 0.0125 mm on both gears from 22.92° of roll, over 2.25 mm of the line of action: 1.25 µm "
        "peak to peak"
    )
    assert len(lines) == (4 if aim["kind"] == "harmonics" else 3)
    best["length_m"] = None
    relief = {"amount_m": 2.25e-5, "start_roll_angle_rad": 0.4}
    relieved = pair | {"gears": [{"tip_relief": relief}, {"tip_relief": None}]}
    relieved["harris_map"] = {"quietest_torque_n_m": 55.0, "torque_n_m": [11.0, 66.0]}
    assert gears._best_relief(relieved)[:2] == [
        "The relief of 0.0225/0 mm from 22.92° leaves 3.50 µm peak to peak at 77 N·m, none 4.75 µm",
        "  it is quietest near 55 N·m",
    ]
    relieved["harris_map"] = {"quietest_torque_n_m": 11.0, "torque_n_m": [11.0, 66.0]}
    assert "quietest" not in gears._best_relief(relieved)[1]
    assert gears._best_relief(pair)[1:] == [f"No tip relief, the same on both gears, lowers the {words}: leave it out"]


def test_a_planned_survey() -> None:
    sensor = {"point": "p1", "position_m": [0.0125, -0.25, 0.5], "direction": [0.0, 0.0, -1.0], "independence": 0.875}
    hammer = {"position_m": [0.1, 0.2, 0.3], "direction": [0.6, 0.8, 0.0], "least_residue": 0.0375}
    document = {"sensors": [sensor], "candidates": 40, "modes": [1, 2, 3], "modes_hz": [500.0, 700.0, 900.0]}
    document |= {"auto_mac_largest": 0.125, "condition": 3.5, "hammer": [hammer, hammer | {"direction": [0, 1.0, 0]}]}
    excited = "the least excited mode has 3.8 % of its largest driving-point residue"
    assert told(survey.sections(document)[0].content) == [
        "[]",
        "point | x [mm] | y [mm] | z [mm] | direction | independence",
        "p1 | 12.5 | -250.0 | 500.0 | -z | 0.875",
        "1 sensor of 40 places for 3 modes up to 900 Hz: modes look at most 0.125 alike (auto-MAC), condition 3.5.",
        f"Hammer: at (100.0, 200.0, 300.0) mm along 0.600 0.800 0.000: {excited}",
        f"and at (100.0, 200.0, 300.0) mm along y: {excited}",
    ]


def test_highest_damped_responses_of_many_meshes() -> None:
    """The highest peak is at a mode that hardly anything damps, and left out: of the others the highest is told."""

    def peaks(*pairs: tuple[float, float]) -> list[Document]:
        return [{"frequency_hz": hertz, "amplitude": amplitude} for hertz, amplitude in pairs]

    modes: list[Mapping[str, Any]] = [
        {"damped_frequency_hz": 500.0, "damping_ratio": 0.0},
        {"damped_frequency_hz": 900.0, "damping_ratio": 0.05},
    ]
    forces = {"first": peaks((500.0, 9e8), (900.0, 2.5e6)), "second": peaks((905.0, 7.5e6))}
    rows: list[Mapping[str, Any]] = [
        {
            "excitation": "a → b",
            "mesh_force_n": forces,
            "sensor_acceleration_m_per_s2": {"top": peaks((500.0, 1e6)), "side": peaks((910.0, 3e6))},
        },
        {
            "excitation": "c → d",
            "mesh_force_n": {"first": forces["first"]},
            "sensor_acceleration_m_per_s2": {"top": [], "side": peaks((700.0, 4e6), (800.0, 5e6))},
        },
    ]
    assert told(system._peaks_of_all(rows, modes)) == [
        "Highest response to the error of each mesh at any frequency: Hz, and in brackets by 1 µm:",
        "[]",
        "by 1 µm of | mesh force [N/µm] | top [m/s²/µm] | side [m/s²/µm]",
        "a → b | 905 (7.5) at second | undamped | 910 (3)",
        "c → d | 900 (2.5) at first | none | 800 (5)",
    ]


def test_a_single_growing_mode_grows() -> None:
    growing = {"frequency_hz": 812.5, "kind": "rotor", "where": "input", "whirl": 1.0, "damping_ratio": -0.0125}
    fed = [{"name": f"bearing {n}", "share": 0.5 / n} for n in (1, 2, 4, 5)]
    growing |= {"doubling_time_s": 0.125, "fed_by": fed}
    assert told(system._stability({"stable": False, "growing": [growing]})) == [
        "UNSTABLE: 1 mode grows from any disturbance.",
        "  812.50 Hz (rotor: input ↺), damping ratio -0.013, doubling in 0.125 s; fed by bearing 1 (0.5), bearing 2 "
        "(0.25), bearing 4 (0.12)",
    ]
    assert told(system._stability({"stable": False, "growing": [growing | {"fed_by": []}] * 2}))[::2] == [
        "UNSTABLE: 2 modes grow from any disturbance.",
        "  812.50 Hz (rotor: input ↺), damping ratio -0.013, doubling in 0.125 s; fed by nothing single",
    ]


@pytest.mark.parametrize(
    ("mode", "words", "in_only_set"),
    [
        ({"kind": "rigid", "where": "a", "planetary": "planet: c"}, "rigid", "rigid"),
        ({"kind": "rotor", "where": "a", "planetary": "planet: c"}, "planet (planetary set of c)", "planet"),
        ({"kind": "rotor", "where": "a", "whirl": -1.0}, "rotor: a ↻", "rotor: a ↻"),
        ({"kind": "rotor", "where": "a", "whirl": 0.0}, "rotor: a", "rotor: a"),
        ({"kind": "mesh", "where": "a"}, "mesh", "mesh"),
        ({"kind": "housing", "where": "housing"}, "housing", "housing"),
    ],
)
def test_names_of_modes(mode: Document, words: str, in_only_set: str) -> None:
    assert (system._named(mode), system._named_in_only_set(mode)) == (words, in_only_set)


def test_error_left_by_the_basis_and_friction_of_teeth() -> None:
    bands = [
        {"to_hz": hertz, "sensors": [{"largest": share}, {"largest": 0.5 * share}]}
        for hertz, share in ((1000.0, 0.0125), (2500.0, 0.075))
    ]
    assert motion._basis_error({"basis_error": bands}) == [
        "Error left by the modal basis, at the worst sensor and frequency: 1.2 % up to 1000 Hz, 7.5 % up to 2500 Hz."
    ]
    orders: list[Mapping[str, Any]] = [
        {"signal": signal, "highest_amplitude": amplitude}
        for signal, amplitude in (("b", 1.0), ("a", 3.0), ("b", 9.0), ("b", 4.0), ("b", 2.0), ("a", 5.0))
    ]
    highest = [(row["signal"], row["highest_amplitude"]) for row in motion._highest_orders(orders)]
    assert highest == [("b", 9.0), ("b", 4.0), ("b", 2.0), ("a", 5.0), ("a", 3.0)]


def test_a_run_over_speeds_with_its_orders() -> None:
    order = {"signal": "top", "name": "1× mesh", "highest_amplitude": 0.125, "unit": "m/s²", "level_db": 98.25}
    order |= {"order": 28, "at_rpm": 3456.0, "frequency_hz": 1612.0}
    overall = {"signal": "a → b", "highest_rms": 7.5, "unit": "N", "level_db": 137.5, "at_rpm": 2345.0}
    signature = {"orders": [order], "overall": [overall], "from_rpm": 1500.0, "to_rpm": 4500.0}
    signature |= {"trusted_below_hz": 2600.0, "window_turns": 12}
    peak = {"frequency_hz": 812.0, "amplitude_m_per_s2": 0.375}
    document: Document = {"sensors": [{"name": "top", "rms_m_per_s2": 0.75, "peaks": [peak]}]}
    document["run_signature"] = signature
    document |= {"run": {"accelerating_torque_n_m": {"least": 1.5, "largest": 2.25}, "train_inertia_kg_m2": 0.0375}}
    document |= {
        "steps": 640,
        "method": "exact",
        "steps_per_second": 25600.0,
        "energy_error": 1.5e-7,
        "coordinates": 42,
    }
    document["sound_not_solved"] = "no sound"
    lines = told(motion._content(document | {"trusted_below_hz": 2600.0}))
    assert lines[1].startswith("sensor | rms")
    assert lines[2:] == [
        "top | 0.75",
        "Beside the load, 1.5 to 2.25 N·m at the first driver accelerate the train, of 0.0375 kg m² there",
        "[Highest overall levels along the run]",
        "signal | highest [rms] | unit | level [dB] | at [rpm]",
        "a → b | 7.5 | N | 137.5 | 2345",
        "[Highest of the orders along the run]",
        "signal | order | highest [peak] | unit | level [dB] | at [rpm] | that is [Hz]",
        "top | 1× mesh | 0.125 | m/s² | 98.2 | 3456 | 1612",
        "Levels are of rms values, in dB re 1 µm/s² and 1 µN.",
        "Speed from 1500 to 4500 rpm between the first and the last spectrum",
        "Orders of sensors up to 2600 Hz, where the model is complete; those of mesh forces go on beyond it",
        "Orders are fitted to windows of 12 turns of the leading shaft: a resonance passed within one turn is lower "
        "than it was",
        "Transient: 640 exact elements, 25600 a second; energy balance closes to 1.5e-07; 42 modal coordinates",
        "no sound",
    ]
    mean = told(motion._content({key: document[key] for key in ("sensors", "run")}))
    assert mean[1].endswith(" | means over the run: Hz (m/s², peak)")
    assert mean[2] == "top | 0.75 | 812 (0.38)"
    assert mean[3].startswith("Spectrum of the whole run: means over its speeds")
    order["unit"] = "N"
    assert not any(line.startswith("Orders of sensors") for line in told(motion._content(document)))


def test_peaks_that_a_sweep_passes_by() -> None:
    numbers = {"damping_ratio": 0.01, "level_db": 1.0, "found_over_linear_db": 2.0, "half_width_rpm": 6.25}
    first = MissedPeak({"torque": "7 N m"}, 3000.0, 3200.0, 3123.456, line="1× mesh", frequency_hz=812.25,
                       mode="rotor: a", output="top", rise_db=4.25, **numbers)  # fmt: skip
    message = (
        "between 3000 and 3200 rpm, torque=7 N m 1× mesh meets the mode at 812.2 Hz (rotor: a), whose half-power "
        "bandwidth of 12 rpm is narrower than the spacing of the points: by the linear response {} peaks at 3123.5 "
        "rpm, 4.2 dB above the louder point{}; add {}"
    )
    # Speeds to a tenth of the half-width, 0.625 rpm, and those within half of it are one.
    for peaks, words in (
        ([first], ("top", "", "3123.5 rpm")),
        ([replace(first, output="sound"), replace(first, speed_rpm=3125.0), replace(first, speed_rpm=2987.04)],
         ("the sound power", "; 2 more in the table", "2987 rpm, 3123.5 rpm")),
    ):  # fmt: skip
        (warned,) = peak_warnings(peaks)
        assert warned["message"] == message.format(*words)
        assert [f"{speed:g} rpm" for speed in warned["speeds_rpm"]] == words[-1].split(", ")
    assert peak_warnings([]) == []


def test_exported_files_by_their_kinds() -> None:
    heard = {"file": "top.wav", "complete_below_hz": 2600.0, "seconds": 1.5, "periods": 7}
    sensor = {"sensor": "top", "full_scale_m_per_s2": 20.0, "peak_m_per_s2": 12.345, "rms_m_per_s2": 0.0625}
    microphone = {"microphone": "ear", "full_scale_pa": 0.5, "peak_pa": 0.25, "rms_pa": 0.125}
    document = {
        "tables": [{"file": "a.csv", "rows": 12}],
        "universal_files": [{"file": "b.uff", "functions": 34}],
        "sounds": [heard | sensor, heard | {"file": "ear.wav"} | microphone],
    }
    (section,) = export_sections(document)
    assert told(section.content) == [
        "[Tables (CSV)]",
        "file | rows",
        "a.csv | 12",
        "[Universal files, datasets 58]",
        "file | functions",
        "b.uff | 34",
        "[Sounds of sensors and microphones (WAV)]",
        "file | sensor or microphone | unit | full scale | peak | rms | complete below [Hz] | length [s] | periods",
        "top.wav | top | m/s² | 20 | 12.3 | 0.0625 | 2600 | 1.500 | 7",
        "ear.wav | ear | Pa | 0.5 | 0.25 | 0.125 | 2600 | 1.500 | 7",
    ]


def test_lines_whose_sound_is_left_out() -> None:
    lines = [{"name": f"{n}× a -> b", "frequency_hz": 100.0 * n, "share": 0.125 / n} for n in (1, 2, 3, 4, 5)]
    document = {"left_out": lines, "covered": 0.75, "highest_frequency_hz": 2600.0}
    named = "1× a → b at 100 Hz (12.5 %), 2× a → b at 200 Hz (6.25 %), 3× a → b at 300 Hz (4.17 %) and 2 more"
    estimated = f"Left out: 25 % of the power by the estimate, most of it {named}"
    assert sound.left_out_sentence(document) == estimated
    unknown = [lines[0] | {"share": None, "frequency_hz": 3210.0}]
    beyond = "1× a → b at 3210 Hz, where the housing's modes are not complete"
    assert sound.left_out_sentence(document | {"left_out": unknown}) == f"Left out: {beyond}"
    assert sound.left_out_sentence(document | {"left_out": [*lines, *unknown]}) == f"{estimated}; {beyond}"
    assert sound.left_out_sentence(document | {"covered": 1.0}) == ""
    assert sound.left_out_sentence(document | {"covered": 1.0, "highest_frequency_hz": 450.0}) != ""
    proven = {"known_source_error": 0.0225, "known_source_rms": 0.0125}
    proven["microphones"] = [{"known_source_error": value} for value in (0.0375, 0.0625, None)]  # type: ignore[assignment]
    assert sound.known_source_sentence(proven) == (
        "Proof by a known source inside: its pressure on the surface is off by at most 2.25 %, 1.25 % in the root mean "
        "square, 6.25 % at the microphones"
    )


def test_forces_of_a_mesh_on_both_flanks() -> None:
    other = {"mean_force_n": 12.0, "peak_force_n": 34.0, "net_mean_force_n": 544.0, "both_apart_fraction": 0.0125}
    pair = {"driver": "a", "driven": "b", "mean_force_n": 556.0, "peak_force_n": 789.0, "contact_loss_fraction": 0.0375}
    forces = "mean force 556 N, peak 789 N, apart 3.75 % of the time"
    both = "mean 12 N, peak 34 N; both together 544 N, and apart 1.25 % of the time"
    pairs = [pair, pair | {"flanks": "back", "other_flanks": other}, pair | {"flanks": "drive", "other_flanks": other}]
    pairs[0] = pair | {"friction": {"mean_power_w": 7.125}}
    assert told(motion._content({"gear_pairs": pairs})) == [
        f"Gear mesh a → b: {forces}",
        "  friction between its teeth takes 7.12 W",
        f"Gear mesh a → b on its back flanks: {forces}; its drive flanks: {both}",
        f"Gear mesh a → b: {forces}; its back flanks: {both}",
    ]


def test_coupled_modes_of_a_planetary_set() -> None:
    def mode(kind: str, hertz: float, **more: Any) -> Document:
        energy = {"housing": 0.125, "rotor": 0.5, "torsion": 0.25, "residual": 0.0, "mesh": 0.0625, "axial": 0.03}
        one = {"kind": kind, "frequency_hz": hertz, "damping_ratio": 0.0125, "where": "input", "energy": energy}
        return one | {"damped_frequency_hz": hertz} | more

    strained = {"kind": "gear_meshes", "name": "a → b", "share": 0.75}
    turning = {"turning_frequency_hz": 812.5, "turning_damping_ratio": 0.0375}
    modes = [
        mode("rigid", 0.0, planetary="planet: c"),
        mode("rotor", 633.25, planetary="planet: c", strained_most=strained, **turning),
        mode("rotor", 877.5, whirl=1.0),
        mode("residual", 988.0),
        mode("rotor", 5300.0),
    ]
    certificate = {"found": 42, "expected": 44, "zeros": 2, "max_residual": 3e-9, "sum_rule": 5e-7, "complete": True}
    document = {"modes": modes, "trusted_below_hz": 2600.0, "mesh_phase": 0.25, "coordinates": 77, "speed_rpm": 3456.0}
    lines = told(system._content(document | {"certificate": certificate}))
    assert lines[0] == "77 coordinates at 3456 rpm, the first pair's teeth at 0.25 of their period"
    assert lines[2].startswith(
        "frequency [Hz] | damping ratio | kind | turning [Hz] | damping ratio, turning | housing"
    )
    assert lines[2].endswith("housing | rotor | torsion | axial | residual | teeth | strained most")
    assert lines[3].startswith("0.00 | 0.0125 | rigid | ")
    assert lines[4].startswith("633.25 | 0.0125 | planet | 812.50 | 0.0375 | 12 % | 50 % | 25 % | 3 % | 0 % | 6 % | ")
    assert lines[4].endswith("teeth of a → b 75 %")
    assert lines[5].startswith("877.50 | 0.0125 | rotor: input ↺ |  |  | 12 %")
    assert lines[6:10] == [
        "Shares of the kinetic energy; teeth: share of the strain energy. Whirl seen from +z: ↺ counter-clockwise, ↻ "
        "clockwise.",
        "Rotational, translational, planet and mixed modes: those of the planetary set of c; mixed ones are none of "
        "the three, as where planets or the housing differ all round.",
        "Left out: 1 residual mode, local compliance at the seats, no modes of the housing.",
        "42 of 44 eigenvalues found, 2 of them zero; residuals up to 3e-09, sum rule kept to 5e-07.",
    ]
    assert lines[10] == "1 more mode above 5200 Hz."
    few = told(system._content(document | {"modes": modes[2:4]}))
    assert few[2] == "frequency [Hz] | damping ratio | kind | housing | rotor | torsion | axial | residual | teeth"
    assert few[4].startswith("Shares of the kinetic energy")
    assert len(few) == 6  # and the one residual mode


def test_what_a_check_says_of_measured_modes_and_bushings() -> None:
    measured = {"frequencies_hz": [812.5, 977.25], "pairing": "dominance", "points": 12, "extent_m": [0.5, 0.25, 0.125]}
    measured |= {"degrees_of_freedom": 36, "complex": True}
    responses = {"of": "accelerance", "references": 2, "lines": 801, "from_hz": 100.0, "to_hz": 2600.0}
    size = "12 points over 500 x 250 x 125 mm, 36 measured directions"
    assert check._measured_lines(measured) == [
        "812.5, 977.25 Hz; paired with the model's by dominance",
        f"{size}; complex shapes",
    ]
    assert check._measured_lines(measured | {"complex": False})[1] == f"{size}; real shapes"
    del measured["frequencies_hz"]
    assert check._measured_lines(measured | {"responses": responses}) == [
        size,
        "responses in accelerance to 2 forces, 801 lines from 100 to 2600 Hz",
    ]
    bolt = {"name": "m8", "diameter_m": 0.0125, "center_m": [0.1, 0.2, 0.3]}
    bolt |= {"stiffness_n_per_m": {"axial": 2.5e8, "shear": 1.25e8}, "damping_n_m_s_per_rad": {"tilting": 7.5}}
    assert check._bushing_line("cover", bolt) == (
        "cover m8 (circles of 12.5 mm at 100, 200, 300 mm): axial 2.5e+08 N/m, shear 1.25e+08 N/m, tilting 7.5 "
        "N·m·s/rad"
    )


def test_refined_modes_and_those_that_carry_a_receptance() -> None:
    steps = [{"mesh_size_m": size, "largest_error": error} for size, error in ((0.0125, 0.0375), (0.005, 0.0075))]
    assert told(housing._refinement({"refinement": steps})) == [
        "Refined until every mode is within its accuracy; largest estimated error by elements of 12.5 mm 3.8 %, 5 mm "
        "0.75 %"
    ]
    selection = {"from": ["a", "b"], "to": ["top", "side"], "band_hz": [100.0, 2600.0], "ranking": [3, 5, 1, 2]}
    selection |= {"keep": [3, 5], "error_left": [1.0, 0.5, 0.0225, 0.001, 0.0]}
    assert housing._selection(selection) == (
        "From a, b to top, side, 100 to 2600 Hz: 2 of 4 modes carry the receptance to 2.2 % of its largest: 3, 5."
    )


def test_what_excites_and_carries_the_loudest_lines() -> None:
    """Mechanisms less than 10 dB below the strongest are named; the largest part, not the largest in size, leads."""
    parts = {"transmission_error": 61.0, "load_shuttling": 68.0, "friction": 58.0, "unbalance": 57.5}
    contributions = {
        "housing_modes": [{"name": "housing mode 7", "share": -1.5}, {"name": "local compliance", "share": 0.875}],
        "faces": [{"name": "top", "share": 0.625}],
        "bearings": [],
    }
    line = {"frequency_hz": 812.0, "name": "1× a -> b", "sound_power_db": 81.25, "sound_power_db_a": 79.5}
    line |= {"parts_equivalent_power_db": parts, "contributions": contributions}
    assert [column.text(line) for column in sound.LOUDEST_COLUMNS[1:]] == [
        "81.2",
        "79.5",
        "1× a → b",
        "load shuttling, transmission error -7 dB",
        "local, 88 %",
        "",
        "top, 62 %",
    ]
    assert sound._mode_text({"mode_share": None}) == ""
    assert sound._mode_text({"mode_share": 0.375, "mode": None}) == "local, 38 %"
    assert sound._mode_text({"mode_share": 0.375, "mode": 7, "mode_frequency_hz": 633.0}) == "7 at 633 Hz, 38 %"


@pytest.mark.parametrize(("error", "told_of"), [(0.0595, ()), (0.0625, ("6.2 %",))])
def test_sound_over_time_is_doubted_beyond_half_a_decibel(error: float, told_of: tuple[str, ...]) -> None:
    given = SimpleNamespace(of_modes=SimpleNamespace(warnings=()), told=(), histories=SimpleNamespace(error=error))
    given._microphone_doubts = list
    warnings = SolvedSound.warnings(cast(Any, given))
    begins = (
        "sound pressure over time is doubtful: the transfer to the microphones is interpolated over frequency with "
    )
    assert [one["message"] for one in warnings] == [f"{begins}an error of {size}" for size in told_of]
    assert [one["relative"] for one in warnings] == [error] * len(told_of)


@pytest.mark.parametrize(
    ("value", "digits", "told_as"),
    [
        (7.04e5, 2, "700000"),
        (987654.0, 6, "987654"),
        (0.012345, 3, "0.0123"),
        (1234.5, 2, "1200"),
        (9.999e5, 2, "1e+06"),
    ],
)
def test_numbers_below_a_million_have_no_exponent(value: float, digits: int, told_as: str) -> None:
    assert plain(value, digits) == told_as
