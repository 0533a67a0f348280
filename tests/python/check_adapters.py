#!/usr/bin/python3
"""Fills in the adapters that 'mpmstab adapter' prints, with the bar of examples/your-code, and compares the operators.

check_adapters.py CC MPMSTAB, in a folder that may be filled. It prints which languages are not there. Before it is filled in
an adapter answers nothing but an error that names the place.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys

import numpy
import scipy.io

import checks
from checks import check, forks

CC, MPMSTAB = sys.argv[1:]
ROOT = pathlib.Path(checks.ROOT)
CODE = ROOT / "examples/your-code"
FOLDERS = os.pathsep.join([str(ROOT / "scripts/python"), str(CODE)])
ENVIRONMENT = {**os.environ, "PYTHONPATH": FOLDERS, "PYTHONDONTWRITEBYTECODE": "1", "OCTAVE_PATH": str(CODE)}
PLACES = range(1, 6)

# language: file, how it is compiled, option, and what is put in the five places
C_FIELDS = '"{\\"name\\": \\"x\\", \\"size\\": 1, \\"place\\": true}, {\\"name\\": \\"v\\", \\"size\\": 1, \\"scale\\": 1}, {\\"name\\": \\"stress\\", \\"size\\": 1, \\"scale\\": 1}"'
ADAPTERS = {
    "python": ("mine.py", None, ["-program", f"{sys.executable} mine.py"], [
        "import bar; state = {name: numpy.zeros(1) for name in bar.start(0)}", "cell_width = bar.H", 'parameters = {"dt": bar.DT}',
        'fields = {"x": {"place": True}, "v": {"scale": 1}, "stress": {"scale": 1}}', "step = bar.advance"]),
    "octave": ("mine.m", None, ["-program", "octave-cli -q mine.m"], [
        "state = struct('x', 0, 'v', 0, 'stress', 0);",
        "about = struct('cell_width', 1 / 16, 'scenes', true, 'name', 'mine');", "about.parameters = struct('dt', 1 / 32);",
        "[about.place, about.scale] = deal('x', struct('v', 1, 'stress', 1));",
        "function s = one(s, p), [s.x, s.v, s.stress] = advance(s.x, s.v, s.stress, 1 / 16, p.dt); end\nstep = @one;"]),
    "c": ("mine.c", [CC, "-std=c11", "-Wall", "-Wextra", "-Werror", "-fPIC", "-shared", "-o", "libmine_c.so", "mine.c", "-lm"], ["-plugin", "./libmine_c.so"], [
        '#define start start_of_bar\n#define advance advance_of_bar\n#define p bar\n#define dt dt_of_bar\n#include "bar.h"\n#undef start\n#undef advance\n#undef p\n#undef dt',
        f"static const char fields[] = {C_FIELDS};", "enum { DIM = 1 };\nstatic const double cell_width = 0.0625;", "static double dt = 1.0 / 32;",
        "static int rest(Particle *p, const double place[], double volume, double mass) { (void)volume, (void)mass, (void)start_of_bar; *p = (Particle){place[0], 0, 0}; return 0; }\n"
        "static int advance(Particle p[], int64_t n) { if (n != PARTICLES || period[0] != 1) return 1; memcpy(bar, p, sizeof bar); dt_of_bar = dt; advance_of_bar(dt_of_bar); memcpy(p, bar, sizeof bar); return 0; }"]),
    "fortran": ("mine.f90", ["gfortran", "-Wall", "-fPIC", "-shared", "-o", "libmine_f.so", CODE / "bar.f90", "mine.f90"], ["-plugin", "./libmine_f.so"], [
        "integer, parameter :: numbers = 3",
        'character(*), parameter :: fields = \'{"name": "x", "size": 1, "place": true}, {"name": "v", "size": 1, "scale": 1},\'// &\n'
        '                                  \'{"name": "stress", "size": 1, "scale": 1}\'',
        "integer, parameter :: dim = 1\nreal(c_double) :: cell_width = 0.0625d0", "real(c_double) :: dt = 1d0/32",
        "subroutine rest(p, place, volume, mass, failed)\n real(c_double), intent(out) :: p(numbers)\n real(c_double), intent(in) :: place(dim), volume, mass\n integer, intent(out) :: failed\n"
        " p = 0; p(1) = place(1); failed = merge(0, 1, abs(volume - 1d0/32) < 1d-15 .and. mass == volume)\nend subroutine\n"
        "subroutine advance(p, failed)\n use bar, only: go => advance, x, v, stress, dt_of_bar => dt\n real(c_double), intent(inout) :: p(:, :)\n integer, intent(out) :: failed\n"
        " x = p(1, :); v = p(2, :); stress = p(3, :); dt_of_bar = dt; call go()\n p(1, :) = x; p(2, :) = v; p(3, :) = stress; failed = 0\nend subroutine"]),
    "javascript": ("mine.js", None, ["-program", "node mine.js"], [
        "const rest = { x: [0], v: [0], stress: [0] };", "const grid = { dim: 1, cell_width: 1 / 16 };", "const parameters = { dt: 1 / 32 };",
        "const roles = { place: 'x' };",
        """function step(s, { dt }) {
  const cells = 16, h = 1 / cells, mass = Array(cells).fill(0), momentum = Array(cells).fill(0), force = Array(cells).fill(0);
  const visit = (p, f) => { const c = Math.floor(s.x[p][0] / h), w = s.x[p][0] / h - c, a = (c + cells) % cells; f(a, 1 - w, -1 / h); f((a + 1) % cells, w, 1 / h); };
  for (const p in s.x) visit(p, (i, w, g) => { mass[i] += w * h / 2; momentum[i] += w * h / 2 * s.v[p][0]; force[i] -= g * h / 2 * s.stress[p][0]; });
  console.log('a line that is no answer');
  for (const p in s.x) {
    let [dv, dx, ds] = [0, 0, 0];
    visit(p, (i, w, g) => { const v = (momentum[i] + dt * force[i]) / mass[i]; dv += dt * w * force[i] / mass[i]; ds += dt * g * v; dx += dt * w * v; });
    s.v[p][0] += dv; s.stress[p][0] += ds; s.x[p][0] += dx - Math.floor(s.x[p][0] + dx);
  }
}"""]),
}
INTERPRETERS = {"python": sys.executable, "octave": "octave-cli", "c": CC, "fortran": "gfortran", "javascript": "node", "julia": "julia"}


def ran(*words, fails=False):
    """Runs a command. Returns what it prints: to standard error, if it is to fail."""
    done = forks.run([str(word) for word in words], capture_output=True, text=True, check=False, env=ENVIRONMENT)
    check((done.returncode != 0) == fails, f"{' '.join(map(str, words))}: {done.returncode}, {done.stderr[-1000:]}")
    return done.stderr if fails else done.stdout


def filled(text, places):
    """An adapter with these in its places: what follows a line with FILL, as far as an empty line."""
    parts, lines = [], iter(text.splitlines())
    for line in lines:
        parts.append(line)
        if " FILL " in line and line.lstrip()[:1] in "#%/!":
            number = int(line.split(" FILL ")[1][0])
            parts.append(places[number - 1])
            for line in lines:
                if not line.strip():
                    break
            parts.append("")
    return "\n".join(parts) + "\n"


def check_language(language, expected):
    path, compiler, option, places = ADAPTERS[language]
    text = ran(MPMSTAB, "adapter", language)
    found = [n for n in PLACES if f" FILL {n}: " in text]
    check(found == list(PLACES), f"{language}: places {found}, expected {list(PLACES)}")
    for to, said in ((text, "FILL 5"), (filled(text, places), None)):
        pathlib.Path(path).write_text(to, encoding="utf-8")
        if compiler:
            ran(*compiler, *([f"-I{CODE}"] if language == "c" else []))
        words = [MPMSTAB, "spectrum", *option, "-program_scene", "cells=16", "-write_matrix", "probed.mtx"]
        if said:
            check(said in ran(*words, fails=True), f"{language}: an adapter that is not filled in does not name the place")
        else:
            ran(*words, "-expect", "stable")
    matrix = scipy.io.mmread("probed.mtx").toarray()
    check(matrix.shape == expected.shape, f"{language}: {matrix.shape}, expected {expected.shape}")
    apart = numpy.max(numpy.abs(matrix - expected))
    check(apart <= 1e-9, f"{language}: the operator of the filled adapter is apart by {apart:.2g}, allowed 1e-9")
    check_batch(language, [MPMSTAB, "plugin-host", option[1]] if option[0] == "-plugin" else option[1].split())


def check_batch(language, command):
    """Two states in one request give what a request for each gives. Only the adapter of the page alone has particles of its own."""
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**ENVIRONMENT, "MPMSTAB_ASKS": "1"}) as code:
        def ask(message, numbers=0, *states):
            code.stdin.write(json.dumps(message).encode() + b"\n" + b"".join(state.tobytes() for state in states))
            code.stdin.flush()
            head = json.loads(code.stdout.readline())
            check("error" not in head and "failure" not in head, f"{language}: {head}")
            return head, numpy.frombuffer(code.stdout.read(8 * numbers))

        head, base = ask({"do": "describe"}, 0 if language in ADAPTERS else 3 * 32)
        if language in ADAPTERS:
            check(head["scenes"] and "particles" not in head, f"{language}: {head}")
            given = numpy.stack([(numpy.arange(32) + 0.5) / 32, numpy.full(32, 1 / 32), numpy.full(32, 1 / 32)], 1)
            base = ask({"do": "scene", "particles": 32, "cell_width": 1 / 16, "periodic": [1.0]}, 3 * 32, given)[1]
            check(numpy.array_equal(base.reshape(32, 3), given * [1, 0, 0]), f"{language}: the state of a scene")
        check(head.get("batch", 1) >= 2, f"{language}: takes no two states in one request: {head}")
        other = base + 1e-3 * numpy.sin(numpy.arange(base.size))
        each = [ask({"do": "step", "steps": 2}, base.size, state)[1] for state in (base, other)]
        both = ask({"do": "step", "steps": 2, "states": 2}, 2 * base.size, base, other)[1]
        check(numpy.array_equal(both, numpy.concatenate(each)), f"{language}: two states in one request are not one each")
        check(not numpy.array_equal(each[0], each[1]), f"{language}: nothing changes")
        code.stdin.write(b'{"do":"quit"}\n')
        code.stdin.close()


def check_page_alone(expected):
    """An adapter that was written from the page alone, in a language without a kit."""
    code = f"perl {ROOT}/tests/python/program_bar.pl"
    ran(MPMSTAB, "spectrum", "-program", code, "-write_matrix", "perl.mtx", "-expect", "stable")
    apart = numpy.max(numpy.abs(scipy.io.mmread("perl.mtx").toarray() - expected))
    check(apart <= 1e-9, f"Perl: the operator is apart by {apart:.2g}, allowed 1e-9")
    check_batch("Perl", code.split())


def main():
    ran(MPMSTAB, "spectrum", "-formulation", "usl", "-cells", 16, "-courant", 0.5, "-write_matrix", "own.mtx")
    expected = scipy.io.mmread("own.mtx").toarray()
    pathlib.Path("mpmstab_serve.m").write_text(ran(MPMSTAB, "adapter", "mpmstab_serve.m"), encoding="utf-8")
    for language, interpreter in INTERPRETERS.items():
        if not shutil.which(interpreter) or language not in ADAPTERS:
            print(f"{language}: not checked, since {interpreter} is not there" if not shutil.which(interpreter) else f"{language}: nobody has filled it in here yet")
            continue
        check_language(language, expected)
        print(f"{language}: the operator of the filled adapter is that of usl")
    if subprocess.run(["perl", "-MJSON::PP", "-e", "1"], check=False, stderr=subprocess.DEVNULL).returncode == 0:
        check_page_alone(expected)
    else:
        print("Perl, or its module JSON::PP, is not there: the adapter from the page alone is not run")
    said = ran(MPMSTAB, "adapter", "pyton", fails=True)
    check("did you mean python?" in said, f"an unknown language: {said}")


if __name__ == "__main__":
    main()
