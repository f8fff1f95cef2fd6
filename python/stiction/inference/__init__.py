"""Inference of the parameters of a scene from measured outcomes of patches, `stiction infer`.

`infer` takes a CSV file and a scene with priors; needs ``pip install stiction[inference]``.
"""

from .posterior import Inference, infer, models, open_inference

__all__ = ["Inference", "infer", "models", "open_inference"]
