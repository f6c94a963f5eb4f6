"""prepare.py OUT: puts together in the folder OUT what Sphinx makes the site of.

The pages of docs/ are those that one reads in the repository. Here their links are changed: one to a source file leads to a
page that shows it, one to a folder to a page that lists it, one to data to a download. The pages are arranged as NAV says.
"""
import base64
import json
import os
import pathlib
import re
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

# The navigation: parts, and their pages in this order. `*` is all pages of a folder. Pages that are in no part are for
# developers: they are below "contributing".
NAV = {
    "Use": ["install", "guide", "python", "from_open3d", "programs", "gallery"],
    "Tutorials": ["tutorials/*"],
    "Simulations": ["simulation", "units", "bodies", "granular", "ranks"],
    "Reference": ["api/index", "accuracy", "verification", "performance", "trouble", "glossary"],
    "Project": ["versions", "changelog", "contributing"],
}
# Pages that stand elsewhere in the repository.
ELSEWHERE = {"contributing": ROOT / "CONTRIBUTING.md", "changelog": ROOT / "CHANGELOG.md", "index": ROOT / "README.md",
             "measurements": ROOT / "bench" / "results" / "README.md",
             "tutorials/8-python": ROOT / "examples" / "python" / "tutorial.ipynb"}
LISTS = {DOCS / "README.md", DOCS / "index.md"}  # the navigation takes their place
CODE = {".hpp": "cpp", ".cuh": "cuda", ".cpp": "cpp", ".cu": "cuda", ".py": "python", ".cmake": "cmake", ".md": "markdown"}


def identity():
    """The project's names and addresses, and its version."""
    header = next((ROOT / "include" / "collide").rglob("version.hpp")).read_text()
    version = ".".join(re.findall(r"^#define COLLIDE_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)$", header, re.M))
    return {**json.loads((ROOT / "packaging" / "identity.json").read_text()), "version": version}


def language(path):
    """Of a file that is shown; None of data, which the site gives as a download."""
    if path.name == "CMakeLists.txt":
        return "cmake"
    if not path.suffix and path.read_bytes().startswith(b"#!"):
        return "python" if b"python" in path.read_bytes().split(b"\n")[0] else "bash"
    return CODE.get(path.suffix)


def pages():
    """The name of each page, and its file."""
    found = {path.relative_to(DOCS).with_suffix("").as_posix(): path for path in sorted(DOCS.rglob("*.md"))}
    return {name: path for name, path in {**found, **ELSEWHERE}.items() if path not in LISTS}


def notebook(path, folder, name):
    """A notebook as the text of a page; its pictures go to the folder."""
    text = ""
    for number, cell in enumerate(json.loads(path.read_text())["cells"]):
        source = "".join(cell["source"])
        text += f"{source}\n\n" if cell["cell_type"] == "markdown" else f"```python\n{source}\n```\n\n"
        for output in cell.get("outputs", []):
            if output["output_type"] == "stream":
                text += f"```text\n{''.join(output['text'])}```\n\n"
            elif "image/png" in output.get("data", {}):
                picture = folder / f"{name}-{number}.png"
                picture.parent.mkdir(parents=True, exist_ok=True)
                picture.write_bytes(base64.b64decode(output["data"]["image/png"]))
                text += f"![Drawn by the cell above]({picture.name})\n\n"
    return text


def toctree(names, options=""):
    return "\n```{toctree}\n:hidden:\n" + options + "\n" + "".join(f"{n}\n" for n in names) + "```\n"


