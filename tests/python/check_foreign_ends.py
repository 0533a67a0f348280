#!/usr/bin/python3
"""Checks that a foreign code neither hangs mpmstab, nor ends it unseen, nor outlives it.

check_foreign_ends.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import os
import pathlib
import signal
import subprocess
import sys
import time

from checks import check

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
MPIEXEC, MPMSTAB = sys.argv[1:3]

# A program that notes its own process, one in its group and one in a session of its own; then it waits, or does HOW.
PROGRAM = r'''
import json, os, signal, struct, subprocess, sys, time
how = sys.argv[1]
away = subprocess.Popen(["sleep", "3600"], stdin=subprocess.DEVNULL, start_new_session=True)
beside = subprocess.Popen(["sleep", "3600"], stdin=subprocess.DEVNULL)
with open("pids", "a") as file:
    file.write(f"{os.getpid()} {away.pid} {beside.pid}\n")
describe = {"protocol": 1, "name": "waits", "dim": 1, "cell_width": 1.0, "particles": 2,
            "fields": [{"name": "x", "size": 1, "place": True}, {"name": "v", "size": 1}], "parameters": {"dt": 1.0}}
if how == "mute":
    time.sleep(3600)
for line in sys.stdin.buffer:
    ask = json.loads(line)
    if ask["do"] == "describe":
        if how == "shut":      # closes what it reads from, before the next message can be on its way
            os.close(0)
        sys.stdout.buffer.write(json.dumps(describe).encode() + b"\n" + struct.pack("<4d", 0.5, 0, 1.5, 0))
        sys.stdout.flush()
        if how == "deaf":      # reads no more
            time.sleep(3600)
        if how == "shut":
            time.sleep(3600)
        continue
    if how == "exits":
        sys.stdout.buffer.write(b"{}\n")
        sys.stdout.flush()
        os._exit(0)
    if how == "stops":
        os.kill(os.getpid(), signal.SIGSTOP)
    if how == "floods":
        while True:
            os.write(2, b"x" * 65536)
    if how == "lingers" and ask["do"] == "quit":
        time.sleep(3600)
    time.sleep(3600)
'''

# A library that ends its process, waits, or crashes where HOW says; or prints, or leaves a process, and goes on.
PLUGIN = r'''
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
static double base[4] = {0.5, 0, 1.5, 0};
static void act(const char *place)
{
  const char *how = getenv("HOW"), *action = strchr(how, ':') + 1;
  if (strncmp(how, place, strlen(place))) return;
  if (!strcmp(action, "exit")) exit(0);
  if (!strcmp(action, "_exit")) _exit(0);
  if (!strcmp(action, "quick")) quick_exit(0);
  if (!strcmp(action, "crash")) abort();
  if (!strcmp(action, "hang")) for (;;) pause();
  if (!strcmp(action, "prints")) (void)printf("a line that is no answer\n");
  if (!strcmp(action, "leaves") && fork() == 0) {
    FILE *file = fopen("pids", "a");
    (void)fprintf(file, "%d\n", (int)getpid());
    (void)fclose(file);
    for (;;) pause();
  }
}
__attribute__((constructor)) static void load(void) { act("load:"); }
const char *mpmstab_describe(const double **state)
{
  act("describe:");
  *state = base;
  return "{\"protocol\":1,\"name\":\"ends\",\"dim\":1,\"cell_width\":1.0,\"particles\":2,\"fields\":[\n"
         "{\"name\":\"x\",\"size\":1,\"place\":true},{\"name\":\"v\",\"size\":1}],\"parameters\":{\"dt\":1.0}}";
}
int mpmstab_set(const char *name, double value) { (void)name; (void)value; act("set:"); return 0; }
int mpmstab_step(int steps, int64_t particles, double *state)
{
  (void)steps; (void)particles; (void)state;
  act("step:");
  return !strncmp(getenv("HOW"), "error:", 6);
}
const char *mpmstab_error(void) { act("error:"); return "it was told to"; }
'''


def pids():
    """The processes that the programs have noted."""
    try:
        return [int(pid) for pid in pathlib.Path("pids").read_text(encoding="ascii").split()]
    except FileNotFoundError:
        return []


def lives(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()[0] not in "ZX"
    except FileNotFoundError:
        return False


def check_gone(what):
    until = time.time() + PATIENCE
    while any(map(lives, pids())) and time.time() < until:
        time.sleep(0.05)
    left = [pid for pid in pids() if lives(pid)]
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    check(pids() and not left, f"{what}: processes {left} of {pids()} are left")


def start(option, ranks=1, timeout=3600, how="-"):
    """Starts mpmstab with a foreign code on some ranks. Each wait of a rank may take the timeout that many times."""
    pathlib.Path("pids").unlink(missing_ok=True)
    launch = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
    return subprocess.Popen([*launch, MPMSTAB, "spectrum", *option, "-program_timeout", str(timeout)],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, "HOW": how})


def end_of(running, what):
    """Status, report and messages."""
    try:
        report, words = running.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        running.kill()
        check(False, f"{what}: mpmstab does not end within {PATIENCE:g} s")
    return running.returncode, report, words


def program(how):
    return ["-program", f"{sys.executable} waits.py {how}"]


def started(ranks=1):
    """mpmstab with programs that wait, and all of them running."""
    running = start(program("waits"), ranks)
    until = time.time() + PATIENCE
    while len(pids()) < 3 * ranks and time.time() < until:
        time.sleep(0.05)
    check(len(pids()) == 3 * ranks, f"{ranks} ranks: the programs do not start")
    return running


def measure():
    """Seconds that this machine, as busy as it is, needs to start mpmstab with a program that ends at once."""
    begin = time.time()
    end_of(start(program("exits")), "exits")
    check_gone("exits")
    return time.time() - begin


def check_signals():
    """Whatever ends mpmstab, or mpirun, ends the program and all that it has started."""
    for ranks, number in ((1, signal.SIGKILL), (1, signal.SIGTERM), (1, signal.SIGINT), (1, signal.SIGSEGV),
                          (2, signal.SIGTERM), (2, signal.SIGKILL)):
        running = started(ranks)
        running.send_signal(number)
        end_of(running, number.name)
        check_gone(f"{ranks} ranks, {number.name}")


def check_all_of_a_name():
    """So does a signal to all processes of mpmstab's name, as pkill sends it, and one to its children alone."""
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGKILL):
        for alone in (False, True) if number != signal.SIGKILL else (False,):
            running = started()
            own = pathlib.Path(f"/proc/{running.pid}/comm").read_text(encoding="ascii")
            children = [int(pid) for pid in pathlib.Path(f"/proc/{running.pid}/task/{running.pid}/children").read_text(
                encoding="ascii").split()]
            for pid in children:
                if alone or number != signal.SIGKILL or pathlib.Path(f"/proc/{pid}/comm").read_text(encoding="ascii") == own:
                    os.kill(pid, number)
            if not alone:
                running.send_signal(number)
            end_of(running, number.name)
            check_gone(f"{number.name} to children{'' if alone else ' and mpmstab'}")


