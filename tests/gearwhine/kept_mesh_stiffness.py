"""Models of lines whose mean mesh stiffness stays, as over steps in which no slice of a face comes into touch."""

from dataclasses import replace

from gearwhine.coupling.linear.line_sensitivity import LineModel


def without_stiffness(model: LineModel) -> LineModel:
    """Return the model with a mean mesh stiffness that does not change with the gap of the flanks."""
    found = replace(model)
    rates = {number: replace(one, stiffness=0.0 * one.stiffness) for number, one in model._gap_rates.items()}
    assert rates
    vars(found)["_gap_rates"] = rates
    return found
