"""A made-up session, snapshot by snapshot, to develop and test the page with: test material only.

`fake_snapshot(tick)` depends on its arguments alone. Parts that seldom change stay the same objects for as long as a
real session would keep them.
"""

from tests.fake_snapshots.pose_cells import SNAP_EVERY
from tests.fake_snapshots.session import fake_reports, fake_snapshot, fake_walk

__all__ = ["SNAP_EVERY", "fake_reports", "fake_snapshot", "fake_walk"]
