"""Sphinx makes the site of the pages that prepare.py puts together: `scripts/site`."""
import importlib.util
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from pictures import with_sizes  # noqa: E402

IDENTITY = json.loads((HERE / "identity.json").read_text())  # prepare.py puts it here

project = "collide"
author = IDENTITY["authors"]
version = release = IDENTITY["version"]
html_title = f"collide {version}"

extensions = ["myst_parser"]
if importlib.util.find_spec("sphinx_copybutton"):  # Debian has none
    extensions.append("sphinx_copybutton")
myst_heading_anchors = 4  # as on GitHub
primary_domain = "cpp"
highlight_language = "cpp"

html_theme = "furo"
pygments_dark_style = "monokai"
html_static_path = ["_static"]
html_css_files = ["collide.css"]
html_js_files = ["versions.js"]
html_favicon = "_static/favicon.svg"
html_baseurl = IDENTITY["documentation"]
templates_path = ["_templates"]
html_sidebars = {"**": ["sidebar/brand.html", "versions.html", "sidebar/search.html", "sidebar/scroll-start.html",
                        "sidebar/navigation.html", "sidebar/scroll-end.html"]}
html_show_sphinx = False
html_copy_source = False
html_show_copyright = False

# scripts/site --external
linkcheck_anchors = False  # GitHub makes anchors in the browser
linkcheck_timeout = 20


def add_to_page(app, name, template, context, doctree):
    """Sizes of pictures, and the tags by which other sites show a link to this page. Files of the repository are hundreds of pages
    without navigation."""
    if "body" in context:
        context["body"] = with_sizes(context["body"], HERE, first_at_once=name == "index")
    picture = html_baseurl.rstrip("/") + "/_images/gallery-mill.jpg"
    tags = {"og:type": "website", "og:site_name": "collide", "og:title": context.get("title", "collide"),
            "og:description": "Contacts between millions of spheres and a triangle mesh, exact, on CPUs and NVIDIA GPUs",
            "og:image": picture, "twitter:card": "summary_large_image"}
    context["metatags"] = context.get("metatags", "") + "".join(f'<meta property="{k}" content="{v}" />\n' for k, v in tags.items())
    return "source.html" if name.startswith("source/") else None


def setup(app):
    app.connect("html-page-context", add_to_page)
