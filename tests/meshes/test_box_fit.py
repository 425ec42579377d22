"""Ribs, cover, fillets and patches that do not fit a box are named with their place, all at once."""

import pytest

from gearwhine.meshes import (
    Bore,
    Boss,
    BoxGeometry,
    Cover,
    CoverBolts,
    Feet,
    Fillets,
    Flange,
    GeometryError,
    Rib,
    WallThickness,
)
from gearwhine.meshes.box.geometry import BoxMisfitError

BOLTS = CoverBolts(0.006, (3, 3), patch_diameter=0.0095)
TOP = Cover("top", bolts=BOLTS)
FLANGED = Cover("top", Flange(0.02, 0.015, "inside"), CoverBolts(0.006, (3, 3)))
RIB = Rib("left", "y", 0.0, 0.02, 0.008)

MISFITS = {
    "rib off its wall": ({"ribs": (Rib("left", "x", 0.0, 0.02, 0.008),)}, "ribs[0].along", "'y' or 'z'"),
    "no height": ({"ribs": (RIB, Rib("left", "y", 0.0, 0.0, 0.008))}, "ribs[1].height", "a length above 0"),
    "rib beyond the wall": ({"ribs": (Rib("left", "y", 0.118, 0.02, 0.008),)}, "ribs[0].at", "-116 mm to 116 mm"),
    "rib end": ({"ribs": (Rib("left", "y", 0.0, 0.02, 0.008, end=0.17),)}, "ribs[0].end", "y = 0 mm to 160 mm"),
    "backwards": (
        {"ribs": (Rib("left", "y", 0.0, 0.02, 0.008, start=0.1, end=0.05),)},
        "ribs[0].end",
        "beyond the start at 100 mm",
    ),
    "too high inside": ({"ribs": (Rib("left", "y", 0.0, 0.2, 0.008, "inside"),)}, "ribs[0].height", "180 mm inside"),
    "rib in a bore": ({"ribs": (Rib("front", "y", 0.0, 0.02, 0.008),)}, "bores[0].center", "ribs[0] on the front"),
    "rib before a bore": (
        {"ribs": (RIB, Rib("bottom", "z", 0.0, 0.06, 0.008, "inside"))},
        "bores[0].center",
        "ribs[1] on the bottom wall stands in it",
    ),
    "rib in a foot": ({"ribs": (Rib("bottom", "x", -0.11, 0.01, 0.008),)}, "ribs[0]", "clear of the feet"),
    "rib over the joint": (
        {"ribs": (Rib("left", "y", 0.0, 0.02, 0.008, end=0.16),), "cover": TOP},
        "ribs[0].end",
        "0 mm to 150",
    ),
    "ribs of both parts": (
        {
            "ribs": (Rib("top", "z", 0.0, 0.05, 0.01, "inside"), Rib("left", "y", 0.0, 0.18, 0.008, "inside")),
            "cover": TOP,
        },
        "ribs[0]",
        "clear of the body's, ribs[1]",
    ),
    "feet below the cover": ({"cover": Cover("bottom", bolts=BOLTS)}, "cover.face", "under which the feet stand"),
    "loose cover": ({"cover": Cover("top")}, "cover", "bolts, such as"),
    "bolts twice": (
        {"cover": Cover("top", bolts=CoverBolts(0.006, (3, 3), ((0.0, 0.1),)))},
        "cover.bolts",
        "exactly one",
    ),
    "one bolt a side": (
        {"cover": Cover("top", bolts=CoverBolts(0.006, (1, 3)))},
        "cover.bolts.per_edge[0]",
        "from 2 to",
    ),
    "patch below bolt": (
        {"cover": Cover("top", bolts=CoverBolts(0.006, (3, 3), patch_diameter=0.006))},
        "cover.bolts.patch_diameter",
        "wider than the bolts, 6 mm",
    ),
    "patch on a thin rim": (
        {"cover": Cover("top", bolts=CoverBolts(0.006, (3, 3)))},
        "cover.bolts.patch_diameter",
        "circles of 12 mm within the rim of the top cover, which is 10 mm wide",
    ),
    "bolt in the opening": (
        {"cover": Cover("top", bolts=CoverBolts(0.006, positions=((0.0, 0.115), (0.0, 0.1)), patch_diameter=0.009))},
        "cover.bolts.positions[1]",
        "within the rim",
    ),
    "bolts on each other": (
        {"cover": Cover("top", bolts=CoverBolts(0.006, (30, 3), patch_diameter=0.0095))},
        "cover.bolts.per_edge",
        "bolt-2 and bolt-1 are 6.55172 mm apart",
    ),
    "no grip": (
        {"cover": Cover("top", bolts=CoverBolts(0.006, (3, 3), (), 0.0095, 0.0))},
        "cover.bolts.grip",
        "above 0",
    ),
    "flange that fills": (
        {"cover": Cover("top", Flange(0.09, 0.01, "inside"), BOLTS)},
        "cover.flange.width",
        "below 90 mm",
    ),
    "flange too deep": (
        {"cover": Cover("top", Flange(0.01, 0.2, "inside"), BOLTS)},
        "cover.flange.thickness",
        "below the 140 mm under the cover",
    ),
    "flange below the feet": (
        {"cover": Cover("front", Flange(0.03, 0.01), CoverBolts(0.006, (2, 2)))},
        "cover.flange.width",
        "below 20 mm",
    ),
    "flange in a bore": (
        {"cover": FLANGED, "bores": (Bore("b", (0.0, 0.115, 0.12), 0.05),)},
        "bores[0].center",
        "clear of the cover's flange",
    ),
    "boss over the joint": (
        {"cover": FLANGED, "bores": (Bore("b", (0.0, 0.12, 0.12), 0.01, Boss(0.07, 0.01)),)},
        "bores[0].center",
        "a boss clear of the joint under the top cover, at y = 150 mm",
    ),
    "bolt in a bore": (
        {
            "cover": Cover("front", bolts=CoverBolts(0.006, (2, 5), patch_diameter=0.009)),
            "bores": (Bore("b", (-0.083, 0.09, 0.12), 0.03),),
        },
        "bores[0].center",
        "clear of the cover's bolt-9",
    ),
    "bore in a fillet": (
        {"fillets": Fillets(inside=0.02), "bores": (Bore("b", (0.0, 0.04, 0.12), 0.05),)},
        "bores[0].center",
        "rounded by 20 mm",
    ),
    "fillet of half the box": ({"fillets": Fillets(inside=0.07)}, "fillets.inside", "less than half the cavity, 70 mm"),
    "negative fillet": ({"fillets": Fillets(outside=-0.001)}, "fillets.outside", "from 0 to less than half the box"),
    "fillet through the corner": ({"fillets": Fillets(outside=0.033)}, "fillets.outside", "a quarter of the wall"),
    "patch beyond the foot": ({"feet": Feet((0.04, 0.02, 0.03), 0.03)}, "feet.bolt_patch", "of the feet, 30 mm"),
    "foot under a fillet": (
        {"feet": Feet((0.01, 0.02, 0.03)), "fillets": Fillets(0.02, 0.012)},
        "feet.size",
        "larger than the rounding",
    ),
}


