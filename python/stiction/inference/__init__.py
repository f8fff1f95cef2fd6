"""From measured outcomes of patches to the parameters of a scene, `stiction infer`.

`infer` takes a CSV file and a scene with priors; needs ``pip install stiction[inference]``.
"""

from .posterior import Inference, infer, models, open_inference

__all__ = ["Inference", "infer", "models", "open_inference"]
