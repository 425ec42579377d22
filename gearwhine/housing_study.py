"""Study of a housing: its natural modes, and these beside measured ones, each as a result."""

from typing import TYPE_CHECKING

from gearwhine.numerics.progress import Progress, silent
from gearwhine.view_names import ModeFormat, View

if TYPE_CHECKING:
    import numpy.typing as npt

    from gearwhine.analyses.origin import Origin
    from gearwhine.analyses.result import Result
    from gearwhine.housing import HousingModes
    from gearwhine.housing.correlation.comparison import Comparison
    from gearwhine.housing.modal_test import ModalTest, PlannedSurvey
    from gearwhine.housing.reduced import ReducedHousing


class HousingAnalyses:
    """The analyses of a solved housing, alone or with a machine in it."""

    progress: Progress

    @property
    def origin(self) -> "Origin":
        """What results are of."""
        raise NotImplementedError

    def required_housing(self, command: str) -> "HousingModes":
        """Return the housing; where there is none, the command is refused."""
        raise NotImplementedError

    def modes(self, *, detail: bool = False) -> "Result[HousingModes] | Result[ReducedHousing]":
        """Natural modes of the housing, certified complete, with checks of the model.

        Parameters
        ----------
        detail : bool
            Also report effective masses, support reactions, and the modes dominant between bearings and sensors.
        """
        from gearwhine.analyses.housing import modes_result

        return modes_result(self.required_housing("modes"), self.origin, detail=detail)

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
        from gearwhine.analyses.housing import compare_result
        from gearwhine.housing.modal_test import compare_test

        test = _modal_test(measured)
        housing = self.required_housing("compare")
        return compare_result(housing, compare_test(housing, test, self.progress), self.origin)

    def survey(self, sensors: int | None = None, modes: int | None = None) -> "Result[PlannedSurvey]":
        """Plan a modal survey: sensor and hammer positions.

        Parameters
        ----------
        sensors : int, optional
            Number of sensors, each normal to the surface; by default three for two modes.
        modes : int, optional
            Number of lowest modes to survey; by default all known.

        Raises
        ------
        gearwhine.HousingError
            Where the sensors cannot separate the modes.
        """
        from gearwhine.analyses.housing import survey_result
        from gearwhine.housing.modal_test import plan_modal_survey

        housing = self.required_housing("survey")
        self.progress("choosing sensors")
        return survey_result(housing, plan_modal_survey(housing, sensors, modes), self.origin)

    def render(
        self, modes: str = "dominant", *, view: View = "auto", mode_format: ModeFormat = "png"
    ) -> "Result[HousingModes]":
        """Draw mode shapes.

        Parameters
        ----------
        modes : str
            Modes to draw: 'dominant', 'all', '1,4,9' or '1-6'.
        view : str
            Direction of view; 'auto': for each shape the corner from which most of its motion is seen.
        mode_format : {"png", "glb", "gif", "mp4"}
            Picture, animated glTF model, or film (MP4 needs ffmpeg).

        Raises
        ------
        CaseError
            Where something is asked for that cannot be drawn.
        gearwhine.housing.errors.RendererUnavailableError, gearwhine.housing.errors.EncoderUnavailableError
            Where no renderer or encoder is available.
        """
        from gearwhine.analyses.housing import render
        from gearwhine.mode_pictures import check_request

        check_request(modes, mode_format, ())
        housing = self.required_housing("render")
        return render(housing, self.origin, modes, view=view, mode_format=mode_format, progress=self.progress)


class HousingStudy(HousingAnalyses):
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

    def required_housing(self, command: str) -> "HousingModes":
        """Return the housing; one of reduced matrices, which has no mesh, is refused."""
        from gearwhine.housing import HousingError, HousingModes

        if not isinstance(self.housing, HousingModes):
            raise HousingError(f"{command}: expected a housing with its mesh; that of reduced matrices has none")
        return self.housing

    def modes(self, *, detail: bool = False) -> "Result[HousingModes] | Result[ReducedHousing]":
        """Natural modes of the housing, certified complete, with checks of the model.

        Parameters
        ----------
        detail : bool
            Also report effective masses, support reactions, and the modes dominant between bearings and sensors.
        """
        from gearwhine.analyses.reduced_housing import reduced_modes_result
        from gearwhine.housing import HousingModes

        if isinstance(self.housing, HousingModes):
            return super().modes(detail=detail)
        return reduced_modes_result(self.housing, self.origin)

    def compare(self, measured: "ModalTest | npt.ArrayLike") -> "Result[Comparison]":
        """Compare the housing's modes with measured ones, as :meth:`HousingAnalyses.compare` does.

        Parameters
        ----------
        measured : ModalTest or sequence of float
            Modal test, or the frequencies alone of measured modes [rad/s].
        """
        from gearwhine.analyses.reduced_housing import reduced_compare_result
        from gearwhine.housing import HousingModes
        from gearwhine.housing.reduced_modal_test import compare_reduced

        if isinstance(self.housing, HousingModes):
            return super().compare(measured)
        test = _modal_test(measured)
        return reduced_compare_result(self.housing, compare_reduced(self.housing, test), test.modes, self.origin)


def _modal_test(measured: "ModalTest | npt.ArrayLike") -> "ModalTest":
    """Return a modal test, made of frequencies alone where no more is known [rad/s]."""
    import numpy as np

    from gearwhine.housing.measured import MeasuredModes
    from gearwhine.housing.modal_test import ModalTest

    if isinstance(measured, ModalTest):
        return measured
    return ModalTest(MeasuredModes(np.atleast_1d(np.asarray(measured, dtype=np.float64))))
