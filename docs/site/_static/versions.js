// The versions of the site lie beside each other, with versions.json above them: ["0.1.0", "latest"]. Where there is none, as in
// a folder on disk, the menu has this version alone.
document.addEventListener("DOMContentLoaded", async () => {
  const menu = document.getElementById("versions");
  if (!menu || location.protocol === "file:") return;
  const root = new URL(document.documentElement.dataset.content_root || "./", location.href);
  const here = root.pathname.split("/").filter(Boolean).pop();
  try {
    const answer = await fetch(new URL("../versions.json", root));
    if (!answer.ok) return;
    const names = await answer.json();
    menu.replaceChildren(...names.map((name) => new Option(name, name, false, name === here)));
    menu.onchange = () => { location.href = new URL(`../${menu.value}/index.html`, root); };
  } catch { /* this version alone */ }
});
