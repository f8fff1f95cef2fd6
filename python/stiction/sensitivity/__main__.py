"""`python -m stiction.sensitivity` is `stiction sensitivity`."""

import sys

from .command import main

sys.exit(main())
