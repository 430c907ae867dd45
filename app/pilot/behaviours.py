"""The behaviours of the robot. Each has a number, which the links of the experience map store, and words for people."""

from __future__ import annotations

from enum import Enum


class Behaviour(Enum):
    """Number and words of each behaviour. Several may share a number; 0 means standing."""

    STARTING = 0, "starting"
    WAITING = 0, "waiting for the hand"
    AT_THE_GOAL = 0, "at the goal"
    FOLLOWING_THE_WALL = 1, "following the wall"
    CROSSING = 2, "crossing"
    LOOKING_BACK = 3, "turning back to look"
    FOLLOWING_THE_ROUTE = 4, "following the route"
    COASTING = 4, "coasting on the old route"
    SEEKING = 4, "going where the map is thin"
    RETURNING = 4, "going back to known ground"
    LOCALISING = 4, "finding out where it is"
    FREEING_ITSELF = 5, "freeing itself"
    DRIVEN_BY_HAND = 6, "driven by hand"

    def __init__(self, number: int, words: str) -> None:
        self.number, self.words = number, words


def words_of(number: int) -> str:
    """The words for a number stored in a link: those of the first behaviour that has it."""
    if number == 0:
        return "standing"
    return next((behaviour.words for behaviour in Behaviour if behaviour.number == number), str(number))
