"""`python -m stiction.assessment` is `stiction map`."""

import sys

from .command import main

sys.exit(main())
