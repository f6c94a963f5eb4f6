"""make_notebook.py: runs the cells of tutorial.py, one after the other, and writes tutorial.ipynb with what they print and draw.

A cell begins with `# %%`; one of text with `# %% [markdown]`, its lines are comments. A cell that ends with a call of
`show(plotter)` gives a picture. It needs trimesh and pyvista, and nothing of Jupyter.
"""
import base64
import contextlib
import io
import json
import pathlib
import re

HERE = pathlib.Path(__file__).parent


def cells(text):
    for part in re.split(r"^# %%", text, flags=re.M)[1:]:
        head, _, body = part.partition("\n")
        if "[markdown]" in head:
            yield "markdown", re.sub(r"(?m)^# ?", "", body).strip()
        else:
            yield "code", body.strip()


def run(source, names, number):
    """The cell of a notebook, with what it printed and drew."""
    printed, outputs = io.StringIO(), []
    names["picture"] = None
    with contextlib.redirect_stdout(printed):
        exec(compile(source, f"cell {number}", "exec"), names)
    if printed.getvalue():
        outputs.append({"output_type": "stream", "name": "stdout", "text": printed.getvalue().splitlines(True)})
    if names["picture"]:
        data = {"image/png": base64.b64encode(names["picture"]).decode()}
        outputs.append({"output_type": "display_data", "data": data, "metadata": {}})
    return {"cell_type": "code", "execution_count": number, "metadata": {}, "outputs": outputs, "source": source.splitlines(True)}


def show(plotter):
    """Draws a scene of pyvista into the cell."""
    from PIL import Image

    file = io.BytesIO()
    picture = Image.fromarray(plotter.screenshot(return_img=True))
    picture.quantize(128).save(file, "png", optimize=True)
    names["picture"] = file.getvalue()


names = {"show": show}
made, number = [], 0
for kind, source in cells((HERE / "tutorial.py").read_text()):
    if kind == "markdown":
        made.append({"cell_type": kind, "metadata": {}, "source": source.splitlines(True)})
    else:
        number += 1
        made.append(run(source, names, number))
kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
notebook = {"cells": made, "metadata": kernel, "nbformat": 4, "nbformat_minor": 4}
(HERE / "tutorial.ipynb").write_text(json.dumps(notebook, indent=1) + "\n")
