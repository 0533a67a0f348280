"""Draws in a process of its own, since a damaged file may end the HDF5 library, and its process with it, by a signal.

That process says itself what it refuses. When a signal ends it, its parent says so in one line that names the files.
"""
import os
import signal
import sys
import tempfile
import traceback

from program import end_in_one_line, refuse, say

LONGEST = 600  # seconds; a damaged file may also keep the library busy for ever


def run_apart(work, files):
    """Calls work() in a child process and ends as that ends; returns when all went well."""
    with tempfile.TemporaryFile() as said:  # the C library writes there when it aborts
        sys.stdout.flush()
        child = os.fork()
        if not child:
            os.dup2(said.fileno(), 2)
            signal.alarm(LONGEST)
            os._exit(status_of(work))
        status = wait_for(child)
        if os.WIFSIGNALED(status):
            refuse(f"{' or '.join(files)}: {fate(os.WTERMSIG(status))}; allowed: whole files that mpmstab has written")
        said.seek(0)
        sys.stderr.write(said.read().decode(errors="replace"))
    if os.WEXITSTATUS(status):
        sys.exit(os.WEXITSTATUS(status))


def status_of(work):
    """Calls work() and returns the exit status that a script would have."""
    status = 0
    try:
        end_in_one_line(work)
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 1
    except KeyboardInterrupt:
        say("interrupted")
        status = 130
    except BaseException:  # a fault of the scripts, which is shown with its trace
        traceback.print_exc()
        status = 1
    sys.stderr.flush()
    return status


def wait_for(child):
    """Returns the status of the child. After Ctrl-C the child ends too, and removes what it has written aside."""
    try:
        return os.waitpid(child, 0)[1]
    except KeyboardInterrupt:
        os.kill(child, signal.SIGINT)
        os.waitpid(child, 0)
        raise


def fate(number):
    if number == signal.SIGALRM:
        return f"was not read and drawn within {LONGEST} s"
    return f"the process that reads it was ended by {signal.Signals(number).name}, so it is damaged"
