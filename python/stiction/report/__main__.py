"""``python -m stiction.report`` is `stiction report`."""

import sys

from .command import main

sys.exit(main())
