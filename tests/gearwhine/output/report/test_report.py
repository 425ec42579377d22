"""The report: every section of a run's summary, pictures inside, text escaped, and nothing where there is nothing."""

import base64
import json
import re
import tomllib
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from gearwhine.case import Case, CaseError, dump_case, load_case
from gearwhine.case.input_files import file_contents
from gearwhine.output.report import Contents, report_page
from gearwhine.output.report.freshness import mismatches
from gearwhine.output.report.interactive import _coarse_curves, _coarse_table
from gearwhine.output.report.pictures import Shown, figure
from gearwhine.output.sections import Column, Picture, Section, columns_of, table_of
from gearwhine.results import chapters_of, comparison, gears, housing, motion, rotors, run, system, update
from gearwhine.results import steady_state as steady
from gearwhine.results.bearing_lives import life_in_words
from gearwhine.results.first_page import _sound_proofs, first_page, machine_section
from gearwhine.results.summaries import Summary

VOID = {"meta", "img"}
PIXEL = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mNk+A8AAQUBAScY42YAAAAASUVORK5CYII=")
RUN = {
    "command": "run",
    "title": "Gears & <b>bold</b> claims",
    "housing": {
        "modes": [{"number": 1, "frequency_hz": 657.891, "damping_ratio": 0.01, "strength": 0.123}],
        "certificate": {"found": 1, "limit_hz": 3200.0, "expected": 1, "complete": True, "max_residual": 2e-12},
        "mesh": {"elements": 10, "dofs": 300},
        "mass_kg": 12.5,
    },
    "compare": {
        "pairs": [{"measured_hz": 658.0, "model_hz": 684.0, "error_percent": 3.951, "mode": 1}],
        "pairing": "dominance",
        "pairing_rule": "dominance in order of frequency",
        "rms_error_percent": 3.951,
        "max_error_percent": 3.951,
        "gap": 0.12,
        "measures_agree": False,
    },
    "steps": 1000,
    "speed_rpm": 5500.0,
    "coordinates": 50,
    "energy_error": 1e-6,
    "sensors": [{"name": "<script>alert(1)</script>", "peaks": [{"frequency_hz": 2566.7, "amplitude_m_per_s2": 1.5}]}],
    "gear_pairs": [
        {"driver": "a", "driven": "b", "mean_force_n": 1718.0, "peak_force_n": 1745.0, "contact_loss_fraction": 0.25}
    ],
}


