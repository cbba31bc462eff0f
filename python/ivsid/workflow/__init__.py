"""Each command as calls in order: read, bound, compute, and put into a report. No mathematics of its own."""

from ivsid.workflow.allan import allan
from ivsid.workflow.demo import demo
from ivsid.workflow.diagnose import diagnose
from ivsid.workflow.identify import identify
from ivsid.workflow.importing import import_set
from ivsid.workflow.isolability import isolability
from ivsid.workflow.simulate import simulate
from ivsid.workflow.thrust import thrust
from ivsid.workflow.validate import validate
from ivsid.workflow.verify import verify

__all__ = [
    "allan",
    "demo",
    "diagnose",
    "identify",
    "import_set",
    "isolability",
    "simulate",
    "thrust",
    "validate",
    "verify",
]
