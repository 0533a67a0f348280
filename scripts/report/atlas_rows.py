"""What the atlas asks: its rows, and the commands whose answers have the numbers of a row.

A row is a scheme (formulation, transfer, basis, gradient) in a dimension, with 2 particles a cell in each direction.
"""
import itertools
import re
import subprocess

from program import PROGRAM, refuse

GRADIENTS = ("basis", "mls")
KINDS = ("formulation", "transfer", "basis", "gradient")
COURANT = "1/2"  # at which growth and damping are taken
MACH = ("1/100", "1/10", "1/4", "1")  # velocities U0 / c
PLACES = {"bulk": "limits", "edge": "limits", "lone": "lone"}  # of limits, and the question that has them
CELLS, PERIODS = 16, 100  # of the wave whose amplitude is kept
SAME_AS = {"asflip": "aflip"}  # transfers whose linear step is that of another one, which stands for both


def words_of(kind, first=""):
    """Returns the names that the program has of a kind, or those whose description has this first word."""
    done = subprocess.run([PROGRAM, "list", kind], capture_output=True, text=True, check=False)
    found = re.findall(rf"^  (\w+) +{first}", done.stdout, flags=re.MULTILINE)
    if not found:
        refuse(f"{PROGRAM} list {kind}: lists nothing; allowed: mpmstab itself")
    return found


class Row:
    """A scheme in a dimension. Its name is that of its page."""

    def __init__(self, dim, *words):
        self.dim, self.words = dim, dict(zip(KINDS, words))
        self.name = "-".join([*words, f"{dim}d"])
        self.title = " ".join([*words[:-1], *([] if words[-1] == "basis" else words[-1:]), f"{dim}-D"])

    def is_called(self, wanted):
        """Says whether each of the wanted words, or one of those that commas separate in it, is one of the row's."""
        own = {*self.words.values(), f"{self.dim}d"}
        return all(own & set(word.split(",")) for word in wanted)

    def scheme(self):
        """Returns the options that choose the scheme; what is the default is left out."""
        words = [word for name, value in self.words.items() if (name, value) != ("gradient", "basis")
                 for word in (f"-{name}", value)]
        return [*(["-dim", str(self.dim)] if self.dim > 1 else []), *words]

    def asked(self, task, *options):
        return [task, *self.scheme(), *options]

    def questions(self):
        """Returns the commands by the name of what they answer. The first is refused where there is no such scheme."""
        waves = ",".join([str(4 * CELLS), *["2"] * (self.dim - 1)])
        found = {"limits": self.asked("critical", "-neighbourhood", "bulk,edge"),
                 "lone": self.asked("critical", "-neighbourhood", "lone"),
                 "damping": self.asked("symbol", "-courant", COURANT, "-cells", waves, "-damping", "-damping_divisors",
                                       "1,4")}
        for mach in MACH:
            along = ",".join([mach, *["0"] * (self.dim - 1)])
            found[f"moving {mach}"] = self.asked("symbol", "-courant", COURANT, "-mach", along, *WAVES[self.dim])
        if self.dim < 3:
            span, points, phases = MAPS[self.dim]
            along = ["-mach", "1,0"] if self.dim > 1 else []
            found["map"] = self.asked("map", "-map_axes", "courant,mach", *along, *span, "-map_points", points,
                                      "-phases", phases)
        return found


# By dimension: the waves of which growth is the largest. In three dimensions a refined search takes too long.
WAVES = {1: ["-refine"], 2: ["-cells", "8", "-refine"], 3: ["-cells", "6"]}
# By dimension: the ends of the axes, points, and phases of a map. In three dimensions a map takes too long.
MAPS = {1: (["-map_courant", "1/10,2", "-map_mach", "1/20,1"], "20,20", "64"),
        2: (["-map_courant", "1/10,2", "-map_mach", "1/10,1"], "20,10", "8")}


def velocity(mach):
    """Returns a velocity U0 / c as people write it: c/100."""
    return "c" if mach == "1" else f"c/{mach.split('/')[1]}"


def rows_of(dims, wanted):
    """Returns the rows that are asked for, those of few dimensions first."""
    transfers = [name for name in words_of("transfer") if name not in SAME_AS]
    words = [words_of("formulation"), transfers, words_of("basis"), GRADIENTS]
    rows = [Row(dim, *of) for dim in dims for of in itertools.product(*words)]
    return [row for row in rows if row.is_called(wanted)]
