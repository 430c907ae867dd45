"""Places named while the robot explores, and gone to by name. IROS 2005 IV."""

from __future__ import annotations

import pytest

from app import session_snapshot
from app.session import MOST_TAGS
from app.session_snapshot import restore_session, take_session
from app.views.office import tags_view

from .engines import an_engine, tell
from .sessions import OFFICE, a_session


def test_a_name_stands_for_the_experience_that_is_active_and_lies_where_it_lies() -> None:
    session = a_session(60)
    assert tags_view(session) == ()
    first = session.tag("kitchen")
    assert first == session.brain.experience_map.active
    (seen,), place = tags_view(session), session.brain.experience_map.pose(first)
    assert (seen.name, seen.experience, seen.x, seen.y) == ("kitchen", first, place.x, place.y)
    for _ in range(60):
        session.tick()
    session.tag(" desk ")
    second = session.brain.experience_map.active
    assert session.tags == {"kitchen": first, "desk": second}
    assert second != first
    session.tag("kitchen")
    assert session.tags["kitchen"] == second  # it has moved
    session.untag("kitchen")
    assert list(session.tags) == ["desk"]
    assert session.pilot.mode == "explore"


def test_a_name_is_a_goal_and_the_goal_can_be_changed_on_the_way() -> None:
    session = a_session(60)
    session.set_parameter("pilot.goal_place_m", 1.0)
    session.tag("kitchen")
    for _ in range(100):
        session.tick()
    session.tag("desk")
    for name in ("kitchen", "desk", "kitchen"):
        assert session.go_to_tag(name) == session.tags[name] == session.pilot.goal
        assert len(session.pilot.goals) > 1  # all experiences of the place, as after a click
        known = len(session.brain.experience_map), len(session.brain.local_view)
        for _ in range(20):
            session.tick()
        assert session.pilot.mode == "goal"
        assert (len(session.brain.experience_map), len(session.brain.local_view)) >= known  # learning goes on


def test_names_that_cannot_be() -> None:
    session = a_session(3)
    for bad in ("", "  ", "two\nlines"):
        with pytest.raises(ValueError, match=r"a tag needs a name|no control or bidirectional"):
            session.tag(bad)
    for order in (session.untag, session.go_to_tag):
        with pytest.raises(ValueError, match="there is no tag 'kitchen'; it must be given first"):
            order("kitchen")
    for k in range(MOST_TAGS):
        session.tag(f"place {k}")
    session.tag("place 3")
    with pytest.raises(ValueError, match=f"'desk' would be tag number {MOST_TAGS + 1}; {MOST_TAGS} are enough"):
        session.tag("desk")
    with pytest.raises(ValueError, match="there is no tag 'desk'; it must be one of: place 0, place 1"):
        session.go_to_tag("desk")


def test_tags_are_part_of_the_session() -> None:
    session = a_session(60)
    before = session.state_hash()
    session.tag("kitchen")
    assert session.state_hash() != before
    again = restore_session(take_session(session))
    assert (again.tags, again.state_hash()) == (session.tags, session.state_hash())
    again.tags["desk"] = 10**6
    with pytest.raises(ValueError, match="the experience tagged 'desk'"):
        session_snapshot.check(again, OFFICE)


def test_commands_of_tags() -> None:
    engine = an_engine(OFFICE)
    session = engine.run.session
    assert tell(engine, type="tag", name="kitchen") == "kitchen is here, at experience 0"
    assert tell(engine, type="go_to_tag", name="kitchen") == "to kitchen, experience 0"
    assert session.pilot.goal == 0
    tell(engine, type="untag", name="kitchen")
    assert session.tags == {}
    with pytest.raises(ValueError, match="there is no tag 'kitchen'"):
        tell(engine, type="go_to_tag", name="kitchen")
