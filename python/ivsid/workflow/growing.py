"""``ivsid follow --wait``: the moments of a log that is still being written."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic, sleep
from typing import Final

from ivsid.errors import IvsidError
from ivsid.identification import Moment
from ivsid.log.growing import Growing

# Seconds between two looks at a log that is being written.
# Source: resource: a look costs some microseconds, and a reader does not see more than a few moments a second
LOOK: Final = 0.1


def watched(
    log: Growing,
    wait: float,
    latest: Callable[[], Moment | None],
    watch: Callable[[Moment], None],
    say: Callable[[str], None],
) -> None:
    """Shows a moment whenever whole lines came, until none came for a time or the user stops with Ctrl-C.

    Args:
        log: which is being written.
        wait: seconds without a new line after which it has ended.
        latest: the moment after the lines so far; None where it is not to be shown.
        watch: shown each moment.
        say: told why the lines so far are no log yet.
    """
    told = ""
    quiet = monotonic()
    try:
        while True:
            began = monotonic()
            if log.grown():
                try:
                    moment = latest()
                except IvsidError as error:
                    # A header alone is no log yet, nor are rows shorter than a window.
                    moment = None
                    if str(error) != told:
                        told = str(error)
                        say(f"waiting for more rows: {told}")
                if moment is not None:
                    watch(moment)
                quiet = monotonic()
                # Half of the time at most goes into the moments of a long log, however fast it grows.
                sleep(quiet - began)
            elif began - quiet >= wait:
                return
            else:
                sleep(min(LOOK, wait))
    except KeyboardInterrupt:
        return