class Balanced(HTMLParser):
    """Fails on a tag that is closed by another; collects texts, tags and where pictures come from."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: set[str] = set()
        self.text = ""
        self.sources: list[str] = []
        self.links: list[str] = []
        self.identifiers: list[str] = []
        self.captions: dict[str, str] = {}

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        given = {name: value or "" for name, value in attrs}
        self.sources += [given["src"]] if "src" in given else []
        self.links += [given["href"]] if "href" in given else []
        self.identifiers += [given["id"]] if "id" in given else []
        if tag == "img":
            self.captions[given["src"]] = given["alt"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not {"nav", "style"} & set(self.open):
            self.text += f"{data}\n"


def read(folder: Path) -> Balanced:
    parser = Balanced()
    parser.feed(report_page(folder, Contents(chapters_of, first_page)))
    parser.close()
    assert parser.open == []
    assert len(set(parser.identifiers)) == len(parser.identifiers)
    # Every link leads to a place in the page.
    assert {link.removeprefix("#") for link in parser.links} <= set(parser.identifiers)
    return parser


def read_case(folder: Path, case: Case) -> Balanced:
    parser = Balanced()
    parser.feed(report_page(folder, Contents(chapters_of, first_page), case))
    return parser


def test_a_run_is_told_whole_and_escaped(tmp_path: Path) -> None:
    (tmp_path / "summary.json").write_text(json.dumps(RUN), encoding="utf-8")
    (tmp_path / "case.toml").write_text('title = "</pre><script>"', encoding="utf-8")
    for name in ("spectrum.png", "modes.png", "own.png"):
        (tmp_path / name).write_bytes(PIXEL)
    page = read(tmp_path)
    assert "script" not in page.tags
    for told in (
        "Gears & <b>bold</b> claims",
        "657.89",
        "+3.95",
        "1718",
        "25.00",
        "<script>alert(1)</script>",
        "2566.7",
    ):
        assert told in page.text
    # Nothing is fetched from anywhere; the spectrum stands on the first page, too.
    assert len(page.sources) == 4
    assert all(source.startswith("data:image/png;base64,") for source in page.sources)
    assert base64.b64decode(page.sources[0].partition(",")[2]) == PIXEL
    assert "measures do not agree" in page.text
    assert "Further pictures" in page.text
    assert page.text.count("Acceleration of each sensor over frequency") == 2
    assert "File own.png." in page.text


TRACED = {
    "frequency_hz": 2566.7,
    "amplitude_m_per_s2": 1.5,
    "name": "1× <a> -> b",
    "kind": "mesh",
    "level_db": 120.0,
    "near_mode": None,
    "contributions": {
        "housing_modes": [
            {"name": "housing mode 17 (2613 Hz)", "amplitude_m_per_s2": 4.0, "share": -1.7, "number": 17},
            {"name": "housing mode 19 (2664 Hz)", "amplitude_m_per_s2": 3.0, "share": 1.5, "number": 19},
        ],
        "bearings": [
            {"name": "back", "amplitude_m_per_s2": 2.5, "share": -0.4},
            {"name": "front", "amplitude_m_per_s2": 2.0, "share": 1.4},
        ],
        "free_vibration": {"name": "free vibration", "amplitude_m_per_s2": 0.0, "share": 0.0},
    },
}


def linked(folder: Path, text: str) -> str:
    """Return the identifier that the text of a link leads to; empty where the text is no link."""
    page = report_page(folder, Contents(chapters_of, first_page)).replace("\N{NO-BREAK SPACE}", " ")
    found = re.search(f'<a href="#([^"]+)">{re.escape(text)}</a>', page)
    return "" if found is None else found[1]


def test_a_line_leads_to_its_path_and_to_the_housing_that_moves_at_it(tmp_path: Path) -> None:
    document = RUN | {"sensors": [{"name": "top", "peaks": [TRACED]}]}
    write(tmp_path, document, 'title = "x"')
    assert linked(tmp_path, "2566.7") == "run-path-top-2566-7-hz"
    assert linked(tmp_path, "housing mode 19 (2664 Hz)") == ""
    (tmp_path / "mode-19-2664Hz.png").write_bytes(PIXEL)
    assert linked(tmp_path, "housing mode 19 (2664 Hz)") == "run-picture-mode-19-2664hz"
    (tmp_path / "line-2566.7Hz.png").write_bytes(PIXEL)
    assert linked(tmp_path, "housing mode 19 (2664 Hz)") == "run-picture-line-2566-7hz"
    page = read(tmp_path)
    assert "front 140 %, against it back -40 %" in page.text.replace("\N{NO-BREAK SPACE}", " ")
    near = {"number": 21, "frequency_hz": 2560.4, "kind": "rotor", "where": "output"}
    write(tmp_path, document | {"sensors": [{"name": "top", "peaks": [TRACED | {"near_mode": near}]}]}, 'title = "x"')
    assert (
        "Highest is 2566.7 Hz at top, 1.5 m/s² peak: 1× <a> → b, near a mode of the coupled machine "
        "(2560 Hz, rotor: output); largest part by housing mode 19 (2664 Hz)." in read(tmp_path).text
    )
    assert "Operating shape at 2566.7 Hz, 1× <a> → b; grey: at rest, colour: displacement." in page.text


def test_pictures_of_another_command_are_found_from_a_line(tmp_path: Path) -> None:
    document = RUN | {"sensors": [{"name": "top", "peaks": [TRACED]}]}
    write(tmp_path, document, 'title = "x"')
    shape = {"frequency_hz": 2566.7, "name": "1×", "modes": [], "largest_displacement_m": 5e-8}
    write(tmp_path / "render", {"command": "render", "lines": [shape]}, 'title = "x"')
    (tmp_path / "render" / "line-2566.7Hz.png").write_bytes(PIXEL)
    assert linked(tmp_path, "housing mode 19 (2664 Hz)") == "render-picture-line-2566-7hz"


def test_a_link_leads_to_the_own_results_first(tmp_path: Path) -> None:
    write(tmp_path, {"made_at": "2026-01-01T10:00:00+00:00"} | RUN, 'title = "x"')
    newer = {"command": "modes", "made_at": "2026-02-01T10:00:00+00:00"} | RUN["housing"]  # type: ignore[operator]
    write(tmp_path / "modes", newer, 'title = "x"')
    for place in (tmp_path, tmp_path / "modes"):
        (place / "mode-01-658Hz.png").write_bytes(PIXEL)
    page = report_page(tmp_path, Contents(chapters_of, first_page))
    run = page[page.index('<h2 id="run-') :]
    modes = page[page.index('<h2 id="modes-') : page.index('<h2 id="run-')]
    assert set(re.findall(r'<a href="#([\w-]+)">1</a>', run)) == {"run-picture-mode-01-658hz"}
    assert set(re.findall(r'<a href="#([\w-]+)">1</a>', modes)) == {"modes-picture-mode-01-658hz"}


def test_a_sheet_of_modes_is_left_out_where_each_has_a_picture(tmp_path: Path) -> None:
    write(tmp_path, {"command": "modes"} | RUN["housing"], 'title = "x"')  # type: ignore[operator]
    (tmp_path / "modes.png").write_bytes(PIXEL)
    assert "Modes side by side" in read(tmp_path).text
    (tmp_path / "mode-01-658Hz.png").write_bytes(PIXEL)
    page = read(tmp_path)
    (caption,) = set(page.captions.values())
    assert caption.startswith("Mode 1, 658 Hz, damping ratio 0.01;")


def test_pictures_are_packed_and_look_the_same(tmp_path: Path) -> None:
    y, x = np.mgrid[0:300, 0:400]
    flat = np.where(((x // 8 + y // 8) % 2)[..., None], [31, 90, 150], [255, 255, 255]).astype(np.uint8)
    shaded = np.stack([255 * x // 399, 255 * y // 299, (x + y) // 3], axis=-1).astype(np.uint8)
    write(tmp_path, {"command": "run"}, 'title = "x"')
    for name, pixels in (("flat", flat), ("shaded", shaded)):
        Image.fromarray(np.dstack([pixels, np.full(x.shape, 255, np.uint8)])).save(tmp_path / f"{name}.png")
    kinds = {}
    for source, caption in read(tmp_path).captions.items():
        kinds[caption], data = source.split(";base64,")
        content = base64.b64decode(data)
        name = caption.removeprefix("File ").removesuffix(".png.")
        assert len(content) < (tmp_path / f"{name}.png").stat().st_size
        seen = np.asarray(Image.open(BytesIO(content)).convert("RGB")).astype(int)
        assert np.abs(seen - {"flat": flat, "shaded": shaded}[name]).mean() < 2.0
    assert kinds == {"File flat.png.": "data:image/png", "File shaded.png.": "data:image/webp"}


def test_a_picture_that_stands_twice_is_packed_once_and_shown_twice(tmp_path: Path, monkeypatch: Any) -> None:
    noise = np.random.default_rng(4).integers(0, 255, (40, 50, 3), dtype=np.uint8)
    packed: list[Image.Image] = []
    quantize = Image.Image.quantize

    def counted(image: Image.Image, *more: Any, **ways: Any) -> Image.Image:
        packed.append(image)
        return quantize(image, *more, **ways)

    monkeypatch.setattr(Image.Image, "quantize", counted)
    shown = []
    for name in ("load-face.png", "system-face.png"):
        Image.fromarray(noise).save(tmp_path / name)
        shown.append(figure(Shown(tmp_path / name, "Load over the face."), name))
    sources = [re.search('src="([^"]+)"', one) for one in shown]
    assert len(packed) == 1
    assert sources[0] is not None
    assert sources[1] is not None
    assert sources[0].group(1) == sources[1].group(1)


def test_a_file_that_is_no_picture_is_told(tmp_path: Path) -> None:
    write(tmp_path, {"command": "run"}, 'title = "x"')
    (tmp_path / "spoilt.png").write_bytes(PIXEL[:40])
    page = read(tmp_path)
    assert page.sources == []
    assert "File spoilt.png. The file cannot be read." in page.text


def test_the_first_page_tells_the_machine(tmp_path: Path) -> None:
    case = load_case("spur-pair", []).case
    write(tmp_path, {"command": "run"}, dump_case(case))
    text = read_case(tmp_path, case).text
    driver, driven = (next(gear for gear in case.gear if gear.name == name) for name in pair_of(case))
    assert f"{driver.teeth} : {driven.teeth}" in text
    (frequency,) = case.parts.mesh_frequencies
    assert f"{frequency:.2f}" in text


def test_the_first_page_tells_the_hardest_loaded_parts(tmp_path: Path) -> None:
    """Of the newest operating point: the pair with the largest face load factor, the bearing with the shortest life."""
    pair = {"driver": "pinion", "driven": "wheel", "misalignment_over_face_m": -2.4e-6}
    bearings = [{"name": "stiff", "life_h": None}, {"name": "a", "life_h": 9.1e5}, {"name": "b", "life_h": 138_367.0}]
    pairs = [pair | {"k_h_beta": 1.1}, pair | {"k_h_beta": 1.584, "driver": "second"}]
    load = {"residual": 1e-12, "gear_pairs": pairs, "bearings": bearings}
    (sentence,) = [text for text in machine_section(load_case("spur-pair", []).case, [{"load": load}]).content
                   if isinstance(text, str) and text.startswith("Under load")]  # fmt: skip
    assert sentence == (
        "Under load: K_Hβ 1.58 of second → wheel, whose flanks stand 2.4 µm out of line over the face; "
        "shortest bearing life L10 138 000 h, of b."
    )


@pytest.mark.parametrize(("speed", "torque", "power"), [(1, 1, "41.34"), (-1, 1, "41.34"), (1, -1, "-41.34")])
def test_a_machine_that_turns_the_other_way_drives_with_the_same_power(speed: int, torque: int, power: str) -> None:
    """71.77 N·m in the sense of rotation at 5500 rpm are 71.77 · 5500 π/30 = 41.34 kW; a torque against it brakes."""
    changes = [f"operation.speed={speed * 5500} rpm", f"operation.torque={torque * 71.77} N*m"]
    case = load_case("spur-pair", changes).case
    (sentence,) = [text for text in machine_section(case).content if isinstance(text, str) and "rpm" in text]
    assert sentence.endswith(f"; {power} kW.")
    assert f"{speed * torque * 71.77:+.4g} N·m on input" in sentence


@pytest.mark.parametrize(("hours", "said"), [(None, ""), (9.1234e5, "912000"), (2e44, "> 1e6"), (40.0, "40")])
def test_a_life_of_a_bearing_without_load_is_no_number(hours: float | None, said: str) -> None:
    assert life_in_words(hours) == said


def pair_of(case: Case) -> tuple[str, str]:
    return case.gear_pair[0].driver, case.gear_pair[0].driven


def marks(folder: Path) -> dict[str, str]:
    """Return the marks of the first page's findings by their sentences."""
    page = report_page(folder, Contents(chapters_of, first_page))
    return {text: kind for kind, text in re.findall(r'<p class="finding (\w+)">.*?</span> <span>(.*?)<', page)}


