"""pages.py HTML: the site in this folder is whole.

Every link and picture of a page is there; pictures have a size, and all except the first of the landing page are loaded when they
come into view; the landing page has three doors, an icon and tags for other sites; PyPI's theme refers to
no path of one machine (Debian's does); all together is at most 15 MB.
"""
import pathlib
import re
import sys
import urllib.parse

MOST = 15_000_000


def problems(root):
    pages = sorted(root.rglob("*.html"))
    if len(pages) < 30:
        yield f"only {len(pages)} pages"
    ids = {}
    for page in pages:
        text = page.read_text()
        ids[page.resolve()] = set(re.findall(r'\bid="([^"]+)"', text))
    for page in pages:
        text, name = page.read_text(), page.relative_to(root)
        for attribute, target in re.findall(r'\b(href|src)="([^"]*)"', text):
            target = urllib.parse.unquote(target.split("?")[0])
            if re.match(r"[a-z]+:|//", target) or not target:
                continue
            if target.startswith("/"):
                yield f"{name}: {target} is a path of one machine"
                continue
            file, _, anchor = target.partition("#")
            there = (page.parent / file).resolve() if file else page.resolve()
            if not there.exists():
                yield f"{name}: {target} is not there"
            elif anchor and there in ids and anchor not in ids[there]:
                yield f"{name}: {target}: no such place"
        body = re.search(r"<article.*?</article>", text, re.S)
        for picture in re.findall(r"<img [^>]*>", body[0] if body else ""):
            if "width=" not in picture:
                yield f"{name}: a picture without a size: {picture}"
        lazy = [("loading=" in picture) for picture in re.findall(r"<img [^>]*>", body[0] if body else "")]
        if not all(lazy[1:] if name.as_posix() == "index.html" else lazy):
            yield f"{name}: a picture is loaded at once"
    index = (root / "index.html").read_text()
    for what, pattern, least in (("doors", r'class="door"', 3), ("og:image", r'property="og:image"', 1), ("icon", r'rel="(shortcut )?icon"', 1),
                                 ("menu of versions", r'id="versions"', 1), ("search", r'name="q"', 1)):
        if len(re.findall(pattern, index)) < least:
            yield f"index.html: there is no {what}"
    shown = re.search(r'property="og:image" content="[^"]*/(_images/[^"]+)"', index)
    if shown and not (root / shown[1]).exists():
        yield f"index.html: og:image: {shown[1]} is not there"
    for sheet in root.rglob("*.css"):
        if "url(/" in sheet.read_text() and "prefers-color-scheme" in sheet.read_text():  # PyPI's theme
            yield f"{sheet.relative_to(root)}: a path of one machine"
    size = sum(path.stat().st_size for path in root.rglob("*") if path.is_file())
    if size > MOST:
        yield f"{size / 1e6:.1f} MB: at most {MOST / 1e6:.0f}"


if __name__ == "__main__":
    found = list(problems(pathlib.Path(sys.argv[1])))
    print("\n".join(found[:40]) or "fine")
    sys.exit(bool(found))
