"""``python -m stiction.lab`` is `stiction lab`."""

import sys

from .command import main

sys.exit(main())
