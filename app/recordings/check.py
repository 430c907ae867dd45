"""What is in a recording, what will be used for what, and what is wrong with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from app.recordings.motion import lengths
from app.recordings.recording import About, Recording


@dataclass(frozen=True, slots=True)
class Checked:
    """A recording after every moment of it was read."""

    about: About
    moments: int  # that can be played
    seconds: float
    longest_gap_s: float  # between two moments

    @property
    def report(self) -> dict[str, Any]:
        """As JSON."""
        about = self.about
        report: dict[str, Any] = {
            "recording": about.name,
            "format": about.format,
            "moments": self.moments,
            "seconds": round(self.seconds, 3),
            "longest_gap_s": round(self.longest_gap_s, 3),
            "has": sorted(about.has),
            "uses": list(about.uses),
            "problems": list(about.problems),
            "counts": [{"what": count.what, "read": count.read, "of": count.there} for count in about.counts],
            "unused": list(about.unused),
            "lengths": lengths(about) or "metres",
        }
        if about.image_shape is not None:
            report["image_shape"] = list(about.image_shape)
        if about.beam_angles_rad:
            report["beams"] = len(about.beam_angles_rad)
        return report

    @property
    def lines(self) -> list[str]:
        """For people."""
        about = self.about
        rate = f", {(self.moments - 1) / self.seconds:.3g} a second" if self.seconds > 0 else ""
        lines = [f"{about.name}: {about.format}; {self.moments} moments in {self.seconds:.6g} s{rate}"]
        if about.image_shape is not None:
            lines.append(f"  pictures of {about.image_shape[1]} x {about.image_shape[0]} pixels")
        if about.beam_angles_rad:
            limit = "" if about.range_limit_m is None else f" up to {about.range_limit_m:g} m"
            lines.append(f"  scans of {len(about.beam_angles_rad)} beams{limit}")
        lines += [f"  {sentence}" for sentence in about.uses]
        lines += [f"  read {count.read} of {count.there} {count.what}" for count in about.counts]
        lines += [f"  not used: {sentence}" for sentence in about.unused]
        if (told := lengths(about)) is not None:
            lines.append(f"  {told}")
        if missing := [kind for kind in ("camera", "speed", "yaw rate", "ranges", "truth") if kind not in about.has]:
            lines.append(f"  not in it: {', '.join(missing)}")
        return lines


def check(recording: Recording) -> Checked:
    """Read all of it. ValueError: nothing in it can be played."""
    moments, seconds, longest = 0, 0.0, 0.0
    for moment in recording.moments():
        longest = max(longest, moment.time_s - seconds)
        moments, seconds = moments + 1, moment.time_s
    if not moments:
        told = " ".join(recording.about.problems[:2])
        raise ValueError(f"{recording.about.name}: none of its moments can be played. {told}".strip())
    return Checked(recording.about, moments, seconds, longest)
