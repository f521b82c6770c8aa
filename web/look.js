// Colours of the style sheet, for the canvases.

export function look() {
  const style = getComputedStyle(document.documentElement);
  const of = (name) => style.getPropertyValue(`--${name}`).trim();
  return {
    body: of("body"),
    joints: of("joints").split(",").map((color) => color.trim()),
    target: of("target"),
    ground: of("ground"),
    line: of("line"),
    faint: of("line"),
    soft: of("soft"),
    text: of("text"),
    shadow: Number(of("shadow")),
  };
}

export function whenLookChanges(then) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", then);
}