def test_the_first_page_marks_each_proof(tmp_path: Path) -> None:
    certificate = RUN["housing"]["certificate"]  # type: ignore[index]
    grows = {"frequency_hz": 90.0, "damping_ratio": -0.01, "kind": "torsion", "doubling_time_s": 0.1, "fed_by": []}
    stability = {"stable": False, "growing": [grows]}
    system = {"stability": stability, "modes": [], "coordinates": 1, "speed_rpm": 1.0}
    missing = RUN["housing"] | {"certificate": certificate | {"complete": False, "found": 0}}  # type: ignore[operator]
    warned = {"name": "runout", "message": "teeth run out by 3 µm"}
    document = RUN | {"system": system, "warnings": [warned]}
    write(tmp_path, document, 'title = "x"')
    found = marks(tmp_path)
    assert found["Stability: 1 mode grows. "] == "failed"
    assert found["Motion: the energy balance closes to 1e-06 over 1000 steps (bound: 1 %). "] == "passed"
    assert found["Teeth run out by 3 µm. "] == "warned"
    assert "checks passed, 1 did not; 1 warning." in read(tmp_path).text
    assert next(kind for text, kind in found.items() if text.startswith("Housing: 1 modes found")) == "passed"
    write(tmp_path, document | {"housing": missing, "energy_error": 0.0101}, 'title = "x"')
    found = marks(tmp_path)
    assert next(kind for text, kind in found.items() if text.startswith("Housing: 0 modes found")) == "failed"
    assert next(kind for text, kind in found.items() if text.startswith("Motion: the energy")) == "failed"
    for residual, passed in ((9e-7, True), (1.1e-6, False)):
        load = {"residual": residual, "gear_pairs": [], "bearings": []}
        assert first_page(None, [{"command": "load", "load": load}], [])[0].content[1].passed is passed  # type: ignore[union-attr]


