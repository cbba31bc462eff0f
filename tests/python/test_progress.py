"""Progress of a command: words with the time left, lines in a pipe, and one line that changes on a terminal."""

import io
import os
import pty
import re
import subprocess
import time

from command_line import COMMAND
from ivsid.cli.progress import Watch, lines


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


def test_time_left_is_the_rest_of_a_counted_step():
    clock = Clock()
    watch = Watch("diagnose", clock)
    watch("fitting the model")
    clock.now = 70.0
    assert watch.words() == "diagnose: fitting the model, 1:10"
    watch("null logs 0 of 400")
    assert watch.words() == "diagnose: null logs 0 of 400, 1:10"
    clock.now = 90.0
    watch("null logs 100 of 400")
    # A hundred in twenty seconds: three hundred are left.
    assert watch.words() == "diagnose: null logs 100 of 400, 1:30, about 1:00 left in this step"
    clock.now = 100.0
    assert watch.words() == "diagnose: null logs 100 of 400, 1:40, about 0:50 left in this step"
    watch("null logs 300 of 400: last")
    assert watch.words() == "diagnose: null logs 300 of 400: last, 1:40, about 0:10 left in this step"
    # A second count of the same words begins anew.
    watch("null logs 0 of 400")
    assert "left" not in watch.words()
    clock.now = 4000.0
    watch("drawing")
    assert watch.words() == "diagnose: drawing, 1:06:40"


def test_lines_come_at_their_rate_and_end_with_the_work():
    stream, watch = io.StringIO(), Watch("verify")
    watch("certificates 1 of 9")
    with lines(watch, stream, 0.05):
        time.sleep(0.28)
    said = stream.getvalue().splitlines()
    assert 2 <= len(said) <= 6 and all(s.startswith("ivsid verify: certificates 1 of 9, 0:0") for s in said)
    time.sleep(0.12)
    assert stream.getvalue().splitlines() == said
    quick = io.StringIO()
    with lines(watch, quick, 30.0):
        pass
    assert quick.getvalue() == ""


SLOW = """
import time
from ivsid.cli import progress
progress.EVERY = 0.1
with progress.shown("thrust", quiet=False) as told:
    for k in range(5):
        told(f"pieces {k} of 5")
        time.sleep(0.15)
print("done")
"""


def test_a_pipe_gets_plain_lines():
    made = subprocess.run([COMMAND[0], "-c", SLOW], capture_output=True, text=True, timeout=60, check=False)
    said = made.stderr.splitlines()
    assert made.returncode == 0 and made.stdout == "done\n"
    assert len(said) >= 3 and all(re.match(r"ivsid thrust: pieces \d of 5, 0:0\d", s) for s in said), said
    assert "\x1b" not in made.stderr and any("left in this step" in s for s in said)


def test_a_terminal_gets_a_line_that_changes_and_goes():
    reader, writer = pty.openpty()
    with subprocess.Popen(
        [COMMAND[0], "-c", SLOW],
        stdout=subprocess.PIPE,
        stderr=writer,
        env={**os.environ, "TERM": "xterm", "COLUMNS": "120"},
    ) as process:
        os.close(writer)
        said = b""
        while True:
            try:
                part = os.read(reader, 4096)
            except OSError:
                break
            if not part:
                break
            said += part
        out = process.stdout.read()
    os.close(reader)
    assert process.returncode == 0 and out == b"done\n"
    assert b"thrust: pieces 3 of 5" in said and b"left in this step" in said and b"\x1b[2K" in said
