"""Draws how fast waves along x decay, and how far their frequency is off, over their length."""
import numpy

import picture_files as files
import picture_scenes as scenes
import picture_style as style

MADE_BY = "symbol -damping -output"


def damping(path):
    """Draws decay per unit of time and the error of the frequency over the wavelength, for each Courant number."""
    with files.open_hdf5(path) as file:
        scene = scenes.attributes(file)
        lengths, courants, decay, error = (files.array(file, f"symbol/damping_{name}", MADE_BY)
                                           for name in ("wavelength", "courant", "decay", "frequency_error"))
    shape = (len(courants), len(lengths))
    if any(numpy.size(values) != shape[0] * shape[1] for values in (decay, error)):
        files.refuse(path, f"/symbol/damping_decay has the shape {decay.shape}, not {shape}",
                     f"a file that 'mpmstab {MADE_BY}' has written")
    figure = style.new_figure(6.2, scenes.scene_text(scene))
    above, below = figure.subplots(2, sharex=True)
    for number, (courant, rates, errors) in enumerate(zip(courants, decay.reshape(shape), error.reshape(shape))):
        look = {"color": style.COLOURS[number % len(style.COLOURS)], "marker": style.MARKERS[number % len(style.MARKERS)]}
        for rate, gid, fill, line in ((rates, "decays", look["color"], "-"), (-rates, "grows", "none", ":")):
            shown = numpy.where(rate > 1e-12, rate, numpy.nan)  # less is rounding
            if numpy.isfinite(shown).any():
                above.plot(lengths, shown, gid=gid, linestyle=line, markerfacecolor=fill, **look)
        below.plot(lengths, errors, gid="error", label=f"k = {courant:.6g}", **look)
    above.set_title("decay of waves along x (hollow, dotted: growth)")
    above.set_ylabel("decay rate r (c / h),\namplitude $e^{-rt}$")
    if any(line.get_gid() for line in above.lines):
        above.set_yscale("log")
        style.plain_powers(above.yaxis)
    else:
        above.text(0.5, 0.5, "no wave decays or grows by more than rounding", ha="center", transform=above.transAxes)
        above.set_yticks([])
    below.set_title("error of their frequency")
    below.set_ylabel("frequency error\nω h / (c |β|) − 1")
    below.set_xscale("log")
    below.set_xlabel("wavelength 2π / β (cells)")
    marks = [length for length in (3, 4, 6, 8, 12, 16, 24, 32, 64, 128, 256) if lengths.min() <= length <= lengths.max()]
    below.set_xticks(marks, labels=map(str, marks))
    below.minorticks_off()
    for axes in (above, below):
        axes.grid(True, alpha=0.3)
    below.legend(ncol=2)
    return figure
