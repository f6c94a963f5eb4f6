"""check.py code|links|examples|glossary|members|english|numbers|lines: the README, the pages below docs/ and what they promise.

code      The first block of C++ in the README is examples/minimal.cpp, and every other block of C++ or Python stands word for word in
          the file that the comment before it names (`<!-- from: FILE -->`). Pages that teach have no other C++.
links     Every link to a file or a heading of this repository leads somewhere.
examples  Every program of examples/ is mentioned in some page.
glossary  Each name in docs/glossary.md and docs/development/words.md is in the code of the file, or folder, that it is said to be in;
          words are in order. So is each name of the table of headers in docs/install.md; each effect of docs/simulation.md has a header
          of its own name, or is in the page's table of other headers.
members   The tables of members in docs/guide.md have all that the headers have, and nothing else; the pages of docs/api/
          are as scripts/members writes them.
english   Pages have none of the words of FOREIGN, and no line of text longer than LONGEST; the README is short; no docstring of include/ begins with
          a word of FOREIGN_BEGINNINGS, which name nothing, and no comment there says "but for". No sentence of a user's page begins with a word of NAMELESS, except a question.
numbers   Times, rates, percentages and gigabytes in prose of MEASURED are numbers that bench/report has written.
lines     The Python package has no more than PACKAGE_LINES lines of C++ and Python that are no blanks, comments or docstrings.
          `check.py lines each` prints those of each file.
"""
import ast
import io
import pathlib
import re
import subprocess
import sys
import tokenize

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PAGES = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "bench/results/README.md")] + sorted((ROOT / "docs").rglob("*.md"))


# Pages in which every piece of C++ is from a program that tests run.
TAUGHT = [ROOT / "README.md", *(ROOT / "docs" / f"{name}.md" for name in ("guide", "simulation", "bodies")),
          *(ROOT / "docs" / "tutorials").glob("*.md")]

# Pages in which no one writes measured numbers by hand.
MEASURED = [ROOT / "README.md", *(ROOT / "docs" / f"{name}.md" for name in ("performance", "accuracy", "verification", "simulation", "bodies",
            "granular", "guide", "ranks", "gallery", "install", "python"))]

# Words that readers of English do not use for what is meant, and what to write instead. Patterns, in any case.
FOREIGN = {
    r"verdicts?": "result",
    r"(on|along) (its|their) ways?": "on its path, in flight",
    r"the way of": "data flow, path",
    r"anew": "again",
    r"dear(er)?": "expensive",
    r"sorted out": "culled, rejected",
    r"lets? through": "accept",
    r"(are|is|be|were) told": "given",
    r"told apart": "distinguished",
    r"hands? (it|them|each|all|every)\b.* to": "pass, report",
    r"balls?": "sphere, particle",
    r"wanted": "target",
    r"promised?": "guarantee, target",
    r"at hand": "available",
    r"(are|is) at work": "run, are resident",
    r"processors": "streaming multiprocessors, cores",
    r"statical": "static",
    r"spheres that (move|rest)": "moving spheres, static spheres",
    r"brings? about": "cause",
    r"the same holds": "likewise",
    r"invented": "false positives",
    r"us\b(?= (a|each|of|for|per|in|on) )|(?<=\d )us": "µs",
    r"times the floor": "times the bandwidth bound",
    r"some \d[\d,.]*": "about",
    r"open pairs": "uncertain pairs",
    r"lists? of neighbours": "neighbour list",
    r"lanes?": "thread",
    r"made anew": "rebuilt",
    r"but for": "except for",
}
LONGEST = 120
README_WORDS = 850
USER_WORDS = 25_000     # all pages of docs/ except api/ and development/
PACKAGE_LINES = 2_881
CHANGELOG_LINES = 60  # before the first release: its head says what its lines are

# A sentence names its subject: none of these stands at its beginning.
NAMELESS = r"(What|That|Those|Whoever)\b"

# Docstrings name what follows: "The result of ...", and not "What ... gives".
FOREIGN_BEGINNINGS = r"(What|Where|Of)\b"


