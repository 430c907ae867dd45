"""The estimate compared with the truth, for judging and drawing. The robot never sees it."""

from app.evaluation.alignment import align, alignment, rmse
from app.evaluation.coverage import Coverage
from app.evaluation.evaluation import Evaluation
from app.evaluation.looks import Judged, backbone, looks
from app.evaluation.loops import loops_closed

__all__ = ["Coverage", "Evaluation", "Judged", "align", "alignment", "backbone", "looks", "loops_closed", "rmse"]
