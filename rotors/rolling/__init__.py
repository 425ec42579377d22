"""Rolling bearings from their geometry."""
from .elasticity import STEEL, ContactElasticity
from .equilibrium import rolling_equilibrium, rolling_reaction
from .rows import BallRow, RollerRow, RollingBearing
