"""Inference of the parameters of a scene from measured outcomes of patches, `stiction infer`.

`infer` takes a CSV file and a scene with priors, `calibrate` measures how often its intervals contain the truth; needs ``pip install stiction[inference]``.
"""

from .calibrated import Calibration, open_calibration
from .calibration import calibrate
from .found import Inference, models, open_inference
from .posterior import infer

__all__ = ["Calibration", "Inference", "calibrate", "infer", "models", "open_calibration", "open_inference"]
