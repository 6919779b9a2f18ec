from .estimates import clopper_pearson, probability, quantile
from .importance import importance
from .points import points
from .rare import subset_simulation

__all__ = ["clopper_pearson", "importance", "points", "probability", "quantile", "subset_simulation"]