def _box(**changes: object) -> BoxGeometry:
    parts: dict[str, object] = {"bores": (Bore("a", (0.0, 0.07, 0.12), 0.05),), "feet": Feet((0.04, 0.02, 0.04))}
    return BoxGeometry(size=(0.2, 0.16, 0.24), wall=WallThickness.uniform(0.01), **(parts | changes))  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", MISFITS)
def test_a_part_that_does_not_fit_is_named(kind: str) -> None:
    changes, place, expected = MISFITS[kind]
    with pytest.raises(BoxMisfitError) as caught:
        _box(**changes)
    named = [str(misfit) for misfit in caught.value.misfits]
    assert any(line.startswith(f"box: {place}: expected ") and expected in line for line in named), named


def test_all_misfits_come_at_once() -> None:
    with pytest.raises(BoxMisfitError) as caught:
        _box(ribs=(Rib("left", "x", 0.0, 0.02, 0.008), Rib("left", "y", 0.5, 0.02, 0.008)), fillets=Fillets(-1.0, -2.0))
    assert [misfit.location for misfit in caught.value.misfits] == [
        ("fillets", "inside"),
        ("fillets", "outside"),
        ("ribs", 0, "along"),
        ("ribs", 1, "at"),
    ]


def test_concentric_roundings_of_any_radius_leave_the_wall_its_thickness() -> None:
    """Outside and inside about one centre: what is left at the edge is the wall itself."""
    assert _box(feet=None, fillets=Fillets(inside=0.04, outside=0.05), bores=()).fillets.outside == 0.05


def test_a_seat_cannot_take_the_name_of_a_patch() -> None:
    with pytest.raises(GeometryError, match="of a face or foot of the box"):
        _box(bores=(Bore("bolt-2-body", (0.0, 0.07, 0.12), 0.05),), cover=TOP)
    assert _box(bores=(Bore("bolt-9-body", (0.0, 0.07, 0.12), 0.05),), cover=TOP).bolts[-1].name == "bolt-8"
