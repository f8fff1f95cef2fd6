"""Force curves of an AFM: of a surface on a cantilever, and the pull-offs of recorded ones.

`force_curve` follows a surface on a cantilever along its curves of force over separation; `Run.force_curve` does so for a patch of a result.
`pull_offs` reads files of instruments; it needs ``pip install stiction[afm]``.
"""

from .lever import force_curve
from .recorded import pull_offs

__all__ = ["force_curve", "pull_offs"]