def test_results_of_another_case_fail_on_the_first_page(tmp_path: Path) -> None:
    write(tmp_path, {"command": "run", "made_at": "2026-01-01T10:00:00+00:00"}, CASE.format(speed=1, load=2))
    write(
        tmp_path / "gears", {"command": "gears", "made_at": "2026-02-01T10:00:00+00:00"}, CASE.format(speed=2, load=2)
    )
    (told,) = [text for text, kind in marks(tmp_path).items() if kind == "failed" and text.startswith("gearwhine run")]
    assert "operation.speed was 1, is 2" in told


@pytest.mark.parametrize(
    ("command", "change", "differs"),
    [
        ("gears", "[acoustics]\nlines = 3", False),
        ("gears", "[sweep]\nspeed = 3", False),
        ("gears", "[operation]\ntorque = 3", True),
        ("modes", "[[gear]]\nname = 'a'\nteeth = 3", False),
        ("modes", "[housing]\nmodes = 3", True),
        ("compare", "[measured]\nfrequencies = [3]", True),
        ("rotors", "[measured]\nfrequencies = [3]", False),
        ("sound", "[acoustics]\nlines = 3", True),
        ("run", "[acoustics]\nlines = 3", False),
        ("run", "[acoustics]\nin_run = true", True),
        ("load", "[acoustics]\nlines = 3", False),
        ("run", "notes = 'other words'", False),
        ("run", "[unheard_of]\nkey = 3", True),
    ],
)
def test_a_result_is_held_against_the_keys_that_its_command_reads(
    tmp_path: Path, command: str, change: str, *, differs: bool
) -> None:
    write(tmp_path, {"command": command}, "[material]\na = 1\n")
    present = tomllib.loads(f"{change}\n[material]\na = 1\n")
    assert bool(mismatches(tmp_path, {"command": command}, present)) is differs


