"""What the functions raise."""


class BadInput(ValueError):
    """The program refused an option or a file; the text is its message."""


class Failed(RuntimeError):
    """The program ended without a result."""


class NotBuilt(FileNotFoundError):
    """There is no program to run."""
