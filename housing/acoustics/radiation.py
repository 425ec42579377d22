"""Radiation of a housing's modes: sound power ½ q̇ᴴ R q̇ by boundary elements, Rayleigh's integral or the ERP estimate.

The normal velocity of the radiating surface is a sum of the modes' with the rates q̇ of their coordinates. Each method
turns it into a pressure on the surface:

- *boundary elements*: the exterior Helmholtz equation over the whole surface;
- *Rayleigh*: each chosen flat face alone in an infinite baffle;
- *ERP*, the equivalent radiated power: ρ c v at every point, a radiation efficiency of 1. It is an estimate.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from gearwhine.housing.acoustics.boundary_elements import BoundaryElements, SoundField, surface_product
from gearwhine.housing.acoustics.known_source import NOTHING_TO_PROVE, SourceError
from gearwhine.housing.acoustics.medium import AIR, HardPlane, Medium
from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.reduced_elements import ReducedElements, SpanningSolutions, spanning_frequencies
from gearwhine.housing.acoustics.skin_points import SkinPoints
from gearwhine.housing.acoustics.surface_velocity import face_surface, surface_velocity, transfer_error
from gearwhine.housing.acoustics.wrapping import wrap
from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.surface import FlatFace
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.progress import Progress, in_order, silent

Method = Literal["boundary-elements", "rayleigh", "erp"]

POWERS_AGREE = 0.1
"""Largest relative difference of the power through the surface and into the far field."""

LEAK = 0.1
"""Pressure inside, relative to that on the surface, above which a solution is doubtful."""

SOURCE_OFF = 1.0
"""Error of a known source's pressure at a vertex above which a solution is doubtful: it is as large as the pressure."""

SOURCE_LOST = 10.0
"""Error of a known source's pressure at a vertex above which a solution is refused: the equations leave it free.

No body of the study in the documentation had as much, with triangles as large as they may be."""

SOURCE_HEARD = 0.1
"""Error of a known source's pressure at a point in the air above which the sound pressure there is doubtful."""

COUNTS = 1e-4
"""Part of the whole power above which a line has to prove its own, and radiation efficiency above which a mode has."""

_NO_PRESSURE = "the sound pressure at a point needs boundary elements, or Rayleigh's integral of one face"

_STANDS = 0.02  # edges from the floor within which vertices of a wrap, which follows the skin as exactly, lie in it


class Field(Protocol):
    """Pressure on a surface that moves, by any method."""

    @property
    def surface(self) -> RadiatingSurface: ...  # noqa: D102
    @property
    def velocity(self) -> ComplexArray: ...  # noqa: D102
    @property
    def pressure_at_corners(self) -> ComplexArray: ...  # noqa: D102
    @property
    def velocity_products(self) -> ComplexArray: ...  # noqa: D102
    @property
    def resistance(self) -> FloatArray: ...  # noqa: D102
    @property
    def surface_resistance(self) -> FloatArray: ...  # noqa: D102
    @property
    def interior_residual(self) -> float: ...  # noqa: D102
    @property
    def source_error(self) -> SourceError: ...  # noqa: D102


@dataclass(frozen=True)
class EquivalentField:
    """Field of the equivalent radiated power: the pressure ρ c v of a plane wave at every point.

    The attributes are those of :class:`gearwhine.housing.acoustics.boundary_elements.SoundField`.
    """

    surface: RadiatingSurface
    medium: Medium
    velocity: ComplexArray

    @property
    def pressure_at_corners(self) -> ComplexArray:
        """ρ c v [Pa], shape (3 n_triangles, n)."""
        return self.medium.impedance * self.velocity

    @cached_property
    def velocity_products(self) -> ComplexArray:
        """∫ v̄ᵢ vⱼ dS [m⁴/s²], shape (n, n)."""
        return surface_product(self.surface, self.velocity, self.velocity)

    @property
    def resistance(self) -> FloatArray:
        """ρ c Re ∫ v̄ᵢ vⱼ dS, shape (n, n)."""
        return np.asarray(self.medium.impedance * self.velocity_products.real)

    @property
    def surface_resistance(self) -> FloatArray:
        """Radiation resistance of the estimate; the two are the same."""
        return self.resistance

    @property
    def interior_residual(self) -> float:
        """0: an estimate has no inside."""
        return 0.0

    @property
    def source_error(self) -> SourceError:
        """Zero: an estimate has no equations."""
        return NOTHING_TO_PROVE


