"""Constraint matrix of a gear train: exact speeds of its shafts by null space and rank, torques by the transpose.

Every connection is a row of A ω = 0 over the speeds ω of all shafts about z. Gears with z_i and z_k teeth, negative for
an internal gear (ISO 21771), whose axes a carrier c carries, roll on each other where

    z_i (ω_i - ω_c) + z_k (ω_k - ω_c) = 0                                                     (Willis 1841)

with ω_c = 0 where no axis is carried; a held shaft is the row ω = 0. The speeds that satisfy all rows are the null
space, of as many dimensions as the train has degrees of freedom. Each row has one multiplier λ, the force of the
connection: the shafts feel Aᵀ λ, which does no work on any admissible speed, and T + Aᵀ λ = 0 balances the torques T.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

Row = Mapping[str, Fraction]
"""Coefficients of one row by shaft."""


@dataclass(frozen=True)
class GearedShafts:
    """Two shafts that a gear pair connects.

    Attributes
    ----------
    driver, driven : str
        Names of the shafts.
    teeth : tuple of int
        Tooth numbers of the driver and of the driven gear, negative for an internal gear.
    carrier : str, optional
        Shaft with which the axes of planets among the two turn; None where both axes stand still.
    """

    driver: str
    driven: str
    teeth: tuple[int, int]
    carrier: str | None = None

    @property
    def ratio(self) -> Fraction:
        """Speed of the driven shaft over that of the driver, both relative to the carrier; negative if both external.

        External gears turn opposite ways.
        """
        return Fraction(-self.teeth[0], self.teeth[1])

    @property
    def row(self) -> dict[str, Fraction]:
        """Row of the constraint matrix."""
        row = dict.fromkeys((self.driver, self.driven), Fraction(0))
        for shaft, teeth in zip((self.driver, self.driven), self.teeth, strict=True):
            row[shaft] += teeth
        if self.carrier is not None:
            row[self.carrier] = row.get(self.carrier, Fraction(0)) - sum(self.teeth)
        return row

    def torques(self, torque: float) -> dict[str, float]:
        """Torques about z of the mesh on its shafts by the torque about z that it takes from the driver [N m].

        They are in the proportion of the row's coefficients: the carrier gets, by the planet's bearings, what balances
        both gears.
        """
        return {shaft: -torque * float(value / self.teeth[0]) for shaft, value in self.row.items()}

    def relative_speed(self, speeds: Mapping[str, Fraction] | Mapping[str, float]) -> Fraction | float:
        """Speed of the driver relative to the carrier."""
        return speeds[self.driver] - (0 if self.carrier is None else speeds[self.carrier])


class SpeedRows:
    """Elimination of rows of speeds, by which each dependent shaft's speed is a sum over those of independent shafts.

    Parameters
    ----------
    drives : sequence of str
        Shafts whose speeds are given: the last to become dependent, the first of them never.
    """

    def __init__(self, drives: Sequence[str]) -> None:
        self.drives = tuple(drives)
        self.dependent: dict[str, dict[str, Fraction]] = {}

    def shares(self, shaft: str) -> Mapping[str, Fraction]:
        """Speed of a shaft by those of independent shafts."""
        return self.dependent.get(shaft, {shaft: Fraction(1)})

    def is_determined(self, shaft: str) -> bool:
        """Whether the drives alone fix the speed of a shaft."""
        return all(independent in self.drives for independent in self.shares(shaft))

    def add(self, row: Row) -> bool:
        """Add a row; return whether the drives can still turn with it, else leave it out."""
        left = self._reduced(row)
        open_shafts = [shaft for shaft in left if shaft not in self.drives]
        candidates = open_shafts or [shaft for shaft in left if shaft != self.drives[0]]
        if not candidates:
            return not left
        pivot = candidates[-1]
        value = left.pop(pivot)
        shares = {shaft: -each / value for shaft, each in left.items()}
        for other, present in self.dependent.items():
            if pivot in present:
                share = present.pop(pivot)
                self.dependent[other] = _sum([(Fraction(1), present), (share, shares)])
        self.dependent[pivot] = shares
        return True

    def _reduced(self, row: Row) -> dict[str, Fraction]:
        return _sum([(value, self.shares(shaft)) for shaft, value in row.items()])

    def at(self, shaft: str, speeds: Mapping[str, Fraction]) -> Fraction:
        """Speed of a shaft by those of the independent shafts, which stand still where none is given."""
        return sum(
            (share * speeds.get(independent, Fraction(0)) for independent, share in self.shares(shaft).items()),
            Fraction(0),
        )


def _sum(parts: Iterable[tuple[Fraction, Row]]) -> dict[str, Fraction]:
    """Return Σ factor row without the shafts on which it vanishes."""
    total: dict[str, Fraction] = {}
    for factor, row in parts:
        for shaft, value in row.items():
            total[shaft] = total.get(shaft, Fraction(0)) + factor * value
    return {shaft: value for shaft, value in total.items() if value}


def connected_shafts(rows: Sequence[Row], first: str) -> set[str]:
    """Return the shafts that rows connect with the first."""
    reached, left = {first}, list(rows)
    while True:
        touching = [row for row in left if not reached.isdisjoint(row)]
        if not touching:
            return reached
        reached.update(*touching)
        left = [row for row in left if not any(row is one for one in touching)]


def dependent_rows(rows: Sequence[Row]) -> tuple[bool, ...]:
    """Whether each row is a sum of others: whether forces along it and them can balance without any torque.

    By elimination of Aᵀ λ = 0: rows that no such λ has are those that stand alone.
    """
    found: dict[str, dict[str, Fraction]] = {}  # row by its pivot shaft
    origins: dict[str, dict[int, Fraction]] = {}  # its sum over the given rows
    dependent = set[int]()
    for number, row in enumerate(rows):
        left = {shaft: value for shaft, value in row.items() if value}
        origin = {number: Fraction(1)}
        while left:
            pivot = next((shaft for shaft in left if shaft in found), None)
            if pivot is None:
                chosen = next(iter(left))
                found[chosen], origins[chosen] = left, origin
                break
            factor = -left[pivot] / found[pivot][pivot]
            left = _sum([(Fraction(1), left), (factor, found[pivot])])
            for of, share in origins[pivot].items():
                origin[of] = origin.get(of, Fraction(0)) + factor * share
        else:
            dependent.update(of for of, share in origin.items() if share)
    return tuple(number in dependent for number in range(len(rows)))


def least_flows(rows: Sequence[Mapping[str, float]], leaving: Mapping[str, float]) -> list[float]:
    """Return the smallest flows f, in the sum of squares, that balance: Σ f B = P on every shaft.

    f = Bᵀ p with B Bᵀ p = P. The matrix is positive definite where no motion but that of shafts left out of P is
    possible, so elimination needs no pivoting.

    Parameters
    ----------
    rows : sequence of mapping
        Row of B over the shafts for each connection; shafts that are not in ``leaving`` balance whatever comes.
    leaving : mapping of str to float
        P, by the shafts that have to balance.
    """
    shafts = list(leaving)
    place = {shaft: index for index, shaft in enumerate(shafts)}
    size = len(shafts)
    balanced = [{place[shaft]: value for shaft, value in row.items() if shaft in place and value} for row in rows]
    matrix = [[0.0] * size + [leaving[shaft]] for shaft in shafts]
    for row in balanced:
        for i, first in row.items():
            for j, second in row.items():
                matrix[i][j] += first * second
    for pivot in range(size - 1, -1, -1):
        for index in range(pivot):
            factor = matrix[index][pivot] / matrix[pivot][pivot]
            if factor != 0.0:
                matrix[index] = [a - factor * b for a, b in zip(matrix[index], matrix[pivot], strict=True)]
    potentials = [0.0] * size
    for index in range(size):
        substituted = sum(matrix[index][column] * potentials[column] for column in range(index))
        potentials[index] = (matrix[index][size] - substituted) / matrix[index][index]
    return [sum(value * potentials[index] for index, value in row.items()) for row in balanced]