@pytest.mark.parametrize(
    ("change", "differs"), [("lines = 3", False), ("in_run = true", True), ("method = 'erp'", True)]
)
def test_a_run_without_sound_is_not_held_against_the_keys_of_sound(
    tmp_path: Path, change: str, *, differs: bool
) -> None:
    write(tmp_path, {"command": "run"}, "[acoustics]\n")
    present = tomllib.loads(f"[acoustics]\n{change}\n")
    assert bool(mismatches(tmp_path, {"command": "run"}, present)) is differs
    assert mismatches(tmp_path, {"command": "load", "loudest_lines": []}, present)


@pytest.mark.parametrize(("error", "passed"), [(0.2, True), (0.36, None), (1.2, False)])
def test_a_known_source_a_third_off_is_no_tick(error: float, passed: bool | None) -> None:
    sound = {"known_source_error": error, "known_source_rms": 0.05}
    (finding,) = _sound_proofs(Summary({"sound": sound}))
    assert "(bound: 25.9 %, 2 dB)" in finding.text
    assert finding.passed is passed


def test_inner_sections_choose_their_pictures_first(tmp_path: Path) -> None:
    write(tmp_path, {"command": "run"}, 'title = "x"')
    for name in ("gear-a", "gear-b"):
        (tmp_path / f"{name}.png").write_bytes(PIXEL)
    inner = Section("Second", pictures=(Picture("gear-b", "Of the second."),))
    outer = Section("All", pictures=(Picture("gear-", "Of the others."),), inner=(inner,))
    page = report_page(tmp_path, Contents(lambda document: (outer,)))
    assert page.index("Of the others.</figcaption>") < page.index("<h4>Second</h4>") < page.index("Of the second.</fig")
    assert page.count("<figure ") == 2


def test_sections_follow_what_the_document_holds() -> None:
    assert [section.title for section in chapters_of(RUN)] == ["Housing modes", "Measured and modelled", "Motion"]
    assert chapters_of({"title": "nothing"}) == ()
    modes = {"command": "modes"} | RUN["housing"]  # type: ignore[operator]
    assert [section.title for section in chapters_of(modes)] == ["Housing modes"]
    assert chapters_of(RUN["housing"]) == ()  # type: ignore[arg-type]


def test_results_that_stand_twice_are_folded_the_second_time(tmp_path: Path) -> None:
    """A run's housing modes give way to those of the newer `modes`; of another solution both stand open."""

    def open_chapters(newer: dict[str, object]) -> dict[str, bool]:
        write(tmp_path, {"made_at": "2026-01-01T10:00:00+00:00"} | RUN, 'title = "x"')
        write(tmp_path / "modes", {"command": "modes", "made_at": "2026-02-01T10:00:00+00:00"} | newer, 'title = "x"')
        page = report_page(tmp_path, Contents(chapters_of, first_page))
        found = re.findall(r'<details( open)? class="level3" id="([\w-]+)"><summary><h3>(.*?)</h3>', page)
        assert all(
            ("the same as under gearwhine modes" in heading) is not bool(unfolded) for unfolded, _, heading in found
        )
        return {name: bool(unfolded) for unfolded, name, _ in found if name.endswith("housing-modes")}

    same: dict[str, object] = RUN["housing"]  # type: ignore[assignment]
    assert open_chapters(same | {"detail": 1}) == {
        "run-section-housing-modes": False,
        "modes-section-housing-modes": True,
    }
    assert open_chapters(same | {"mass_kg": 13.0}) == {
        "run-section-housing-modes": True,
        "modes-section-housing-modes": True,
    }


def test_what_a_fit_is_worth_is_told_beside_it() -> None:
    worth = {
        "sets": 20,
        "within_5_percent": 0.8,
        "within_2_percent": 0.15,
        "within_1_percent": 0.0,
        "all_met": 0.05,
        "as_good_in_rms": 0.3,
        "measured_likewise": {"rms_error_percent": 3.2, "max_error_percent": 6.1},
    }
    held = {"measured_hz": 658.0, "predicted_hz": 700.0, "error_percent": 6.383, "standard_deviation_percent": 2.0}
    document = {
        "command": "update",
        "parameters": [{"name": "top wall", "before": 0.012, "after": 0.013, "standard_deviation": 0.0016}],
        "before": {"rms_error_percent": 13.6, "max_error_percent": 24.0},
        "identifiability": {"learned_combinations": 8, "parameters": 18},
    }
    (alone,) = chapters_of(document)
    assert any("Not known" in sentence for sentence in alone.sentences)
    (tested,) = chapters_of(document | {"null": worth, "held_back": [held]})
    assert any(
        "80 % within 5 %" in sentence and "for 5 % all that is asked" in sentence for sentence in tested.sentences
    )
    assert any(
        "3.20 % root mean square, 6.10 % at most; 30 % of the random sets" in sentence for sentence in tested.sentences
    )
    assert tested.tables[1].filled()[1] == [["658.0", "700.0", "+6.38", "2.00"]]


