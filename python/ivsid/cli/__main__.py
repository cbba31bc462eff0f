"""``python -m ivsid.cli``."""

from ivsid.cli.entry import main

if __name__ == "__main__":
    main()
