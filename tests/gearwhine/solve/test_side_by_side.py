"""Tasks shared out among processes give what they give one by one."""

import os

import pytest

from gearwhine.housing import HousingError
from gearwhine.solve.updating import in_parallel


@pytest.mark.slow
def test_results_come_in_the_order_of_the_tasks_from_other_processes() -> None:
    factor = 3

    def work(number: int) -> tuple[int, int, str]:
        return factor * number, os.getpid(), os.environ["OMP_NUM_THREADS"]

    with in_parallel(2) as each:
        rows = list(each(work, [5, 2, 9, 4]))
    assert [row[0] for row in rows] == [15, 6, 27, 12]
    assert os.getpid() not in {row[1] for row in rows}
    assert {row[2] for row in rows} == {"1"}


def test_one_worker_is_this_process() -> None:
    with in_parallel(1) as each:
        assert list(each(lambda number: (number, os.getpid()), [1, 2])) == [(1, os.getpid()), (2, os.getpid())]


@pytest.mark.slow
def test_what_goes_wrong_in_a_process_is_raised_here() -> None:
    def work(number: int) -> int:
        if number == 2:
            raise HousingError("walls meet")
        return number

    with in_parallel(2) as each, pytest.raises(HousingError, match="walls meet"):
        list(each(work, [1, 2, 3]))
