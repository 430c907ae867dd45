"""The estimate compared with the truth, for judging and drawing. The robot never sees it."""

from app.evaluation.alignment import align, alignment, rmse
from app.evaluation.evaluation import Evaluation

__all__ = ["Evaluation", "align", "alignment", "rmse"]
