"""Writes the tables and the figure of docs/gear-stiffness.md: every stiffness model on the gears of NASA's rig.

Usage: python scripts/gear_stiffness_page.py
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from gearwhine.coupling.gears import (
    Gear,
    GearPairGeometry,
    StiffnessModel,
    mesh_stiffness,
    stiffness_model,
    tooth_contact,
)
from gearwhine.coupling.gears.loaded.transmission_error import mesh_period_phases
from gearwhine.coupling.gears.stiffness.compliant_teeth import CompliantTeeth
from gearwhine.coupling.gears.stiffness.iso6336 import iso6336_stiffness

PAGE = Path(__file__).parent.parent / "docs" / "gear-stiffness.md"
FIGURE = PAGE.parent / "images" / "gear-stiffness.png"
BEGIN, END = "<!-- tables -->", "<!-- end of tables -->"
TORQUE = 71.77
"""Of the rig [N m]."""
RIG = Gear("rig", 28, 3.175e-3, math.radians(20.0), 6.35e-3, root_radius=1.35e-3, bore=40e-3)
PAIR = GearPairGeometry(RIG, RIG)


def models() -> dict[str, StiffnessModel]:
    """Every model that sees the teeth, at the rig's load, with variants that tell them apart."""
    force = TORQUE / RIG.base_radius
    return {
        "iso6336": stiffness_model("iso6336"),
        "potential-energy": stiffness_model("potential-energy"),
        "potential-energy, contact by Weber": stiffness_model("potential-energy", contact="weber", force=force),
        "elastic-ring": stiffness_model("elastic-ring", force=force),
        "elastic-ring, plane strain": stiffness_model("elastic-ring", force=force, state="plane-strain"),
        "cornell": stiffness_model("cornell", force=force),
        "cornell, plane strain": stiffness_model("cornell", force=force, state="plane-strain"),
        "weber-banaschek": stiffness_model("weber-banaschek", force=force),
    }


def tables() -> str:
    """Both tables, in Markdown."""
    eps = PAIR.contact_ratio
    positions = np.array([0.0, eps - 1.0, 0.5 * eps, 1.0, eps])
    radii = PAIR.driver_radius(positions)
    heads = ("start of contact", "begins alone", "pitch point", "ends alone", "tip")
    columns = " | ".join(f"{head}, r {1e3 * radius:.2f} mm" for head, radius in zip(heads, radii, strict=True))
    lines = ["Compliance of one tooth and its body, pm/N, and of the pair's contact at the pitch point:", ""]
    lines.append(f"| model | {columns} | contact |")
    lines.append("|---|" + "---:|" * (len(heads) + 1))
    for name, model in models().items():
        if isinstance(model, CompliantTeeth):
            tooth = 1e12 * model.tooth(RIG, radii).total
            contact = 1e12 * float(model.contact_compliance(PAIR, positions[2]))
            lines.append(f"| {name} | " + " | ".join(f"{value:.0f}" for value in tooth) + f" | {contact:.0f} |")
    norm = iso6336_stiffness(PAIR).mesh_mean * PAIR.face_width
    lines += ["", "Stiffness of the mesh, MN/m, over a mesh period:", ""]
    lines += ["| model | one pair at the pitch point | least | greatest | mean | mean against the norm |"]
    lines += ["|---|---:|---:|---:|---:|---:|"]
    for name, model in models().items():
        contact = tooth_contact(PAIR, model)
        stiffness = mesh_stiffness(contact, mesh_period_phases(contact))
        mean, single = contact.unloaded_mean_mesh_stiffness, float(contact.stiffness(0.5 * eps))
        values = " | ".join(f"{1e-6 * value:.1f}" for value in (single, stiffness.min(), stiffness.max(), mean))
        lines.append(f"| {name} | {values} | {100.0 * (mean / norm - 1.0):+.1f} % |")
    return "\n".join(lines)


def page(text: str) -> str:
    """The page with fresh tables."""
    head, rest = text.split(BEGIN)
    return f"{head}{BEGIN}\n\n{tables()}\n\n{END}{rest.split(END)[1]}"


def draw(path: Path) -> None:
    """Compliance along the profile and mesh stiffness over two periods."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11.0, 4.2), layout="constrained")
    radii = np.linspace(float(PAIR.driver_radius(0.0)), RIG.tip_radius, 80)
    for name, model in models().items():
        style = "--" if "," in name else "-"
        if isinstance(model, CompliantTeeth):
            left.plot(1e3 * radii, 1e9 * model.tooth(RIG, radii).total, style, label=name)
        contact = tooth_contact(PAIR, model)
        phases = mesh_period_phases(contact)
        curve = np.tile(mesh_stiffness(contact, phases), 2)
        right.plot(np.concatenate([phases, phases + 1.0]), 1e-6 * curve, style, label=name, color="black")
        if isinstance(model, CompliantTeeth):
            right.lines[-1].set_color(left.lines[-1].get_color())
    left.set(xlabel="radius of the loaded point, mm", ylabel="compliance of tooth and body, nm/N")
    right.set(xlabel="mesh periods", ylabel="mesh stiffness, MN/m")
    handles, names = right.get_legend_handles_labels()
    left.legend(handles, names, fontsize=7, loc="upper left")
    figure.savefig(path, dpi=110)
    pyplot.close(figure)


def main() -> None:
    """Write the page and its figure."""
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    draw(FIGURE)
    print(f"written: {PAGE.name}, {FIGURE.name}")


if __name__ == "__main__":
    main()