@dataclass(frozen=True)
class RadiatedSound:
    """Sound of some motions of the housing at one frequency, which are added coherently.

    Attributes
    ----------
    frequency_hz : float
    medium : Medium
    fields : tuple of Field
        One, or for Rayleigh's integral one of each face.
    modal : tuple of ndarray, shape (3 n_triangles, n_modes)
        Normal velocities of the modes, of each field's surface.
    coordinates : ndarray, shape (n_modes, n)
        Rates q̇ of the modes' coordinates in each motion.
    faces : tuple of str
        Label of every triangle, of all fields one after the other.
    """

    frequency_hz: float
    medium: Medium
    fields: tuple[Field, ...]
    modal: tuple[FloatArray, ...]
    coordinates: ComplexArray
    faces: tuple[str, ...]

    @cached_property
    def resistance(self) -> FloatArray:
        """Radiation resistance R of the motions, shape (n, n), as :attr:`SoundField.resistance`."""
        return np.asarray(sum(field.resistance for field in self.fields))

    @property
    def power(self) -> float:
        """Sound power of the sum of all motions [W]."""
        return float(0.5 * self.resistance.sum())

    @property
    def surface_power(self) -> float:
        """Radiated power by the intensity on the surface [W]."""
        return float(0.5 * sum(field.surface_resistance.sum() for field in self.fields))

    @property
    def area(self) -> float:
        """Radiating area [m²]."""
        return float(sum(field.surface.area for field in self.fields))

    @property
    def mean_square_velocity(self) -> float:
        """Mean over the surface of the sum's normal velocity, squared and averaged over time [m²/s²]."""
        return float(0.5 * sum(field.velocity_products.sum().real for field in self.fields) / self.area)

    @property
    def equivalent_power(self) -> float:
        """Equivalent radiated power ρ c S ⟨v²⟩ of the sum [W]: that of a radiation efficiency of 1."""
        return self.medium.impedance * self.area * self.mean_square_velocity

    @property
    def radiation_efficiency(self) -> float:
        """Radiation efficiency σ = W / (ρ c S ⟨v²⟩) of the sum; 0 where nothing moves."""
        equivalent = self.equivalent_power
        return self.power / equivalent if equivalent > 0.0 else 0.0

    @property
    def interior_residual(self) -> float:
        """Largest of all fields; infinite: no proof.

        See :class:`gearwhine.housing.acoustics.boundary_elements.SoundField`.
        """
        return max(field.interior_residual for field in self.fields)

    @property
    def doubt(self) -> str | None:
        """Why the solution is doubtful, to be read after "doubtful:"; None where the pressure inside proves it."""
        leak = self.interior_residual
        if leak <= LEAK:
            return None
        if np.isinf(leak):
            return "no point inside the radiating surface is far enough from it to prove the solution"
        return (
            f"the pressure inside the radiating surface is {100.0 * leak:.2g} % of that on it, where zero is exact; "
            "use smaller triangles"
        )

    @property
    def source_error(self) -> SourceError:
        """Error of known sources inside, of the field where it is largest; infinite: no proof."""
        return max((field.source_error for field in self.fields), key=lambda error: error.largest)

    @property
    def source_doubt(self) -> str | None:
        """Why the pressure on the surface is doubtful, as :attr:`doubt`; None where known sources prove it.

        A body without points inside has that doubt alone.
        """
        error = self.source_error
        if error.largest <= SOURCE_OFF or np.isinf(self.interior_residual):
            return None
        if np.isinf(error.largest):
            return "no place inside the radiating surface is far enough from its triangles for a known source"
        return f"{_of_source(error)}; use triangles of another size, best smaller ones"

    def require_proofs(self) -> None:
        """Refuse a solution whose powers differ, or that is wrong for known sources.

        Raises
        ------
        HousingError
            As :meth:`require_balance` and :meth:`require_source`.
        """
        self.require_balance()
        self.require_source()

    def require_source(self) -> None:
        """Refuse a solution that errs by more than ten times the amplitude of known sources at a vertex.

        Raises
        ------
        HousingError
            With the error and its place.
        """
        error = self.source_error
        if np.isfinite(error.largest) and error.largest > SOURCE_LOST:
            raise HousingError(
                f"at {self.frequency_hz:.1f} Hz {_of_source(error)}; expected at most {100.0 * SOURCE_LOST:.0f} %: use "
                "triangles of another size, best smaller ones"
            )

    def require_balance(self) -> None:
        """Refuse a solution whose powers through the surface and into the far field differ by more than 10 %.

        Raises
        ------
        HousingError
            With both powers.
        """
        if abs(self.surface_power - self.power) > POWERS_AGREE * abs(self.power):
            raise HousingError(
                f"at {self.frequency_hz:.1f} Hz the sound power is {self.surface_power:.4g} W through the surface and "
                f"{self.power:.4g} W in the far field; expected a difference of at most 10 %: use smaller triangles"
            )

    @cached_property
    def by_motion(self) -> FloatArray:
        """Part of each motion in the power of the sum [W], shape (n,): ½ Re Σⱼ Rᵢⱼ; negative where it works against."""
        return np.asarray(0.5 * self.resistance.sum(axis=1))

    @property
    def power_alone(self) -> FloatArray:
        """Sound power of each motion without the others [W], shape (n,): ½ Rᵢᵢ."""
        return np.asarray(0.5 * np.diag(self.resistance))

    @cached_property
    def by_mode(self) -> FloatArray:
        """Part of each mode in the surface power of the sum [W], shape (n_modes,): ½ Re q̇̄ᵢ ∫ vᵢ p dS."""
        rates = self.coordinates.sum(axis=1)
        powers = np.zeros(len(rates))
        for field, modal in zip(self.fields, self.modal, strict=True):
            pressure = field.pressure_at_corners.sum(axis=1, keepdims=True)
            powers += 0.5 * (rates.conj() * surface_product(field.surface, modal, pressure)[:, 0]).real
        return powers

    @cached_property
    def intensity(self) -> FloatArray:
        """Mean sound intensity of the sum out of each triangle [W/m²], of all fields one after the other."""
        intensities = []
        for field in self.fields:
            shape = (len(field.surface.triangles), 3)
            velocity, pressure = field.velocity.sum(axis=1).reshape(shape), field.pressure_at_corners.sum(axis=1)
            mean = (np.ones((3, 3)) + np.eye(3)) / 12.0
            intensities.append(0.5 * np.einsum("ea,ab,eb->e", velocity.conj(), mean, pressure.reshape(shape)).real)
        return np.concatenate(intensities)

    @property
    def by_face(self) -> dict[str, float]:
        """Power through each face [W], the largest first."""
        areas = np.concatenate([field.surface.areas for field in self.fields])
        labels, number = np.unique(np.array(self.faces), return_inverse=True)
        powers = np.bincount(number, self.intensity * areas, len(labels))
        return {str(labels[i]): float(powers[i]) for i in np.argsort(-powers, kind="stable")}

    def pressure_at(self, points: FloatArray) -> ComplexArray:
        """Sound pressure of the sum at points in the air [Pa], shape (n_points,).

        Raises
        ------
        HousingError
            Where a point is not in the air, see :func:`gearwhine.housing.acoustics.boundary_elements.require_in_air`,
            or the method gives no pressure: the ERP, or Rayleigh's integral of several faces.
        """
        return np.asarray(self._only_field.pressure_at(points).sum(axis=1))

    def source_error_at(self, points: FloatArray) -> FloatArray:
        """Error of known sources at points in the air, relative to their amplitude there, shape (n_points,).

        Zero for a flat face, infinite where no source can stand.

        Raises
        ------
        HousingError
            As :meth:`pressure_at`.
        """
        return self._only_field.source_error_at(points)

    @property
    def _only_field(self) -> SoundField:
        if len(self.fields) != 1 or not isinstance(field := self.fields[0], SoundField):
            raise HousingError(_NO_PRESSURE)
        return field


