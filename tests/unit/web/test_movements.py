"""Candidate movements on the floor of the office, as a browser receives them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.fake_snapshots import fake_snapshot
from tests.unit.web.bench import Bench
from tests.unit.web.office_moments import tried
from web.messages import Movements, Snapshot
from web.viewer.fits.office_fit import OfficeFit
from web.viewer.marks.movements import ENLARGED, arc_on_plate

AT = "/office/movements"
FIT = OfficeFit(fake_snapshot(430).world.bounds)


class Asked:
    """Notes how often somebody wants to see them."""

    def __init__(self, chosen: int = 1) -> None:
        self.times, self._chosen = 0, chosen

    def __call__(self) -> Movements:
        self.times += 1
        return tried(self._chosen)

    def snapshot(self) -> Snapshot:
        return replace(fake_snapshot(430), movements=self)


def there(bench: Bench) -> dict[str, int]:
    lines = {kind: len(bench.drawn(f"{AT}/{kind}")) for kind in ("free", "blocked", "ends")}
    return lines | {"chosen": len(bench.drawn(f"{AT}/chosen", "vertices"))}


def test_nobody_computes_them_until_somebody_switches_them_on(bench: Bench) -> None:
    asked = Asked()
    bench.show(asked.snapshot())
    assert (asked.times, there(bench)) == (0, {"free": 0, "blocked": 0, "ends": 0, "chosen": 0})
    bench.switch("movements", True)
    assert asked.times == 1
    shown = there(bench)
    assert (shown["free"], shown["blocked"], shown["ends"]) == (8, 4, 4)
    assert shown["chosen"] > 0
    bench.switch("movements", False)
    bench.show(Asked().snapshot())
    assert not any(there(bench).values())


def test_they_go_when_the_robot_chooses_no_arc(bench: Bench) -> None:
    bench.switch("movements", True)
    bench.show(Asked().snapshot())
    assert there(bench)["ends"] == 4
    bench.show(fake_snapshot(431))
    assert not any(there(bench).values())


def test_the_arrow_ends_where_the_chosen_arc_ends_enlarged(bench: Bench) -> None:
    bench.switch("movements", True)
    for chosen, end in ((1, (5.0 + ENLARGED * 0.4, 4.0)), (2, (5.0 + ENLARGED * 0.1, 4.0))):
        bench.show(Asked(chosen).snapshot())
        tip = FIT.to_plate(np.array([end]))[0]
        corners = bench.drawn(f"{AT}/chosen", "vertices")
        assert corners[:, 0].max() == pytest.approx(tip[0], abs=0.25)
        assert corners[:, 1].mean() == pytest.approx(tip[1], abs=0.05)


def test_a_turn_on_the_spot_is_an_arc_around_the_robot() -> None:
    way = arc_on_plate(tried(), 3, FIT, 0.25)
    middle = FIT.to_plate(np.array([(5.0, 4.0)]))[0]
    away = way - middle
    assert np.hypot(*away.T) == pytest.approx(1.7 * 0.25)
    assert np.arctan2(away[-1, 1], away[-1, 0]) == pytest.approx(0.6)
    assert np.arctan2(away[0, 1], away[0, 0]) == pytest.approx(0.0, abs=1e-6)
