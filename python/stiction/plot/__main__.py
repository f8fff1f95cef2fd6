"""`python -m stiction.plot` is `stiction plot`."""

import sys

from .command import main

sys.exit(main())
