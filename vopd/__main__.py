"""`python -m vopd` is `vopd`."""

from vopd.cli import main

main()
