"""The worlds that can be opened by name."""

from __future__ import annotations

from dataclasses import replace

from app.engine.library import Library
from sim2d import load_world

OFFICE = load_world("office")


def test_dropped_plans_of_one_name_are_numbered() -> None:
    library, names = Library(OFFICE), list[str]()
    for width in (1, 2, 3):
        plan = library.named(replace(OFFICE, name="plan", title=f"{width} m"))
        library.add(plan)
        names.append(plan.name)
    assert names == ["plan", "plan-2", "plan-3"]
    assert library.named(library.world("plan-2")).name == "plan-2", "one that is here already keeps its own"


def test_a_world_that_was_brought_back_stays_when_another_is_opened() -> None:
    library, mine = Library(OFFICE), replace(OFFICE, name="mine", title="Mine")
    library.saved(mine)
    library.deleted("mine", open_now="mine")
    library.restored("mine", "Mine")
    library.close("office")
    assert library.world("mine") == mine
    library.deleted("mine", open_now="mine")
    library.close("office")
    assert "mine" not in dict(library.titles)