def check_waits():
    """Every wait ends with a sentence, and nothing is left."""
    for how, said in (("mute", LATE), ("deaf", LATE), ("stops", LATE), ("floods", LATE),
                      ("shut", "has closed its standard input"),
                      ("exits", "has ended with status 0")):
        for ranks in (1, 2) if how == "exits" else (1,):
            status, _, words = end_of(start(program(how), ranks, BOUND), how)
            check(status == 2 and words.count(said) == 1, f"{how}: status {status}, {words}")
            check_gone(how)


def check_plugin():
    """A library that ends its process, or does not come back, wherever it does, is named, and leaves nothing."""
    pathlib.Path("ends.c").write_text(PLUGIN, encoding="ascii")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", "libends.so", "ends.c"], check=True)
    for how, said in (("step:exit", ENDED), ("step:_exit", ENDED), ("step:quick", ENDED), ("step:hang", LATE),
                      ("step:crash", "was ended by signal 6 (Aborted)"),
                      ("load:exit", ENDED), ("load:_exit", ENDED), ("load:hang", LATE),
                      ("describe:_exit", ENDED), ("describe:hang", LATE), ("set:_exit", ENDED), ("set:hang", LATE),
                      ("error:exit", ENDED), ("error:_exit", ENDED), ("error:hang", LATE)):
        for ranks in (1, 3) if how == "step:exit" else (1,):
            plugin = ["-plugin", "./libends.so", "-program_set", "dt=2"]
            status, _, words = end_of(start(plugin, ranks, BOUND, how), how)
            check(status == 2 and words.count(f"mpmstab: plugin ./libends.so: the library {said}\n") == 1,
                  f"{how}, {ranks} ranks: status {status}, {words}")
    for how, said in (("error:says", "mpmstab: plugin ./libends.so: step: it was told to\n"), ("step:prints", ""),
                      ("load:leaves", "")):
        status, report, words = end_of(start(["-plugin", "./libends.so"], 1, BOUND, how), how)
        check(status == (2 if said else 0) and words == said and "a line" not in report,
              f"{how}: status {status}, {report}{words}")
        if how == "load:leaves":
            check_gone(how)


pathlib.Path("waits.py").write_text(PROGRAM, encoding="ascii")
PATIENCE = 60
BOUND = round(max(1.0, 4 * measure()), 3)  # of a wait that ends in time; each of the others takes as long as this
PATIENCE = 10 + 20 * BOUND
LATE, ENDED = f"has not answered within {BOUND:g} s (program_timeout)", "has ended with status 0"
check_signals()
check_all_of_a_name()
check_waits()
check_plugin()
