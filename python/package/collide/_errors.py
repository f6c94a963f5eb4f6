class Error(RuntimeError):
    """What the library throws: bad input that only it can see, and calls of CUDA that fail.

    Arguments of the wrong type are a TypeError, those of a wrong shape, length or device a ValueError; both name the
    argument.
    """


def refuse(wrong, name, why, error=ValueError):
    """Raises an error that names an argument, if it is wrong."""
    if wrong:
        raise error(f"{name}: {why}")
