"""Three hundred damaged files, small gear units with seeded mutations: two hundred are refused by name."""

import random
import re
import resource
import time
import tracemalloc
from collections import Counter
from collections.abc import Callable

import pytest
from rexs_files import helical_stage, planetary_stage

from gearwhine.case import CaseError, parse_case
from gearwhine.case.load import imported_case
from gearwhine.exchange.rexs import RexsError, case_of, read_content

SOURCES = {
    "helical.rexs": helical_stage().xml(),
    "helical.rexsj": helical_stage().json(),
    "helical.rexsz": helical_stage().zip(),
    "planetary.rexs": planetary_stage().xml(),
    "planetary.rexsj": planetary_stage().json(coded=True),
}
STRANGE = (
    *("0", "-1", "1e308", "-1e308", "1e-308", "nan", "inf", "1e9", "", " ", "NaN", "0x10", "１２", "true", "∞", "1,5"),
    *("9" * 400, "a" * 5000, "\U0001f600", "-0.0", "null", "[]", "ground", "../../etc/passwd", "%s", "{0}"),
)


def _flipped(content: bytes, draw: random.Random) -> bytes:
    changed = bytearray(content)
    for _ in range(draw.randint(1, 20)):
        changed[draw.randrange(len(changed))] = draw.randrange(256)
    return bytes(changed)


def _cut(content: bytes, draw: random.Random) -> bytes:
    start, end = sorted(draw.randrange(len(content)) for _ in range(2))
    return content[:start] + content[end:]


def _doubled(content: bytes, draw: random.Random) -> bytes:
    start, end = sorted(draw.randrange(len(content)) for _ in range(2))
    return content[:end] + content[start:]


def _lines_lost(content: bytes, draw: random.Random) -> bytes:
    lines = re.split(rb"(?<=\n)|(?<=\}), ", content)
    for _ in range(draw.randint(1, 4)):
        del lines[draw.randrange(len(lines))]
    return b"".join(lines)


def _number_changed(content: bytes, draw: random.Random) -> bytes:
    """A number, or several, become others that are strange."""
    places = list(re.finditer(rb"(?<=[>\" \[])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?=[<\",\]}])", content))
    for match in sorted(draw.sample(places, min(len(places), draw.randint(1, 4))), key=lambda one: -one.start()):
        content = content[: match.start()] + draw.choice(STRANGE).encode() + content[match.end() :]
    return content


def _word_changed(content: bytes, draw: random.Random) -> bytes:
    """A name of a type, attribute, unit or role becomes another one of the file."""
    places = list(re.finditer(rb"(?<=\")[A-Za-z_][A-Za-z_0-9 /]*(?=\")", content))
    for match in sorted(draw.sample(places, draw.randint(1, 3)), key=lambda one: -one.start()):
        content = content[: match.start()] + draw.choice(places)[0] + content[match.end() :]
    return content


def _reference_changed(content: bytes, draw: random.Random) -> bytes:
    """Numbers of components become others: parts join what does not fit."""
    places = list(re.finditer(rb"(?<=id=\")\d+|(?<=\"id\": )\d+", content))
    for match in sorted(draw.sample(places, draw.randint(1, 6)), key=lambda one: -one.start()):
        content = content[: match.start()] + str(draw.randrange(70)).encode() + content[match.end() :]
    return content


MUTATIONS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    *(_flipped, _cut, _doubled, _lines_lost),
    *(_number_changed, _number_changed, _word_changed, _word_changed, _reference_changed, _reference_changed),
)


def _restructured(draw: random.Random) -> bytes:
    """A sound file of a unit that makes less sense: attributes and relations lost, exchanged or given other values."""
    file = draw.choice((helical_stage, planetary_stage))()
    for _ in range(draw.randint(1, 5)):
        one, other = draw.choice(file.components), draw.choice(file.components)
        names = sorted(one["attributes"])
        match draw.randrange(8):
            case 0 if names:
                del one["attributes"][draw.choice(names)]
            case 1 if names:
                name = draw.choice(names)
                one["attributes"][name] = (draw.choice(STRANGE), one["attributes"][name][1])
            case 2 if names:
                name = draw.choice(names)
                value, unit = one["attributes"][name]
                if isinstance(value, float):
                    one["attributes"][name] = (value * draw.choice((-1.0, 0.0, 1e-6, 0.3, 3.0, 1e3, 1e12)), unit)
            case 3 if names:
                name = draw.choice(names)
                one["attributes"][name] = (
                    one["attributes"][name][0],
                    draw.choice(("mm", "N m", "deg", "", "mum", "kW")),
                )
            case 4:
                one["type"] = other["type"]
            case 5:
                one["attributes"] |= other["attributes"]
            case 6:
                relation, twin = draw.choice(file.relations), draw.choice(file.relations)
                relation["roles"] = [
                    (role, number) for (role, _), (_, number) in zip(relation["roles"], twin["roles"], strict=False)
                ]
            case _:
                file.relations.remove(draw.choice(file.relations))
    return file.xml()


def damaged(seed: int) -> tuple[str, bytes]:
    """Return name and content of a damaged file."""
    draw = random.Random(seed)
    if seed % 2:
        return "restructured.rexs", _restructured(draw)
    name = draw.choice(sorted(SOURCES))
    content = SOURCES[name]
    mutations = (_flipped, _cut, _doubled) if name.endswith("z") else MUTATIONS
    try:
        return name, draw.choice(mutations)(content, draw)
    except ValueError:
        return name, content[: draw.randrange(len(content))]


def outcome(seed: int) -> str:
    """Read a damaged file as `gearwhine check` does; what it says names where and what is expected."""
    name, content = damaged(seed)
    try:
        made = imported_case(name, content)
    except CaseError as error:
        for problem in error.problems:
            assert problem.source == name
            assert problem.key
            assert len(str(problem)) < 600
        return "refused"
    try:
        parse_case(made.document)
    except CaseError:
        return "case refused"
    return "read"


def test_two_hundred_damaged_files_are_refused_by_name_and_others_read() -> None:
    """Each within ten seconds, all within the memory of one process that has a gigabyte more."""
    outcomes = Counter[str]()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for seed in range(310):
        started = time.process_time()
        outcomes[outcome(seed)] += 1
        assert time.process_time() - started < 10.0, seed
    assert outcomes["refused"] >= 200
    assert outcomes["read"] > 50
    assert outcomes["case refused"] > 0
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1e6  # kilobytes


def test_a_file_that_was_cut_is_refused_by_a_sentence() -> None:
    content = SOURCES["helical.rexs"]
    with pytest.raises(RexsError, match="line"):
        case_of(read_content(content[: len(content) // 3]))


def test_a_large_file_takes_memory_in_proportion() -> None:
    """Ten times as many components take ten times as much, and not a copy for each relation."""

    def peak(times: int) -> int:
        file = helical_stage()
        for _ in range(200 * times):
            file.add("sn_curve", "curve", minimum=(1.0, "none"))
        content = file.xml()
        tracemalloc.start()
        read_content(content)
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return most

    small, large = peak(1), peak(10)
    assert large < 14 * small