def without_code(text):
    return re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)


def code():
    for page in PAGES:
        text = page.read_text()
        for match in re.finditer(r"^(?:<!-- from: (\S+) -->\n)?```(?:cpp|python)\n(.*?)^```", text, flags=re.M | re.S):
            source = match[1] or ("examples/minimal.cpp" if page.name == "README.md" and page.parent == ROOT else None)
            line = text.count("\n", 0, match.start()) + 1
            if source is None:
                yield f"{page}:{line}: code that is from no file"
            elif match[1] is None and match[2] != (ROOT / source).read_text():
                yield f"{page}:{line}: not {source}"
            elif match[2] not in (ROOT / source).read_text():
                yield f"{page}:{line}: does not stand in {source}"
        if page in TAUGHT:
            outside = re.sub(r"^```.*?^```", lambda m: "\n" * m[0].count("\n"), text, flags=re.M | re.S)
            yield from (f"{page}:{line}: code that no test runs" for line, words in enumerate(outside.splitlines(), 1)
                        if re.match(r"    \S.*[;{]$", words))
    if "```cpp" not in (ROOT / "README.md").read_text():
        yield "README.md shows no code"


def anchors(page):
    headings = re.findall(r"^#+ +(.*?) *$", without_code(page.read_text()), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", h.lower()).replace(" ", "-") for h in headings}


def links():
    for page in PAGES:
        for target in re.findall(r"\]\(([^)\s]+)\)", without_code(page.read_text())):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = target.partition("#")
            path = (page.parent / name).resolve() if name else page
            if not path.exists():
                yield f"{page}: {target} does not exist"
            elif anchor and anchor not in anchors(path):
                yield f"{page}: {target}: there is no such heading"


def examples():
    text = "".join(page.read_text() for page in PAGES)
    for program in sorted([*(ROOT / "examples").glob("*.cpp"), *(ROOT / "examples" / "tutorials").glob("*.cpp"),
                           *(ROOT / "examples" / "python").glob("*.py")]):
        if program.name not in text and f"`{program.stem}`" not in text:
            yield f"no page mentions {program.relative_to(ROOT)}"
    for source in sorted((ROOT / "examples").rglob("*.?pp")):
        if re.search(r"collide(::|/)detail", source.read_text()):
            yield f"{source}: uses what may change at any time"


def glossary():
    for page, least in (("glossary.md", 15), ("development/words.md", 15)):
        yield from words_of(ROOT / "docs" / page, least)
    yield from headers_of(ROOT / "docs" / "install.md", 15)
    yield from effects_of(ROOT / "docs" / "simulation.md", 20)


def declares(header, name):
    return header.is_file() and re.search(rf"\b{name}\b", re.sub(r"//.*", "", header.read_text()))


def headers_of(page, least):
    rows = re.findall(r"^\| (`.+`) \| `([\w/]+\.\w+)` \|$", page.read_text(), flags=re.M)
    if len(rows) < least:
        yield f"{page}: only {len(rows)} rows of headers"
    for names, header in rows:
        for name in re.findall(r"`(\w+)`", names):
            if not declares(ROOT / "include" / "collide" / header, name):
                yield f"{page}: there is no {name} in {header}"


def effects_of(page, least):
    text = page.read_text()
    table = re.search(r"^\| effect \|.*?\n\n", text, flags=re.M | re.S)[0]
    effects = [name for cell in re.findall(r"^\| (`.+?) \|", table, flags=re.M) for name in re.findall(r"`(\w+)", cell)]
    elsewhere = {name: header for names, header in re.findall(r"^\| (`\w+`(?:, `\w+`)*) \| `collide/([\w/]+\.\w+)` \|$", text, flags=re.M)
                 for name in re.findall(r"`(\w+)`", names)}
    if len(effects) < least:
        yield f"{page}: only {len(effects)} effects"
    for name in effects:
        if not declares(ROOT / "include" / "collide" / elsewhere.get(name, f"effects/{name}.hpp"), name):
            yield f"{page}: the page does not say which header has {name}"


def words_of(page, least):
    rows = re.findall(r"^\| (.+?) \| .+ \| `(\w+)` in \[.+\]\((.+)\) \|$", page.read_text(), flags=re.M)
    words = [word.lower() for word, _, _ in rows]
    if len(rows) < least:
        yield f"{page}: only {len(rows)} words"
    yield from (f"{page}: {word} is not in alphabetic order" for word, sorted_word in zip(words, sorted(words)) if word != sorted_word)
    for word, name, target in rows:
        path = (page.parent / target).resolve()
        texts = [re.sub(r"//.*", "", p.read_text()) for p in ([path] if path.is_file() else path.rglob("*.*"))]
        if not any(re.search(rf"\b{name}\b", text) for text in texts):
            yield f"{page}: {word}: there is no {name} in {target}"


def members_of(name):
    """The functions without arguments and the data of a public class, those of its bases in sinks/detail/ included."""
    for header in sorted((ROOT / "include" / "collide").rglob("*.hpp")):
        found = re.search(rf"^(class|struct) {name}\b(?: : public ([^{{]*))?\s*\{{(.*?)^\}};|^class {name}\s*: public ([^{{]*)\{{",
                          header.read_text(), flags=re.M | re.S)
        if not found:
            continue
        body = re.split(r"^ (?:private|protected):", found[3] or "", flags=re.M)[0]
        own = {f"{n}()" for n in re.findall(r"^  .*\b(\w+)\(\) const\b", body, flags=re.M)}
        own |= set(re.findall(r"^  [\w:<>]+ (\w+); +///<", body, flags=re.M))
        bases = re.findall(r"(?:detail::)?\b(array_in_space|array_per_sphere|records|per_sphere_min)<", found[2] or found[4] or "")
        return own.union(*(members_of(base) for base in bases))
    return set()


def members():
    made = subprocess.run([sys.executable, "-B", ROOT / "scripts" / "members", "--check"], stderr=subprocess.PIPE, text=True)
    if made.returncode != 0:
        yield made.stderr.strip()
    page = ROOT / "docs" / "guide.md"
    section = page.read_text().split("The members of a sink", 1)[1].split("\n**", 1)[0]
    rows = [[re.findall(r"`([^`]+)`", cell) for cell in line.strip("|").split("|")] for line in section.splitlines() if line.startswith("| `")]
    if len(rows) < 12:
        yield f"{page}: only {len(rows)} rows of members"
    for names, *_, listed in rows:
        for name in names:
            there = members_of(name)
            yield from (f"{page}: {name}: there is no {member}" for member in listed if member not in there)
            yield from (f"{page}: {name}: {member} is not in the table" for member in sorted(there) if member not in listed)


def english():
    """All pages except the reference, without what scripts have written."""
    length = len((ROOT / "README.md").read_text().split())
    if length > README_WORDS:
        yield f"README.md has {length} words: at most {README_WORDS}, so that it is read"
    users = [p for p in PAGES if p.is_relative_to(ROOT / "docs") and not {"api", "development"} & set(p.parts)]
    words = sum(len(p.read_text().split()) for p in users)
    if words > USER_WORDS:
        yield f"docs/ has {words} words for users: at most {USER_WORDS}"
    if "\n## [0.1.0]\n" in (changelog := (ROOT / "CHANGELOG.md").read_text()) and changelog.count("\n") > CHANGELOG_LINES:
        yield f"CHANGELOG.md has {changelog.count(chr(10))} lines: at most {CHANGELOG_LINES} before the first release"
    for page in [ROOT / "README.md", *users]:
        text = re.sub(r"<!-- table: .*?<!-- end -->|^```.*?^```|^    .*?$", lambda m: "\n" * m[0].count("\n"), page.read_text(), flags=re.M | re.S)
        for sentence in re.finditer(rf"(?:^(?:[-*] |\d+\. |\*\*.*?\*\* )?|[.:!?] )({NAMELESS}[^.?!]*[.?!]?)", text, flags=re.M):
            before = text[:sentence.start()].rstrip(" ")
            goes_on = before.endswith("\n") and not before.endswith("\n\n") and not re.search(r"[.:!?]\s*$", before) and sentence[0][0] not in "-*"
            if not (sentence[1].endswith("?") or goes_on):
                yield f"{page}:{text.count(chr(10), 0, sentence.start(1)) + 1}: {sentence[1][:40]!r} does not name its subject"
    for page in PAGES:
        if page.parent.name == "api":
            continue
        blank = lambda match: "\n" * match[0].count("\n")
        text = re.sub(r"<!-- table: .*?<!-- end -->|^```.*?^```|<!-- [^\n]*? -->", blank, page.read_text(), flags=re.M | re.S)
        for line, words in enumerate(text.splitlines(), 1):
            if len(words) > LONGEST and not words.startswith(("|", "   |", "![", "[![", "    ")):
                yield f"{page}:{line}: {len(words)} characters in a line"
            prose = "" if words.startswith("    ") else re.sub(r"`[^`]*`|\]\([^)]*\)", "", words)
            for pattern, instead in FOREIGN.items():
                found = re.search(rf"\b({pattern})\b", prose, re.I)
                if found:
                    yield f"{page}:{line}: {found[0]!r}: write {instead}"
    for header in sorted((ROOT / "include").rglob("*.*")):
        before = ""
        for line, words in enumerate(header.read_text().splitlines(), 1):
            found = re.match(rf"\s*/// {FOREIGN_BEGINNINGS}", words)
            if found and (not re.match(r"\s*///(?!<)", before) or "\\file" in before):
                yield f"{header}:{line}: a docstring begins with {found[1]!r}: name what it is about"
            if re.search(r"\bbut for\b", words):
                yield f"{header}:{line}: 'but for': write except for"
            before = words


def numbers():
    for page in MEASURED:
        blank = lambda match: "\n" * match[0].count("\n")
        text = re.sub(r"<!-- (?:table|compile-cost|number).*?<!-- end[^>]*-->|^```.*?^```", blank, page.read_text(), flags=re.M | re.S)
        for line, words in enumerate(text.splitlines(), 1):
            for found in re.findall(r"\b\d[\d.,]* ?(?:(?:ms|µs|us|ns|ps|[GM]B(?:/s)?)\b|times as (?:long|fast|slow)|%)", words):
                yield f"{page}:{line}: {found!r} is not of bench/report"


def lines_of_python(text):
    space = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER)
    tokens = [t for t in tokenize.generate_tokens(io.StringIO(text).readline) if t.type not in space]
    lines = {line for t in tokens for line in range(t.start[0], t.end[0] + 1)}
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            lines -= set(range(node.lineno, node.end_lineno + 1))
    return len(lines)


def lines_of_cpp(text):
    text = re.sub(r'("(?:\\.|[^"\\\n])*")|//[^\n]*|/\*.*?\*/', lambda match: match[1] or "", text, flags=re.S)
    return sum(1 for line in text.splitlines() if line.strip())


def lines():
    files = sorted([*(ROOT / "python" / "package").rglob("*.py"), *(ROOT / "python" / "src").iterdir()])
    found = {path: (lines_of_python if path.suffix == ".py" else lines_of_cpp)(path.read_text()) for path in files}
    if sys.argv[2:] == ["each"]:
        print("\n".join(f"{count:5} {path.relative_to(ROOT)}" for path, count in found.items()))
    if sum(found.values()) > PACKAGE_LINES:
        yield f"python/: {sum(found.values())} lines, more than {PACKAGE_LINES}"


checks = {"lines": lines, "numbers": numbers, "english": english, "code": code, "links": links, "examples": examples, "glossary": glossary,
          "members": members}
problems = list(checks[sys.argv[1]]())
print("\n".join(problems) or "fine")
sys.exit(bool(problems))
