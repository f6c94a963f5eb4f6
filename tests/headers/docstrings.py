"""A docstring is true alone: none begins with a word that refers to what stands before it.

Usage: docstrings.py check | self-test
"""

import pathlib
import re
import sys

INCLUDE = pathlib.Path(__file__).resolve().parents[2] / "include"
REFERS = re.compile(r"(The same|The other|The others|Then|Both|And|Also|Likewise|Ditto|As above|As before|Otherwise|These|Those"
                    r"|They|It)\b")
REFERS_AFTER_CODE = re.compile(r"(the same|then|both|and|also|likewise|ditto|as above|as before)\b", re.IGNORECASE)


def docstrings(text):
    """The line and the beginning of each docstring, and whether it stands after code."""
    inside = False
    for number, line in enumerate(text.splitlines(), 1):
        head = re.match(r"\s*///(?!<)\s?(.*)", line)
        if head and not inside:
            yield number, head[1], False
        inside = bool(head)
        after = re.search(r"\S.*///<\s?(.*)", line)  # alone in a line it goes on with the one before
        if after:
            yield number, after[1], True


def problems(name, text):
    for number, beginning, after_code in docstrings(text):
        refers = (REFERS_AFTER_CODE if after_code else REFERS).match(beginning)
        if refers:
            yield f"{name}:{number}: a docstring begins with '{refers[0]}': say what it is about"


def self_test():
    """What refers to something else is found, and nothing else is."""
    sound = ["/// The radius.\n/// The same line goes on.\nint r;", "int r;  ///< the radius", "/// Then_some.\nint r;",
             "// Then, in code.", "/// Iterators.\nint r;",
             "int r;  ///< the radius of the sphere,\n        ///< and nothing else"]
    faulty = ["/// The same, for doubles.\nint r;", "int a;\n\n  /// Both.\nint r;", "int r;  ///< and its end",
              "int r;  ///< the same", "/// Then.", "/// It is the radius.\nint r;"]
    for text in sound:
        yield from (f"found in sound text: {problem}" for problem in problems(repr(text), text))
    for text in faulty:
        if not list(problems("", text)):
            yield f"not found: {text!r}"


def check():
    for path in sorted([*INCLUDE.rglob("*.hpp"), *INCLUDE.rglob("*.cuh")]):
        yield from problems(path.relative_to(INCLUDE).as_posix(), path.read_text())


if __name__ == "__main__":
    found = list({"check": check, "self-test": self_test}[sys.argv[1]]())
    print("\n".join(found) or "fine")
    sys.exit(bool(found))
