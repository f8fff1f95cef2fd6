"""Inference of the parameters of a scene from measured outcomes of patches, `stiction infer`.

`infer` takes a CSV file and a scene with priors; needs ``pip install stiction[inference]``.
"""

from .found import Inference, models, open_inference
from .posterior import infer

__all__ = ["Inference", "infer", "models", "open_inference"]
