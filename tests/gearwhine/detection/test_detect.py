"""Detection studies of a case: bad input is refused by its key, and the command finds, writes and resumes a study."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.case.load import bundled_case
from gearwhine.cli import run_command
from gearwhine.coupling.analyses.gear_condition import INDICATORS
from gearwhine.detection.samples import detection_design
from gearwhine.variation.quantities import Wanted
from gearwhine.variation.samples import VariedCase

CRACK = 'gear.pinion.fault={ kind = "crack", tooth = 3, depth = "1 mm" }'
SHORT = [
    *("transient.revolutions=12", "transient.discard=6", "transient.tolerance=5e-3"),
    *("housing.frequency_limit=2.8 kHz", "housing.box.mesh_size=60 mm"),
]
STUDY = """
[detection]
fault        = "gear.pinion.fault.depth"
severities   = ["1 mm", "2 mm"]
healthy      = 40
faulty       = 12
sensor_noise = "0.02 m/s^2"
"""


def _case(tmp_path: Path, study: str = STUDY) -> Path:
    bundled = bundled_case("small-gearbox")
    assert bundled is not None
    path = tmp_path / "case.toml"
    path.write_text(bundled.read_text() + study)
    return path


@pytest.mark.parametrize(
    ("study", "changes", "key", "said"),
    [
        (STUDY, ["gear.pinion.fault="], "detection.fault", "a fault that the case has"),
        (STUDY, ["detection.fault=gear.pinion.fault.1.depth"], "detection.fault", "a fault that the case has"),
        (STUDY, ["detection.fault=rotor.input.nothing"], "detection.fault", "a key of the case"),
        (STUDY, ["detection.fault=gear.*.fault.depth"], "detection.fault", "one fault"),
        (STUDY, ['detection.severities=["1 mm", "9 mm"]'], "detection.severities[1]", "it goes through the foot"),
        (STUDY, ['detection.severities=["2 mm", "1 mm"]'], "detection.severities[1]", "ascending"),
        (STUDY, ['detection.severities=["1 s", "2 s"]'], "detection.severities[0]", "a size that the case takes"),
        (STUDY, ['detection.sensors=["top", "botom"]'], "detection.sensors[1]", "one of top, right wall"),
        (STUDY, ['detection.indicators=["fm5"]'], "detection.indicators[0]", "did you mean"),
        (STUDY, ["detection.gear=pinon"], "detection.gear", "did you mean 'pinion'"),
        (STUDY, ["detection.healthy=9"], "detection.healthy", "from 10"),
        (STUDY, ["detection.threshold=order"], "detection.healthy", "99 or more"),
        (STUDY, ["detection.sensor_noise=0 m/s^2"], "detection.sensor_noise", "without scatter"),
        (STUDY, ['detection.between=["operation.torque"]'], "detection.between[0]", "a key of [variation.vary]"),
        (STUDY, ["transient.revolutions=10"], "transient.revolutions", "10.5 or more"),
        (STUDY, ["transient="], "transient", "'detect' needs [transient]"),
        (STUDY, ["housing.sensor=[]"], "housing.sensor", "listens to"),
        ("", [], "detection", "'detect' needs [detection]"),
    ],
)
def test_bad_input_is_refused_by_its_key(
    tmp_path: Path, study: str, changes: list[str], key: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    of_case = [CRACK, "transient.revolutions=12", "transient.discard=6", *changes]
    settings = [word for text in of_case for word in ("--set", text)]
    path = _case(tmp_path, study)
    assert run_command(["detect", str(path), "-o", str(tmp_path / "out"), "-q", *settings]) == 2
    error = capsys.readouterr().err
    assert f"{key}:" in error
    assert said in error
    assert not (tmp_path / "out" / "detection-samples").exists()
    if study:
        # What is wrong with the study is told before anything is solved.
        assert run_command(["check", str(path), *settings]) == 2


def test_a_key_that_is_no_tooth_fault_grows_from_its_value() -> None:
    study = gw.load(
        "small-gearbox",
        {
            "detection": {
                "fault": "rotor.input.unbalance.0.moment",
                "severities": ["4e-5 kg*m", "8e-5 kg*m"],
                "sensor_noise": "0.1 m/s^2",
            },
            "transient.revolutions": 12,
            "transient.discard": 6,
        },
    )
    from gearwhine.analyses.detection_result import plan_detection

    planned = plan_detection(study._source)
    assert planned.without == ""
    assert planned.gear == "pinion"
    assert planned.monitor.sensors == ("top", "right wall")
    with pytest.raises(CaseError, match=r"detection\.fault"):
        gw.load("small-gearbox", {"detection": {"fault": "a..b", "severities": [1, 2], "sensor_noise": 1.0}})


def test_the_bearing_of_a_planet_that_is_written_once_has_the_fault() -> None:
    """Its tone is that of all planets; no gear of the set has an average, which the indicators of time do not take."""
    from gearwhine.analyses.detection_result import plan_detection

    balls = {"count": 11, "element_diameter": "6 mm", "pitch_diameter": "28 mm", "clearance": "-2 um"}
    spall = {"on": "outer", "length": "1 mm", "depth": "0.1 mm", "row": 0, "planet": 2}
    study = gw.load(
        "planetary-stage",
        {
            "bearing.pin back.stiffness": {"rolling": {**balls, "law": "nonlinear"}},
            "bearing.pin back.damping": "",
            "bearing.pin back.fault": spall,
            "detection": {
                "fault": "bearing.pin back.fault.length",
                "severities": ["0.5 mm", "1 mm"],
                "sensor_noise": "0.1 m/s^2",
            },
        },
    )
    planned = plan_detection(study._source)
    assert planned.spall is not None
    assert (planned.spall[0], planned.spall[1].on, planned.spall[1].length) == ("pin back 1", "outer", 1e-3)
    assert planned.without == "bearing.'pin back'.fault="
    assert all(INDICATORS[name].of_time for name in planned.monitor.indicators)
    healthy = planned.source.changed_case([planned.without])
    assert [len(one.fault) for one in healthy.bearing if one.rotor.startswith("planet")] == [0] * 6


SLIPPING = {
    "bearing.input-back.stiffness": {
        "rolling": {"element": "ball", "count": 11, "element_diameter": "7 mm", "pitch_diameter": "41 mm"}
        | {"clearance": "5 um", "law": "nonlinear"}
    },
    "bearing.input-back.fault": {"on": "outer", "length": "1 mm", "depth": "0.1 mm", "azimuth": "-60 deg"},
    "transient.revolutions": 12,
    "transient.discard": 6,
}


def test_every_record_has_a_course_of_the_cage_of_its_own() -> None:
    """Slip alone scatters the records, healthy ones too; the seed that is written is that of the reference."""
    from gearwhine.analyses.detection_result import plan_detection

    detection = {"fault": "bearing.input-back.fault.length", "severities": ["0.5 mm", "1 mm"]}
    for scatter, seed in ((0.0, 7), (0.02, 7), (0.02, 2**31 - 1)):
        slip = {"mean": 0.01, "scatter": scatter, "seed": seed}
        changes = SLIPPING | {"bearing.input-back.slip": slip, "detection": detection}
        source = gw.load("small-gearbox", changes)._source
        if scatter == 0.0:
            with pytest.raises(CaseError, match="without scatter"):
                plan_detection(source)
            continue
        planned = plan_detection(source)
        assert planned.is_varied
        assert [one for _, one in planned.slips] == [seed]
        study = planned.study(VariedCase(planned.source, planned.inputs, Wanted(("motion",))))
        points = detection_design(np.empty((14, 0)), planned.settings.sizes, 10, 2, ()).points
        slips = {number: study.case(point).bearing for number, point in enumerate(points)}
        found = [next(one.slip.build() for one in held if one.slip is not None) for held in slips.values()]
        assert found[0].seed == seed
        assert all((one.mean, one.scatter) == (0.01, scatter) for one in found)
        # Angles of the cage after some passes, as different as independent walks: none is another's.
        walks = np.array([one.deviations("input-back", 0)[1:200] for one in found])
        steps = np.corrcoef(np.diff(walks, axis=1)) - np.eye(len(points))
        assert np.abs(steps).max() < 0.35


@pytest.mark.slow
def test_the_command_finds_writes_and_resumes_a_study(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = _case(tmp_path), tmp_path / "out"
    settings = [word for text in (CRACK, *SHORT) for word in ("--set", text)]
    command = ["detect", str(path), "-o", str(out), "-q", "--workers", "1", *settings]
    assert run_command(command) == 0
    assert "a90 (a90/95) [mm]" in capsys.readouterr().out
    document = json.loads((out / "summary.json").read_text())
    names = {"detect.nc", "detection-matrix.png", "detection-probability.png", "detection-responses-1.png"}
    assert set(document["files"]) >= names
    # The gearbox without the fault twice, as the reference and as a healthy one, and one for each size.
    assert (document["samples"], document["resumed"], document["failed"]) == (4, 0, [])
    with xr.open_dataset(out / "detect.nc") as data:
        of_size = data["faulty"].sel(sensor="top", indicator="difference_rms_m_per_s2")
        grown = float(of_size[data["fault_size"].values == 1e-3].mean())
    assert run_command([*command, "--set", "detection.sensor_noise=2 m/s^2", "--json"]) == 0
    noisy = json.loads(capsys.readouterr().out)
    assert noisy["resumed"] == 4
    assert len(noisy["detectability"]) == 2 * 14

    # The records are those of `simulate` with and without the fault, in noise that is small beside them.
    study = gw.load(path, [CRACK, *SHORT], folder=out)
    run = study.simulate()
    single = run.document["condition"]["gears"][0]["sensors"][0]["indicators"]["difference_rms_m_per_s2"]
    sound = study.changed(["gear.pinion.fault="]).simulate(study.settings.transient)
    assert "condition" not in sound.document
    found = sound.solved.indicators(["difference_rms"]).gears[0].sensors[0].values["difference_rms"]
    assert found is not None
    rows = {(one["sensor"], one["indicator"]): one for one in document["detectability"]}
    noise = 0.02 / np.sqrt(100.0)
    assert rows["top", "difference_rms"]["healthy_mean"] == pytest.approx(1.0, abs=0.2)
    assert grown == pytest.approx(np.hypot(single, noise) / np.hypot(found, noise), rel=0.1)
    assert single > found

    assert run_command(["report", str(out)]) == 0
    page = (out / "report.html").read_text()
    assert "Detectability of a fault" in page


@pytest.mark.slow
def test_a_spalled_bearing_is_heard_at_its_tone(tmp_path: Path) -> None:
    """The study takes the envelope at the tone of the damaged part, and has the value that `simulate` shows there.

    The cage turns at ½ (1 - 7/41) of 5500 rpm, and 11 balls pass a point of the outer raceway: 418.1 Hz.
    """
    rolling = (
        'element = "ball", count = 11, element_diameter = "7 mm", pitch_diameter = "41 mm", clearance = "5 um", '
        'law = "nonlinear"'
    )
    changes = [
        f"bearing.input-back.stiffness={{ rolling = {{ {rolling} }} }}",
        'bearing.input-back.fault={ on = "outer", length = "1 mm", depth = "0.1 mm", azimuth = "-60 deg" }',
        *SHORT,
        "detection.fault=bearing.input-back.fault.length",
        'detection.severities=["0.2 mm", "1 mm"]',
        "detection.baseline=fleet",
    ]
    study = gw.load(_case(tmp_path), changes, folder=tmp_path / "out")
    found = study.detect(folder=tmp_path / "out", workers=1)
    assert set(found.dataset["indicator"].values.tolist()) == {"spectral_kurtosis", "envelope"}
    run = study.simulate()
    tones = {one["tone"]: one for one in run.document["condition"]["tones"]}
    assert tones["input-back: outer raceway"]["frequency_hz"] == pytest.approx(5500.0 / 60.0 * 5.5 * (1.0 - 7.0 / 41.0))
    for sensor in ("top", "right wall"):
        heard = found.dataset["faulty"].sel(sensor=sensor, indicator="envelope")
        heard = float(heard[found.dataset["fault_size"].values == 1e-3].mean())
        assert heard == pytest.approx(tones["input-back: outer raceway"]["envelope"][sensor], rel=0.02)
        assert heard > 3.0 * tones["input-back: inner raceway"]["envelope"][sensor]
    tones = run.document["sensors"][0]["peaks"]
    assert any("outer raceway of input-back" in line["name"] for line in tones if "name" in line), tones
