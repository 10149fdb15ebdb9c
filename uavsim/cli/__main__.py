"""`python -m uavsim.cli`."""

from uavsim.cli import main

main()