def test_an_unstable_machine_is_not_called_stable() -> None:
    mode = {"frequency_hz": 90.0, "damping_ratio": -0.01, "kind": "torsion", "doubling_time_s": 0.1, "fed_by": []}
    growing = {"stable": False, "growing": [mode]}
    whole = {"modes": [], "coordinates": 3, "speed_rpm": 1000.0, "stability": growing}
    (section,) = chapters_of({"system": whole})
    assert any(sentence.startswith("UNSTABLE: 1 mode") for sentence in section.sentences)
    assert not any("Stable" in sentence for sentence in section.sentences)


def test_columns_without_values_are_left_out() -> None:
    (table,) = chapters_of(RUN)[1].tables
    columns, rows = table.filled()
    assert "MAC" not in [column.heading for column in columns]
    assert rows == [["658.0", "684.0", "+3.95", "1"]]


def write(place: Path, document: dict[str, object], case: str) -> None:
    place.mkdir(exist_ok=True)
    (place / "summary.json").write_text(json.dumps(document), encoding="utf-8")
    (place / "case.toml").write_text(case, encoding="utf-8")


CASE = 'title = "two"\n[operation]\nspeed = {speed}\n[[bearing]]\nname = "left"\nload = {load}\n'


def test_all_results_of_a_folder_are_shown_the_newest_first(tmp_path: Path) -> None:
    write(tmp_path, {"command": "run", "made_at": "2026-01-01T10:00:00+00:00"}, CASE.format(speed=1, load=2))
    write(
        tmp_path / "system", {"command": "system", "made_at": "2026-02-01T10:00:00+00:00"}, CASE.format(speed=1, load=2)
    )
    (tmp_path / "holiday").mkdir()
    (tmp_path / "holiday" / "summary.json").write_text(json.dumps(RUN), encoding="utf-8")
    text = read(tmp_path).text
    assert text.index("gearwhine system") < text.index("on 2026-02-01 at 10:00:00 UTC") < text.index("gearwhine run")
    assert "Does not fit" not in text
    assert "Gears &" not in text


def test_results_of_another_case_are_marked_with_what_differs(tmp_path: Path) -> None:
    write(tmp_path, {"command": "run", "made_at": "2026-01-01T10:00:00+00:00"}, CASE.format(speed=1, load=2))
    write(
        tmp_path / "gears", {"command": "gears", "made_at": "2026-02-01T10:00:00+00:00"}, CASE.format(speed=1, load=3)
    )
    page = read(tmp_path)
    (doubt,) = [line for line in page.text.splitlines() if "Does not fit the case any more" in line]
    assert "bearing.left.load was 2, is 3" in doubt
    assert page.text.index("gearwhine run") < page.text.index(doubt)


def test_results_of_a_file_that_has_changed_are_marked(tmp_path: Path) -> None:
    measured = tmp_path / "measured.csv"
    measured.write_text("1", encoding="utf-8")
    kept = {"command": "compare", "input_files": file_contents([measured])}
    write(tmp_path / "out", kept, CASE.format(speed=1, load=2))
    assert "Does not fit" not in read(tmp_path / "out").text
    measured.write_text("2", encoding="utf-8")
    assert f"{measured} has changed" in read(tmp_path / "out").text
    measured.unlink()
    assert f"{measured} cannot be read" in read(tmp_path / "out").text


@pytest.mark.parametrize("content", [None, "{", "[1]"])
def test_a_folder_without_results_is_refused(tmp_path: Path, content: str | None) -> None:
    if content is not None:
        (tmp_path / "summary.json").write_text(content, encoding="utf-8")
    with pytest.raises(CaseError, match="a results folder with"):
        report_page(tmp_path, Contents(chapters_of))