def _of_source(error: SourceError) -> str:
    place, percent = ", ".join(f"{1e3 * coordinate:.4g}" for coordinate in error.place), 100.0 * error.largest
    shown = f"{percent:.3g}" if percent < 999.5 else f"{percent:.0f}"
    return (
        f"the pressure of a known source inside is off by {shown} % at the vertex ({place}) mm of the radiating surface"
    )


class Powers(Protocol):
    """Sound power by two ways [W]."""

    @property
    def power(self) -> float: ...  # noqa: D102
    @property
    def surface_power(self) -> float: ...  # noqa: D102


Sound = TypeVar("Sound", bound=Powers)


def counting(sounds: Sequence[Sound]) -> list[Sound]:
    """Return the lines of a motion whose power, by either method, counts beside the power of all."""
    least = COUNTS * sum(sound.power for sound in sounds)
    return [sound for sound in sounds if max(sound.power, sound.surface_power) > least]


def require_proved(sounds: Sequence[RadiatedSound], *, alone: bool = False) -> list[RadiatedSound]:
    """Require the proofs of all sounds but those too weak to count.

    Parameters
    ----------
    sounds : sequence of RadiatedSound
    alone : bool
        Whether each sound stands for itself, as that of a mode does. Else they are lines of one motion, whose powers
        add up.

    Returns
    -------
    list of RadiatedSound
        Sounds that count. Lines below 1e-4 of the whole power, by both powers, change its level by 0.0004 dB at most.
        A sound alone counts above a radiation efficiency of 1e-4; below it the parts of neighbouring areas cancel to
        four digits in the power through the surface, which has no digit left that could prove the other.

    Raises
    ------
    HousingError
        As :meth:`RadiatedSound.require_proofs`.
    """
    counted = [sound for sound in sounds if sound.radiation_efficiency > COUNTS] if alone else counting(sounds)
    for sound in counted:
        sound.require_proofs()
    return counted


