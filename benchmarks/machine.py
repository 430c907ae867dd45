"""Bars of time. What the machine does besides takes its share of it, so a missed one is told and fails nothing."""

from __future__ import annotations

import os


def verdict(met: bool) -> str:
    """What is said of a bar of time, after its figure."""
    return "met" if met else f"MISSED ({busy_words()})"


def busy_words() -> str:
    """How busy the machine was in the last minute, and what follows from that."""
    load, cores = os.getloadavg()[0], os.cpu_count() or 1
    return (
        f"the bars of time are those of two quiet cores; {load:.1f} processes wanted the {cores} of this machine in the last "
        f"minute, and what is missed by the clock is told and fails nothing"
    )
