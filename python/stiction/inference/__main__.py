"""`python -m stiction.inference` is `stiction infer`."""

import sys

from .command import main

sys.exit(main())
