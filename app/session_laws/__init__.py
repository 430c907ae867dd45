"""Laws: what is true of a whole session between two ticks, part by part. A session from a file is checked against them.

Compiled code does not check indices; it relies on these laws. Those of the brain are in `ratslam_core.laws`.
"""

from app.session_laws.session import check

__all__ = ["check"]
