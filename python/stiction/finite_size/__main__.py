"""`python -m stiction.finite_size` is `stiction finite-size`."""

import sys

from .command import main

sys.exit(main())