class Site:
    def __init__(self, out):
        self.out, self.pages, self.shown, self.broken = out, pages(), set(), []
        self.names = {path: name for name, path in self.pages.items()}
        self.names.update({path: "index" for path in LISTS})

    def write(self, name, text):
        path = self.out / f"{name}.md"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def link(self, target, page, name):
        """Where a link of a page leads on the site."""
        file, hash_, anchor = target.partition("#")
        if not file or re.match(r"[a-z]+:", target):
            return target
        path = (page.parent / file).resolve()
        if path in self.names:
            there = f"{self.names[path]}.md"
        elif path.is_relative_to(DOCS / "images"):
            there = path.relative_to(DOCS).as_posix()
        elif not path.exists():
            self.broken.append(f"{page.relative_to(ROOT)}: {target} does not exist")
            return target
        elif path.is_dir() or language(path):
            there = f"{self.show(path)}.md"
        else:
            there = f"data/{path.relative_to(ROOT).as_posix()}"
            (self.out / there).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, self.out / there)
        return os.path.relpath(there, os.path.dirname(name) or ".") + hash_ + anchor

    def show(self, path):
        """Makes a page that shows a file, or lists a folder; returns its name."""
        relative = path.relative_to(ROOT).as_posix()
        name = f"source/{relative}" + ("/index" if path.is_dir() else "")
        if path in self.shown:
            return name
        self.shown.add(path)
        head = f"---\norphan: true\nnosearch: true\n---\n\n# {relative}\n\n"
        if path.is_dir():
            inside = [p for p in sorted(path.iterdir()) if not p.name.startswith((".", "__"))]
            lines = (f"- [{p.name}]({self.link(p.name, path / 'x', name)})\n" for p in inside)
            self.write(name, head + "".join(lines))
        else:
            self.write(name, f"{head}``````{{code-block}} {language(path)}\n:force:\n{path.read_text()}\n``````\n")
        return name

    def page(self, name, path):
        def outside_code(text):
            text = re.sub(r"<!--.*?-->", "", text, flags=re.S)  # one at the beginning of a line would end a paragraph
            return re.sub(r"(\]\()([^)\s]+)(\))", lambda m: m[1] + self.link(m[2], path, name) + m[3], text)
        if path.suffix == ".ipynb":
            self.write(name, notebook(path, self.out, name))
            return
        text = path.read_text().replace("```mermaid", "```text")  # which Sphinx does not draw
        text = self.doors(text) if name == "index" else text
        parts = re.split(r"(^```.*?^```$|`[^`\n]+`)", text, flags=re.M | re.S)
        text = "".join(part if i % 2 else outside_code(part) for i, part in enumerate(parts))
        if name == "index":
            text += self.navigation()
        elif name == "contributing":
            text += self.for_developers()
        elif name == "api/index":
            text += toctree(re.findall(r"^\| \[.*?\]\((\w+)\.md\)", text, flags=re.M))
        self.write(name, text)

    def part(self, entries):
        return [n for e in entries for n in (sorted(self.pages) if e.endswith("*") else [e])
                if n in self.pages and (n == e or (e.endswith("*") and n.startswith(e[:-1])))]

    def navigation(self):
        parts = {caption: self.part(entries) for caption, entries in NAV.items()}
        return "".join(toctree(names, f":caption: {caption}\n") for caption, names in parts.items() if names)

    def for_developers(self):
        users = {"index", *(n for entries in NAV.values() for n in self.part(entries))}
        return toctree(sorted(n for n in set(self.pages) - users if not n.startswith("api/")))

    def doors(self, text):
        """The list after the first picture of the README, an entry for each kind of user, as doors of the landing page."""
        entries = re.search(r"(?:^- \*\*.*\n(?:  .*\n)*)+", text, re.M)
        doors = ""
        for title, words, link, target in re.findall(r"- \*\*(.*?):\*\* (.*?)\s+Start with\s+\[(.*?)\]\((.*?)\)\.\n", entries[0], re.S):
            words = re.sub(r"\[(.*?)\]\(.*?\)", r"\1", " ".join(words.split()))
            words, link = (text[0].upper() + text[1:] for text in (words, " ".join(link.split())))
            doors += (f'<a class="door" href="{target.removeprefix("docs/").removesuffix(".md")}.html"><strong>{title}</strong>{words}'
                      f"<em>{link} →</em></a>\n")
        if doors.count("door") != 3:
            sys.exit("docs/site/prepare.py: the README has not three entries that say where to start")
        return text[:entries.start()] + f'<div class="doors">\n{doors}</div>\n\n' + text[entries.end():]

    def make(self):
        for name, path in self.pages.items():
            self.page(name, path)
        for folder in (DOCS / "images", DOCS / "site" / "_static"):
            shutil.copytree(folder, self.out / folder.name, dirs_exist_ok=True)
        shutil.copytree(DOCS / "site" / "_templates", self.out / "_templates", dirs_exist_ok=True)
        for file in ("conf.py", "pictures.py"):
            shutil.copy(DOCS / "site" / file, self.out)
        (self.out / "identity.json").write_text(json.dumps(identity()))
        if self.broken:
            sys.exit("\n".join(self.broken))


if __name__ == "__main__":
    Site(pathlib.Path(sys.argv[1]).resolve()).make()
