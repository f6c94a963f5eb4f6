import operator


class Error(RuntimeError):
    """What the library throws: bad input that only it can see, and calls of CUDA that fail.

    Arguments of the wrong type are a TypeError, those of a wrong shape, length or device a ValueError; both name the
    argument.
    """


def refuse(wrong, name, why, error=ValueError):
    """Raises an error that names an argument, if it is wrong."""
    if wrong:
        raise error(f"{name}: {why}")


def shown(value):
    """An argument in a message: its repr, if that is short."""
    try:
        text = repr(value)
    except Exception:  # noqa: BLE001: of a class of the user
        text = "?"
    return text if len(text) < 60 and "\n" not in text else f"{type(value).__name__}"


def whole(name, value, least=0, most=2**31 - 1):
    """An argument that is a whole number between bounds."""
    try:
        number = operator.index(value)
    except Exception:  # noqa: BLE001: arrays of several numbers have errors of their own
        raise TypeError(f"{name}: expected a whole number, got {shown(value)}") from None
    if not least <= number <= most:
        raise ValueError(f"{name}: is {shown(number)}, expected {least:,} to {most:,}")
    return number


def choice(name, value, among):
    """An argument that is one of some words."""
    if not isinstance(value, str) or value not in among:
        raise ValueError(f"{name}: is {shown(value)}, expected {', '.join(map(repr, among[:-1]))} or {among[-1]!r}")
    return value


def real(name, value):
    """An argument that is a number."""
    try:
        refuse(isinstance(value, (str, bytes, bytearray)), name, "is text")
        return float(value)
    except Exception:  # noqa: BLE001
        raise TypeError(f"{name}: expected a number, got {shown(value)}") from None
