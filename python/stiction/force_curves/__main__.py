"""`python -m stiction.force_curves` is `stiction force-curves`."""

import sys

from .command import main

sys.exit(main())
