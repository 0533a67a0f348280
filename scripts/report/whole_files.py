"""Writes files that appear whole or not at all, and says why a file cannot be read or replaced.

It depends on nothing of this project, so that the pictures can be drawn wherever their files are.
"""
import contextlib
import os
import secrets
import stat


def fault_of(path):
    """Returns in words why a file cannot be read from its beginning to its end, or None when it can.

    A pipe would wait for a writer and some devices have no end, so only regular files are read.
    """
    try:
        mode = os.stat(path).st_mode
    except OSError as error:
        return error.strerror.lower()
    if not stat.S_ISREG(mode):
        return "is a folder" if stat.S_ISDIR(mode) else "is not a regular file"
    return None if os.access(path, os.R_OK) else "permission denied"


def fault_of_outputs(outputs, inputs=()):
    """Returns in words why files must not be written, or None.

    A file that is also read, by this name or through a link, is not replaced, nor what is not a regular file.
    """
    for path in filter(os.path.exists, outputs):
        if not os.path.isfile(path):
            return (f"{path}: is {'a folder' if os.path.isdir(path) else 'not a regular file'}; "
                    "allowed: a new file, or a regular file that is to be replaced")
        for other in filter(os.path.exists, inputs):
            if os.path.samefile(path, other):
                return f"{path}: would replace the input {other}; allowed: another file"
    return None


def write_whole(path, content):
    """Writes a file of text or bytes, which appears whole or not at all; an error names it.

    It is written aside under a name that nobody else has, and then takes its place.
    """
    aside = os.path.join(os.path.dirname(path), f"{os.getpid()}-{secrets.token_hex(8)}.part")
    made = False
    try:
        with open(aside, "xb") as file:
            made = True
            file.write(content if isinstance(content, bytes) else content.encode())
        os.replace(aside, path)
    except BaseException as error:
        if made:
            with contextlib.suppress(FileNotFoundError):
                os.remove(aside)
        if isinstance(error, OSError):
            error.filename, error.filename2 = path, None
        raise
