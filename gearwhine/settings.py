"""Settings: what the analyses of a machine take beside it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gearwhine.numerics.findings import Instance, Number, Numbers, Rule, attribute_findings, refuse

if TYPE_CHECKING:
    from gearwhine.coupling.analyses.recording import TransientPlan
    from gearwhine.coupling.analyses.run_up import OrderTracking
    from gearwhine.coupling.sound import Acoustics


@dataclass(frozen=True)
class Settings:
    """What analyses of a machine take beside it.

    Attributes
    ----------
    title : str
        Title of the results.
    transient : TransientPlan, optional
        Stretch of the motion over time; without one ``run`` has no motion.
    tracking : OrderTracking, optional
        Windows of the orders along a run.
    speeds : sequence of float
        Signed speeds of the first driver's shaft for analyses over speed [rad/s].
    acoustics : Acoustics, optional
        Method and medium, floor and microphones of the sound.
    sound_in_run : bool, optional
        Whether ``run`` finds the sound of its motion with these acoustics; by default unless they are boundary
        elements, which take minutes.
    """

    title: str = ""
    transient: "TransientPlan | None" = None
    tracking: "OrderTracking | None" = None
    speeds: Sequence[float] = ()
    acoustics: "Acoustics | None" = None
    sound_in_run: bool | None = None

    def __post_init__(self) -> None:
        """Keep own copies, and check each of them."""
        from gearwhine.coupling.analyses.recording import TransientPlan
        from gearwhine.coupling.analyses.run_up import OrderTracking
        from gearwhine.coupling.errors import CouplingError
        from gearwhine.coupling.sound import Acoustics
        from gearwhine.numerics.own_copies import keep_tuples

        keep_tuples(self, "speeds")
        rules: dict[str, Rule] = {
            "title": Instance(str, "a text"),
            "transient": Instance(TransientPlan, "a TransientPlan, or None", optional=True),
            "tracking": Instance(OrderTracking, "an OrderTracking, or None", optional=True),
            "speeds": Numbers(each=Number(unit="rad/s")),
            "acoustics": Instance(Acoustics, "an Acoustics, or None", optional=True),
            "sound_in_run": Instance(bool, "a truth value, or None", optional=True),
        }
        refuse(attribute_findings(("settings", self.title), self, **rules), CouplingError)

    @property
    def is_sound_in_run(self) -> bool:
        """Whether ``run`` finds the sound of its motion."""
        if self.acoustics is None:
            return False
        return self.acoustics.method != "boundary-elements" if self.sound_in_run is None else self.sound_in_run
