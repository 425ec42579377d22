"""Study of a housing alone: its natural modes and these beside measured ones, each as a result."""

from typing import TYPE_CHECKING

from gearwhine.numerics.progress import Progress, silent

if TYPE_CHECKING:
    import numpy.typing as npt

    from gearwhine.analyses.origin import Origin
    from gearwhine.analyses.result import Result
    from gearwhine.housing import HousingModes
    from gearwhine.housing.correlation.comparison import Comparison
    from gearwhine.housing.modal_test import ModalTest, PlannedSurvey
    from gearwhine.housing.reduced import ReducedHousing


class HousingStudy:
    """A solved housing and the analyses of it alone.

    Parameters
    ----------
    housing : gearwhine.housing.HousingModes or gearwhine.housing.reduced.ReducedHousing
        Natural modes of a housing, see :meth:`gearwhine.Housing.modes`, or a housing of reduced matrices.
    title : str
    progress : callable
        Receives the progress of long work in words; silent by default.

    Raises
    ------
    gearwhine.HousingError
        Where the housing is something else.
    """

    def __init__(self, housing: "HousingModes | ReducedHousing", title: str = "", progress: Progress = silent) -> None:
        from gearwhine.housing import HousingError, HousingModes
        from gearwhine.housing.reduced import ReducedHousing

        if not isinstance(housing, HousingModes | ReducedHousing):
            expected = "the modes of a housing, as gearwhine.Housing.modes() gives, or of a ReducedHousing"
            raise HousingError(f"a study is of {expected}; got {housing!r:.60}")
        self.housing, self.title, self.progress = housing, title, progress

    @property
    def origin(self) -> "Origin":
        """What results are of."""
        from gearwhine.analyses.origin import Origin
        from gearwhine.housing import HousingModes
        from gearwhine.numerics.result_warnings import warning

        doubts = self.housing.housing.findings if isinstance(self.housing, HousingModes) else ()
        return Origin(self.title, warnings=[warning("input", str(doubt)) for doubt in doubts])

    def modes(self, *, detail: bool = False) -> "Result[HousingModes] | Result[ReducedHousing]":
        """Natural modes of the housing, certified complete, with checks of the model.

        Parameters
        ----------
        detail : bool
            Also report effective masses, support reactions, and the modes dominant between bearings and sensors.
        """
        from gearwhine.analyses.housing import modes_result
        from gearwhine.analyses.reduced_housing import reduced_modes_result
        from gearwhine.housing import HousingModes

        if not isinstance(self.housing, HousingModes):
            return reduced_modes_result(self.housing, self.origin)
        return modes_result(self.housing, self.origin, detail=detail)

    def compare(self, measured: "ModalTest | npt.ArrayLike") -> "Result[Comparison]":
        """Compare the housing's modes with measured ones: frequencies, MAC, frequency responses.

        Parameters
        ----------
        measured : ModalTest or sequence of float
            Modal test, or the frequencies alone of measured modes [rad/s].

        Raises
        ------
        gearwhine.HousingError
            Where the modes are not known as high as the measured ones, or the test does not fit the housing.
        """
        import numpy as np

        from gearwhine.analyses.housing import compare_result
        from gearwhine.analyses.reduced_housing import reduced_compare_result
        from gearwhine.housing import HousingModes
        from gearwhine.housing.measured import MeasuredModes
        from gearwhine.housing.modal_test import ModalTest, compare_test
        from gearwhine.housing.reduced_modal_test import compare_reduced

        test = measured
        if not isinstance(test, ModalTest):
            test = ModalTest(MeasuredModes(np.atleast_1d(np.asarray(measured, dtype=np.float64))))
        if not isinstance(self.housing, HousingModes):
            return reduced_compare_result(self.housing, compare_reduced(self.housing, test), test.modes, self.origin)
        return compare_result(self.housing, compare_test(self.housing, test, self.progress), self.origin)

    def survey(self, sensors: int, modes: int | None = None) -> "Result[PlannedSurvey]":
        """Plan a modal survey: sensor and hammer positions.

        Parameters
        ----------
        sensors : int
            Number of sensors, each normal to the surface.
        modes : int, optional
            Number of lowest modes to survey; by default all known.

        Raises
        ------
        gearwhine.HousingError
            Where the sensors cannot separate the modes, or the housing has no mesh.
        """
        from gearwhine.analyses.housing import survey_result
        from gearwhine.housing import HousingError, HousingModes
        from gearwhine.housing.modal_test import plan_modal_survey

        if not isinstance(self.housing, HousingModes):
            raise HousingError("survey: expected a housing with its mesh; that of reduced matrices has none")
        self.progress(f"choosing {sensors} sensors")
        return survey_result(self.housing, plan_modal_survey(self.housing, sensors, modes), self.origin)
