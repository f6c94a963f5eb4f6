"""publish.py: scripts/publish-site keeps the sites of other versions, replaces its own, and lists all of them, newest first."""
import json
import pathlib
import shutil
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent

with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    clone, origin, html = folder / "clone", folder / "origin", folder / "html"

    def git(*arguments, where=clone):
        return subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments], cwd=where, check=True, capture_output=True, text=True).stdout

    def shown(path):
        return git("show", f"gh-pages:{path}", where=origin)

    (clone / "scripts").mkdir(parents=True)
    for name in ("common.sh", "publish-site"):
        shutil.copy(ROOT / "scripts" / name, clone / "scripts")
    git("init", "-q", "--bare", origin)
    git("init", "-q")
    git("add", "-A")
    git("commit", "-qm", "scripts")
    git("remote", "add", "origin", origin)
    html.mkdir()
    for number, version in enumerate(("latest", "0.1.0", "0.10.0", "0.9.0", "latest")):
        (html / "index.html").write_text(f"site {number}\n")
        subprocess.run([clone / "scripts" / "publish-site", html, version], cwd=clone, check=True)
    assert json.loads(shown("versions.json")) == ["0.10.0", "0.9.0", "0.1.0", "latest"], shown("versions.json")
    assert "url=0.10.0/" in shown("index.html"), shown("index.html")
    assert [shown(f"{v}/index.html") for v in ("latest", "0.1.0", "0.9.0")] == ["site 4\n", "site 1\n", "site 3\n"]
    assert git("rev-list", "--count", "gh-pages", where=origin).strip() == "1"
