"""What is true of a whole session between two ticks, part by part. Asked of one that comes back from a file; the brain's own laws
are in `ratslam_core.laws`. Compiled code looks at no index: it relies on these.
"""

from app.session_laws.session import check

__all__ = ["check"]
