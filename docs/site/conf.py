"""Sphinx makes the site of what prepare.py puts together: `scripts/site`."""
project = "collide"
author = "the authors of collide"
html_title = "collide"

extensions = ["myst_parser", "breathe"]
myst_heading_anchors = 4  # those of GitHub
breathe_projects = {"collide": "../xml"}
breathe_default_project = "collide"
breathe_show_include = False
primary_domain = "cpp"
highlight_language = "cpp"

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["collide.css"]
html_show_sphinx = False
html_copy_source = False
html_show_copyright = False

# scripts/site --external
linkcheck_anchors = False  # GitHub's pages make theirs in the browser
linkcheck_timeout = 20