# Documents in which no two figures are alike, and each table's cells as they must read.
CELLS = {
    "MODES": (
        {"number": 3, "frequency_hz": 657.891, "damping_ratio": 0.0123, "strength": 0.4567},
        "mode: 3; frequency [Hz]: 657.89; damping ratio: 0.0123; strength [1/kg]: 0.4567",
    ),
    "PAIRS": (
        {
            "measured_hz": 658.0,
            "model_hz": 684.04,
            "error_percent": 3.951,
            "mode": 2,
            "mac": 0.912,
            "confidence": 0.87,
            "strength": 1.5,
        },
        "measured [Hz]: 658.0; model [Hz]: 684.0; error [%]: +3.95; mode: 2; MAC: 0.912; confidence: 0.87; "
        "strength [1/kg]: 1.5",
    ),
    "GEARS": (
        {
            "driver": "a",
            "driven": "b",
            "contact_ratio": 1.63804,
            "mesh_frequency_hz": 2566.67,
            "stiffness_n_per_m": {"mean": 2.512e8},
            "transmission_error_m": {"mean": 7.684e-6, "peak_to_peak": 3.0042e-6},
        },
        "driver: a; driven: b; contact ratio: 1.6380; mesh frequency [Hz]: 2566.67; "
        "mean stiffness [N/µm]: 251.2; mean transmission error [µm]: 7.68; peak to peak [µm]: 3.004",
    ),
    "MESHES": (
        {
            "driver": "a",
            "driven": "b",
            "mean_force_n": 1718.2,
            "peak_force_n": 2745.4,
            "contact_loss_fraction": 0.0333,
            "friction": {"mean_power_w": 44.41},
            "rms_compression_m": 5.552e-6,
        },
        "driver: a; driven: b; mean force [N]: 1718; largest force [N]: 2745; apart [%]: 3.33; "
        "friction takes [W]: 44.4; a.c. compression [µm rms]: 5.55",
    ),
    "ORDERS": (
        {
            "signal": "top",
            "name": "1× a -> b",
            "highest_amplitude": 12.34,
            "unit": "m/s²",
            "at_rpm": 2345.0,
            "frequency_hz": 1094.4,
        },
        "signal: top; order: 1× a -> b; highest [peak]: 12.3; unit: m/s²; at [rpm]: 2345; that is [Hz]: 1094",
    ),
    "LINES": (
        {
            "sensor": "top",
            "frequency_hz": 2566.67,
            "amplitude_m_per_s2": 1.505,
            "level_db": 95.54,
            "uncertainty": 0.0345,
            "name": "1× a -> b",
            "by": "housing mode 7",
        },
        "sensor: top; line [Hz]: 2566.7; amplitude [m/s², peak]: 1.5; level [dB re 1e-6 m/s²]: 95.5; "
        "± by the modal basis [%]: 3.5; what it is: 1× a -> b; mostly by: housing mode 7",
    ),
    "SYSTEM": (
        {
            "frequency_hz": 812.345,
            "damping_ratio": 0.0234,
            "kind": "rotor",
            "where": "input",
            "energy": {"housing": 0.1, "rotor": 0.5, "torsion": 0.2, "axial": 0.05, "pedestal": 0.0, "residual": 0.15}
            | {"mesh": 0.3},
            "strained_most": {"kind": "components", "name": "input", "share": 0.6},
            "whirl": -0.8,
        },
        "frequency [Hz]: 812.35; damping ratio: 0.0234; kind: rotor: input ↻; housing: 10 %; rotor: 50 %; "
        "torsion: 20 %; axial: 5 %; residual: 15 %; teeth: 30 %; strained most: input 60 %",
    ),
    "ROTORS": (
        {
            "name": "input",
            "mass_kg": 1.2345,
            "lateral_hz": [100.04, 200.0],
            "torsional_hz": [0.0, 900.06],
            "axial_hz": [300.0],
            "critical_speeds_rpm": [6001.4],
        },
        "rotor: input; mass [kg]: 1.234; bending at rest [Hz]: 100.0, 200.0; torsion [Hz]: 0.0, 900.1; "
        "along the axis [Hz]: 300.0; critical speeds [rpm]: 6001",
    ),
    "BEARINGS": (
        {
            "name": "left",
            "mean_force_n": [1.04, -2.0, 3.0],
            "rms_force_n": [4.004, 5.0, 6.0],
            "mean_moment_n_m": [7.0, 8.0],
        },
        "bearing: left; mean force x, y, z [N]: 1.0, -2.0, 3.0; "
        "a.c. force x, y, z [N rms]: 4.00, 5.00, 6.00; mean moment x, y [N·m]: 7.00, 8.00",
    ),
    "PARAMETERS": (
        {"name": "wall", "before": 0.012, "after": 0.013, "standard_deviation": 0.0016},
        "parameter: wall; before (SI): 0.012; after (SI): 0.013; ± (SI): 0.0016",
    ),
    "HELD_BACK": (
        {
            "measured_hz": 658.0,
            "predicted_hz": 700.04,
            "error_percent": 6.383,
            "standard_deviation_percent": 2.0,
            "before_error_percent": -9.5,
            "rms_error_percent_of_the_others": 0.75,
        },
        "held back [Hz]: 658.0; predicted [Hz]: 700.0; error [%]: +6.38; expected ± [%]: 2.00; "
        "error before [%]: -9.50; rms of the others [%]: 0.75",
    ),
    "EVENTS": (
        {"speed_rpm": 5100.04, "kind": "fold"},
        "speed [rpm]: 5100.0; what happens: fold",
    ),
}


