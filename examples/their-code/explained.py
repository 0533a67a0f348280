#!/usr/bin/python3
"""Prints the table of explained.md: mls-mpm88-explained.cpp as a plugin.

explained.py [--check]

With --check it fails unless the page has each row. TAICHI_MPM_DIR names a clone of taichi_mpm; without it the script looks for
taichi_mpm in the working folder and, without --check, clones it there. The status is 77 where it is missing.
"""
import os
import subprocess

from sources import HERE, ROOT, ask, finish, folder_of, need

URL = "https://github.com/yuanming-hu/taichi_mpm"
GIVEN = 1e-4


def built(name, *flags):
    """The plugin, as a shared library."""
    subprocess.run([COMPILER, "-std=c++14", "-O2", "-fPIC", "-shared", f"-I{ROOT / 'include'}", f"-I{SOURCE}",
                    f"-I{HERE / 'taichi'}", *flags, "-o", name, HERE / "explained.cpp"], check=True)
    return ["-plugin", f"./{name}", "-tolerance", "2e-3"]


def lone():
    found = ask("critical", *built("./liblone.so", "-DSIDE=1"), "-probe", "coloured")["critical"]["critical_dt"]
    return f"| lone particle | {found:.4g} | {COURANT * found / GIVEN:.4f} | {100 * GIVEN / found:.0f}% |"


def interior():
    """The time step at which the shortest wave begins to grow, from growth at two phases in each direction."""
    plugin, low, high = built("./libinterior.so"), 1.3e-4, 1.8e-4
    while high - low > 1e-7:
        dt = (low + high) / 2
        growth = ask("symbol", *plugin, "-phases", 2, "-program_set", f"dt={dt}")["symbol"]["growth"]
        low, high = (low, dt) if growth > 1.004 else (dt, high)
    return f"| interior | {high:.3g} | {COURANT * high / GIVEN:.2f} | {100 * GIVEN / high:.0f}% |"


COMPILER = os.environ.get("CXX", "c++")
need(COMPILER)
SOURCE = folder_of("TAICHI_MPM_DIR", URL, "mls-mpm88-explained.cpp")
COURANT = (1e4 * 0.8 / (1.2 * 0.6)) ** 0.5 * GIVEN * 80  # c dt / h, with c^2 = E (1 - nu) / ((1 + nu) (1 - 2 nu))
if __name__ == "__main__":
    finish("explained.md", [interior(), lone()])
