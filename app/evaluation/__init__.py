"""The estimate compared with the truth, for judging and drawing. The robot never sees it."""

from app.evaluation.agreement import Coverage, Judged, align, alignment, backbone, loops_closed, observations, rmse
from app.evaluation.evaluation import Evaluation

__all__ = ["Coverage", "Evaluation", "Judged", "align", "alignment", "backbone", "loops_closed", "observations", "rmse"]