TABLES: dict[str, tuple[Column, ...]] = {
    "MODES": columns_of(housing.MODE),
    "PAIRS": columns_of(comparison.PAIR),
    "PARAMETERS": columns_of(update.PARAMETER),
    "HELD_BACK": columns_of(update.HELD_BACK),
    "ROTORS": columns_of(rotors.ROTOR),
    "EVENTS": columns_of(steady.EVENT),
    "GEARS": gears.OVERVIEW,
    "MESHES": (*run.MESH_COLUMNS, *columns_of(steady.PAIR)[-1:]),
    "LINES": motion.LINE_COLUMNS,
    "BEARINGS": columns_of(run.BEARING),
    "ORDERS": columns_of(run.ORDER),
    "SYSTEM": (),  # depends on the modes
}


@pytest.mark.parametrize("table", CELLS)
def test_every_cell_shows_its_own_quantity_in_its_unit(table: str) -> None:
    row, told = CELLS[table]
    expected = dict(cell.split(": ", 1) for cell in told.split("; "))
    columns_for = TABLES[table] if table != "SYSTEM" else system.mode_columns([row])
    (one,) = table_of(columns_for, [row])
    shown, ((*texts,),) = one.filled()
    assert {column.heading: text for column, text in zip(shown, texts, strict=True)} == expected
    assert [column.heading for column in shown] == list(expected)


def test_every_table_is_held_against_its_cells() -> None:
    assert set(CELLS) == set(TABLES)


def test_warnings_stand_before_the_results(tmp_path: Path) -> None:
    document = RUN | {"warnings": [{"name": "runout", "message": "teeth run out by 3 µm"}]}
    write(tmp_path, document, CASE.format(speed=1, load=2))
    text = read(tmp_path).text
    assert text.index("Warnings\n") < text.index("teeth run out by 3 µm") < text.rindex("Housing modes")


def test_modes_that_miss_their_proof_are_not_called_complete(tmp_path: Path) -> None:
    for complete, words in ((True, ", complete:"), (False, ", NOT complete:")):
        certificate = {"found": 6, "limit_hz": 3200.0, "expected": 7, "complete": complete, "max_residual": 2e-12}
        (section,) = chapters_of({"housing": {"certificate": certificate}})
        assert words in section.sentences[0]
        assert "6 modes below 3200 Hz" in section.sentences[0]
        assert "demands 7" in section.sentences[0]


def test_keys_that_came_or_went_are_told_too(tmp_path: Path) -> None:
    write(tmp_path, {"command": "run", "made_at": "2026-02-01T10:00:00+00:00"}, 'title = "two"\nnew = 4\n')
    old = 'title = "two"\nold = 3\n[gone]\na = 1\nb = 2\n'
    write(tmp_path / "gears", {"command": "gears", "made_at": "2026-01-01T10:00:00+00:00"}, old)
    (doubt,) = [line for line in read(tmp_path).text.splitlines() if "Does not fit the case any more" in line]
    assert "old was 3, is absent" in doubt
    assert "new was absent, is 4" in doubt
    assert "[gone] is absent" in doubt
    assert "gone.a" not in doubt


def test_what_the_interactive_form_has_no_room_for_keeps_its_peaks_at_their_places() -> None:
    """Of 40,000 samples and of a table of 3,000 columns and 900 rows, a peak is less than a step of them before it."""
    x, y = 0.25 * np.arange(40_000.0), 3.0 * np.arange(900.0)
    curves = np.full((2, x.size), 1e-3)
    curves[1, 31_237] = 5.0
    abscissae, coarse = _coarse_curves(x, curves)
    step = abscissae[1] - abscissae[0]
    assert abscissae.size < x.size
    assert coarse[0].max() == 1e-3
    assert 0.0 <= x[31_237] - abscissae[coarse[1].argmax()] < step
    table = np.zeros((y.size, 3_000))
    table[617, 2_111] = 7.0
    columns, rows, cells = _coarse_table(x[:3_000], y, table)
    row, column = np.unravel_index(cells.argmax(), cells.shape)
    assert cells.shape == (rows.size, columns.size) < table.shape
    assert 0.0 <= x[2_111] - columns[column] < columns[1] - columns[0]
    assert 0.0 <= y[617] - rows[row] < rows[1] - rows[0]
    assert cells[row, column] == 7.0