def set_down(surface: RadiatingSurface, floor: HardPlane, edge: float) -> RadiatingSurface:
    """Move the vertices of a wrap within 2 % of its edge [m] from a floor into it."""
    heights = floor.height(surface.points)
    moved = np.where(np.abs(heights) < _STANDS * edge, heights, 0.0)
    return RadiatingSurface(surface.points - np.outer(moved, floor.normal), surface.triangles)


_ASSEMBLY = 0.4  # part of a solution's time in which its equations are assembled
_TRIANGLES_ALONG = 3.0
"""Triangles along the shortest side of a housing that a wrap has at least, so that it has its shape."""


def coarsest_edge(mesh: Mesh) -> float:
    """Return the longest edge with which triangles wrap a housing [m]."""
    return float(np.ptp(mesh.bounds, axis=0).min()) / _TRIANGLES_ALONG


def wrapped(
    mesh: Mesh,
    edge: float,
    close_holes: float,
    floor: HardPlane | None = None,
    progress: Progress = silent,
) -> RadiatingSurface:
    """Wrap a housing in triangles, and set it down on a floor where its vertices are within 2 % of an edge of it.

    Parameters
    ----------
    mesh : Mesh
    edge : float
        Edge of the triangles [m]; a longer one than `coarsest_edge` is taken as that.
    close_holes : float
        Diameter of the largest hole that is capped [m].
    floor : HardPlane, optional
    progress : callable
        Called with the words of each step, and its completed fraction in long ones.

    Raises
    ------
    TriangleSizeError, HousingError
        As :func:`gearwhine.housing.acoustics.wrapping.wrap`.
    """
    edge = min(edge, coarsest_edge(mesh))
    surface = wrap(mesh, edge, close_holes, progress)
    return surface if floor is None else set_down(surface, floor, edge)


