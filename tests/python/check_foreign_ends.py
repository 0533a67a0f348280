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
GONE = 10  # seconds within which nothing may be left

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
        sys.stdout.buffer.write(json.dumps(describe).encode() + b"\n" + struct.pack("<4d", 0.5, 0, 1.5, 0))
        sys.stdout.flush()
        if how == "deaf":      # reads no more
            time.sleep(3600)
        if how == "shut":      # closes what it reads from
            os.close(0)
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

PLUGIN = r'''
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
static double base[4] = {0.5, 0, 1.5, 0};
const char *mpmstab_describe(const double **state)
{
  *state = base;
  return "{\"protocol\":1,\"name\":\"ends\",\"dim\":1,\"cell_width\":1.0,\"particles\":2,\"fields\":["
         "{\"name\":\"x\",\"size\":1,\"place\":true},{\"name\":\"v\",\"size\":1}],\"parameters\":{\"dt\":1.0}}";
}
int mpmstab_set(const char *name, double value) { (void)name; (void)value; return 0; }
int mpmstab_step(int steps, int64_t particles, double *state)
{
  const char *how = getenv("HOW");
  (void)steps; (void)particles; (void)state;
  if (!strcmp(how, "exit")) exit(0);
  if (!strcmp(how, "quick")) quick_exit(0);
  if (!strcmp(how, "hang")) for (;;) pause();
  return 0;
}
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
    until = time.time() + GONE
    while any(map(lives, pids())) and time.time() < until:
        time.sleep(0.05)
    left = [pid for pid in pids() if lives(pid)]
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    check(pids() and not left, f"{what}: processes {left} of {pids()} are left")


def start(how, ranks=1, timeout=60):
    pathlib.Path("pids").unlink(missing_ok=True)
    launch = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
    return subprocess.Popen([*launch, MPMSTAB, "spectrum", "-program", f"{sys.executable} waits.py {how}",
                             "-program_timeout", str(timeout)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def check_signals():
    """Whatever ends mpmstab, or mpirun, ends the program and all that it has started."""
    pathlib.Path("waits.py").write_text(PROGRAM, encoding="ascii")
    for ranks, number in ((1, signal.SIGKILL), (1, signal.SIGTERM), (1, signal.SIGINT), (1, signal.SIGSEGV),
                          (2, signal.SIGTERM), (2, signal.SIGKILL)):
        running = start("waits", ranks)
        until = time.time() + 60
        while len(pids()) < 3 * ranks and time.time() < until:
            time.sleep(0.05)
        check(len(pids()) == 3 * ranks, f"{ranks} ranks: the programs do not start")
        running.send_signal(number)
        running.communicate()
        check_gone(f"{ranks} ranks, {number.name}")


def check_waits():
    """Every wait ends with a sentence, and nothing is left."""
    for how, said in (("mute", "has not answered within 2 s (program_timeout)"),
                      ("deaf", "has not answered within 2 s (program_timeout)"),
                      ("stops", "has not answered within 2 s (program_timeout)"),
                      ("floods", "has not answered within 2 s (program_timeout)"),
                      ("shut", "has closed its standard input"),
                      ("exits", "has ended with status 0")):
        for ranks in (1, 2) if how == "exits" else (1,):
            running = start(how, ranks, 2)
            words = running.communicate(timeout=60)[1]
            check(running.returncode == 2 and words.count(said) == 1, f"{how}: status {running.returncode}, {words}")
            check_gone(how)


def check_plugin():
    """A library that ends the process, or does not come back, is named."""
    pathlib.Path("ends.c").write_text(PLUGIN, encoding="ascii")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", "libends.so", "ends.c"], check=True)
    for how, said in (("exit", "it has ended the process in one of its functions"),
                      ("quick", "it has ended the process in one of its functions"),
                      ("hang", "a function of it has not come back within 2 s (program_timeout)")):
        for ranks in (1, 2, 3) if how == "exit" else (1,):
            launch = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
            done = subprocess.run([*launch, MPMSTAB, "spectrum", "-plugin", "./libends.so", "-program_timeout", "2"],
                                  capture_output=True, text=True, check=False, timeout=60, env={**os.environ, "HOW": how})
            check(done.returncode == 2 and f"mpmstab: plugin ./libends.so: {said}\n" in done.stderr,
                  f"{how}, {ranks} ranks: status {done.returncode}, {done.stderr}")


check_signals()
check_waits()
check_plugin()
