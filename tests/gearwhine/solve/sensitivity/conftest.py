"""Rankings of one operating point share its lines."""

from collections.abc import Iterator
from typing import Any

import pytest

from gearwhine.coupling.load_analysis import ranking


@pytest.fixture(scope="module")
def lines_solved_once() -> Iterator[None]:
    """Solve the lines of a machine once for all rankings in one solved housing: a module has one load of each."""
    solve, known = ranking.solve_lines, list[tuple[Any, Any]]()

    def once(machine: Any, point: Any, housing: Any, *how: Any) -> Any:
        if not any(of is housing for of, _ in known):
            known.append((housing, solve(machine, point, housing, *how)))
        return next(lines for of, lines in known if of is housing)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ranking, "solve_lines", once)
        yield
