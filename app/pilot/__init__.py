"""What moves the robot: explore, avoid, follow a route, obey the hand, get free."""

from app.pilot.params import PilotParams
from app.pilot.pilot import Mode, Pilot
from app.pilot.route_following import Progress

__all__ = ["Mode", "Pilot", "PilotParams", "Progress"]