@dataclass(frozen=True)
class HousingRadiation:
    """A housing's radiating surfaces and the normal velocities of its modes on them.

    Attributes
    ----------
    method : {"boundary-elements", "rayleigh", "erp"}
    elements : tuple of BoundaryElements
        One, or for Rayleigh's integral one of each face.
    modal : tuple of ndarray, shape (3 n_triangles, n_modes)
        Normal velocity at the corners of the triangles per rate of each mode's coordinate.
    faces : tuple of str
        Label of every triangle.
    skins : tuple of SkinPoints
        Points of the housing that each surface moves with.
    cap_area : float
        Area of the surface that closes holes [m²].
    transfer_error : float
        Root mean square over the natural modes of the relative difference of ∫ v² dS on the radiating surface and on
        the skin.
    reduced : ReducedElements or None
        Boundary elements in the span of solutions at some frequencies, see :meth:`spanned`.
    """

    method: Method
    elements: tuple[BoundaryElements, ...]
    modal: tuple[FloatArray, ...]
    faces: tuple[str, ...]
    skins: tuple[SkinPoints, ...]
    cap_area: float = 0.0
    transfer_error: float = 0.0
    reduced: ReducedElements | None = None

    @classmethod
    def of_surface(
        cls,
        mesh: Mesh,
        shapes: FloatArray,
        *,
        edge: float,
        close_holes: float,
        resting_caps: bool = False,
        method: Method = "boundary-elements",
        medium: Medium = AIR,
        floor: HardPlane | None = None,
        still: Sequence[str] = (),
        natural_modes: int | None = None,
        highest_frequency: float | None = None,
        progress: Progress = silent,
    ) -> "HousingRadiation":
        """Wrap the whole housing, by boundary elements or as an estimate.

        Parameters
        ----------
        mesh : Mesh
        shapes : ndarray, shape (n_modes, n_nodes, 3)
        edge : float
            Edge of the triangles [m].
        close_holes : float
            Diameter of the largest hole that is capped [m].
        resting_caps : bool
            Whether caps are at rest; else they move as their rims.
        method : {"boundary-elements", "erp"}
        medium : Medium
        floor : HardPlane, optional
            The wrap stands on it where its vertices are within 2 % of an edge.
        still : sequence of str
            Surfaces of the mesh that do not radiate. Those that lie in the floor do not in any case.
        natural_modes : int, optional
            Number of the shapes, from the first, that are natural modes and have to be the same on the surface as on
            the skin. Others, such as residual modes, are local and need not. Default: all.
        highest_frequency : float, optional
            Highest frequency that boundary elements are to solve [Hz].
        progress : callable
            Called with the words of each step, and its completed fraction in long ones.

        Raises
        ------
        TriangleSizeError
            Where the triangles are too large for the highest frequency or for the modes, or too many.
        HousingError
            Where the housing cannot be wrapped, or does not stand on or above the floor.
        """
        surface = wrapped(mesh, edge, close_holes, floor, progress)
        elements = BoundaryElements(surface, medium, floor)
        if method == "boundary-elements":
            elements.require_few()
            if highest_frequency is not None:
                elements.require_resolved(highest_frequency)
        progress("motion of the triangles with the housing")
        carried = surface_velocity(mesh, surface, resting_caps=resting_caps)
        error = transfer_error(carried, shapes[:natural_modes])
        error.require()
        points = carried.points(tuple(still)).on(elements.uncovered)
        labels = np.array(carried.face_of_triangles())
        return cls(
            method,
            (elements,),
            (_modal(points, shapes),),
            tuple(labels[elements.uncovered].tolist()),
            (points,),
            carried.cap_area,
            float(np.sqrt(np.mean(error.relative**2))),
        )

    @classmethod
    def of_faces(
        cls, mesh: Mesh, shapes: FloatArray, faces: dict[str, FlatFace], *, medium: Medium = AIR
    ) -> "HousingRadiation":
        """Take flat faces, each in an infinite baffle of its own (Rayleigh's integral).

        Parameters
        ----------
        mesh : Mesh
        shapes : ndarray, shape (n_modes, n_nodes, 3)
        faces : dict of str to gearwhine.housing.fem.surface.FlatFace
        medium : Medium
        """
        elements, modal, labels, skins = [], [], [], []
        for name, face in faces.items():
            surface, points = face_surface(mesh, face.facets)
            elements.append(BoundaryElements(surface, medium, HardPlane(face.center, face.normal)))
            modal.append(_modal(points, shapes))
            labels += [name] * len(surface.triangles)
            skins.append(points)
        return cls("rayleigh", tuple(elements), tuple(modal), tuple(labels), tuple(skins))

    @property
    def medium(self) -> Medium:
        """Acoustic medium."""
        return self.elements[0].medium

    @property
    def area(self) -> float:
        """Radiating area [m²]."""
        return float(sum(elements.surface.area for elements in self.elements))

    def require_in_air(self, points: FloatArray) -> None:
        """Refuse points at which the sound pressure cannot be found.

        Raises
        ------
        HousingError
            As :meth:`RadiatedSound.pressure_at`.
        """
        if self.method == "erp" or len(self.elements) != 1:
            raise HousingError(_NO_PRESSURE)
        self.elements[0].require_in_air(points)

    @property
    def highest_frequency(self) -> float:
        """Highest frequency that six elements a wavelength resolve [Hz]; infinity for the estimate."""
        if self.method == "erp":
            return float("inf")
        return min(elements.highest_frequency() for elements in self.elements)

    def spanned(
        self,
        frequencies: npt.ArrayLike,
        between: tuple[float, float],
        progress: Progress = silent,
        known: SpanningSolutions | None = None,
    ) -> "HousingRadiation":
        """Solve for all modes at a few frequencies, whose solutions span those at all frequencies between.

        The radiation that is returned solves far fewer equations there. It is this one where that is no matter: by
        another method than boundary elements, or where sound is wanted at few frequencies.

        Parameters
        ----------
        frequencies : array_like, shape (n,)
            Frequencies at which sound is wanted [Hz].
        between : tuple of float
            Lowest and highest frequency of any sound [Hz].
        progress : callable
        known : SpanningSolutions, optional
            Solutions for the same modes and surface, which are taken where they reach all these frequencies.
        """
        wanted = np.unique(np.asarray(frequencies, dtype=np.float64))
        if self.method != "boundary-elements" or self.reduced is not None or not len(wanted):
            return self
        (elements,), (modal,) = self.elements, self.modal
        columns = modal.shape[1] + len(elements.known_sources.places)
        shape = (len(elements.surface.points), columns)
        if known is not None and known.hold(wanted) and known.pressure.shape[1:] == shape:
            return replace(self, reduced=ReducedElements.of(elements, modal, known))
        between = min(between[0], float(wanted[0])), max(between[1], float(wanted[-1]))
        if (chosen := spanning_frequencies(wanted, between, elements, modal.shape[1])) is None:
            return self
        message, done = f"sound of all modes at {len(chosen)} frequencies", dict.fromkeys(chosen.tolist(), 0.0)

        def pressure(hertz: float) -> npt.NDArray[np.complex64]:
            def say(fraction: float) -> None:
                done[hertz] = fraction
                progress(message, sum(done.values()) / len(done))

            field = elements.solve(hertz, modal, lambda assembled: say(_ASSEMBLY * assembled))
            say(1.0)
            every = [field.pressure] if field.known is None else [field.pressure, field.known.pressure]
            return np.hstack(every).astype(np.complex64)

        progress(message, 0.0)
        solutions = SpanningSolutions(chosen, np.stack(in_order(pressure, chosen.tolist(), message)))
        return replace(self, reduced=ReducedElements.of(elements, modal, solutions))

    def solve(self, frequency_hz: float, coordinates: npt.ArrayLike) -> RadiatedSound:
        """Solve for the sound of some motions of the housing.

        Parameters
        ----------
        frequency_hz : float
        coordinates : array_like, shape (n_modes, n)
            Complex amplitudes of the rates of the modes' coordinates, of each motion.

        Raises
        ------
        HousingError
            Where the triangles are too large for the frequency.
        """
        rates = np.asarray(coordinates, dtype=np.complex128).reshape(self.modal[0].shape[1], -1)
        fields: list[Field] = []
        for elements, modal in zip(self.elements, self.modal, strict=True):
            if self.method == "erp":
                fields.append(EquivalentField(elements.surface, elements.medium, modal @ rates))
                continue
            field = None if self.reduced is None else self.reduced.solve(frequency_hz, rates)
            fields.append(field or elements.solve(frequency_hz, modal @ rates))
        return RadiatedSound(frequency_hz, self.medium, tuple(fields), self.modal, rates, self.faces)

    def equivalent_power(self, coordinates: npt.ArrayLike) -> FloatArray:
        """Equivalent radiated power ½ ρ c ∫ |v|² dS of each motion [W], shape (n,)."""
        rates = np.asarray(coordinates, dtype=np.complex128)
        total = np.zeros(rates.shape[1])
        for elements, gram in zip(self.elements, self._grams, strict=True):
            total += 0.5 * elements.medium.impedance * np.einsum("il,ij,jl->l", rates.conj(), gram, rates).real
        return total

    @cached_property
    def _grams(self) -> tuple[FloatArray, ...]:
        return tuple(
            surface_product(element.surface, modal, modal).real
            for element, modal in zip(self.elements, self.modal, strict=True)
        )

    def with_shapes(self, shapes: FloatArray) -> "HousingRadiation":
        """Take other modes of the same housing, shape (n_modes, n_nodes, 3)."""
        return replace(self, modal=tuple(_modal(points, shapes) for points in self.skins), reduced=None)


def _modal(points: SkinPoints, shapes: FloatArray) -> FloatArray:
    """Return the normal velocity of modes at the corners of the triangles, shape (3 n_triangles, n_modes)."""
    return np.ascontiguousarray(points.transfer @ shapes.reshape(len(shapes), -1).T)
