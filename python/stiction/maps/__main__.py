"""`python -m stiction.maps` is `stiction asperities`."""

import sys

from .command import main

sys.exit(main())
