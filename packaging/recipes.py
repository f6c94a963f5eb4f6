"""recipes.py ARCHIVE VERSION OUT: the recipes of vcpkg and Spack for a release, with the hashes of its archive of sources.

The recipes of this folder take the sources of the tree that they lie in; those in OUT take the archive from the release's page,
and are what the registries of vcpkg and Spack get.
"""
import hashlib
import json
import pathlib
import re
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent


def main(archive, version, out):
    data, out = pathlib.Path(archive).read_bytes(), pathlib.Path(out)
    url = f"{json.loads((HERE / 'identity.json').read_text())['repository']}/releases/download/v{version}/{pathlib.Path(archive).name}"
    shutil.rmtree(out, ignore_errors=True)

    port = out / "vcpkg" / "ports" / "collide"
    shutil.copytree(HERE / "vcpkg" / "collide", port)
    text = (port / "portfile.cmake").read_text()
    taken = f'''vcpkg_download_distfile(ARCHIVE
  URLS {url}
  FILENAME collide-{version}.tar.gz
  SHA512 {hashlib.sha512(data).hexdigest()})
vcpkg_extract_source_archive(SOURCE_PATH ARCHIVE ${{ARCHIVE}})
'''
    new = re.sub(r"# An overlay port.*?\nget_filename_component\(SOURCE_PATH .*?\)\n", lambda _: taken, text, flags=re.S)
    if new == text:
        sys.exit("recipes.py: the port does not say where its sources are")
    (port / "portfile.cmake").write_text(new)

    package = out / "spack" / "collide" / "package.py"
    package.parent.mkdir(parents=True)
    text = next((HERE / "spack").rglob("package.py")).read_text()
    new = re.sub(r"(    # For `spack dev-build`.*?\n)(    version\(\"main\".*?\)\n)",
                 lambda m: f'    url = "{url}"\n\n    version("{version}", sha256="{hashlib.sha256(data).hexdigest()}")\n    version("main", branch="main")\n', text)
    if new == text:
        sys.exit("recipes.py: the package of Spack has no version main")
    package.write_text(new)


if __name__ == "__main__":
    main(*sys.argv[1:])
