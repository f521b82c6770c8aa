// Sliders, buttons and their values.

import { FPBM, MAN, MVN, SCHEMES, WMVN_ACCELERATION } from "./simulator.js";
import { SCHEME_WORDS } from "./words.js";

const SLIDERS = {
  damping: (value) => (value === 0 ? "off" : `${value.toFixed(1)} /s`),
  alpha: (value) => value.toFixed(2),
  feedback: (value) => (value === 0 ? "off" : `${value.toFixed(1)} /s`),
};

export const element = (id) => document.getElementById(id);

export class Controls {
  /// changed(changes): called with new settings. arm(number): called with a new arm.
  constructor({ changed, arm }) {
    this.changed = changed;
    for (const name of Object.keys(SLIDERS)) {
      element(name).addEventListener("input", (event) => this.tell({ [name]: event.target.valueAsNumber }));
    }
    element("scheme").append(...SCHEMES.map((name, i) => new Option(name, i)));
    element("scheme").addEventListener("change", (event) => this.tell({ scheme: Number(event.target.value) }));
    element("limited").addEventListener("change", (event) => this.tell({ limited: event.target.checked ? 1 : 0 }));
    for (const choice of document.getElementsByName("arm")) {
      choice.addEventListener("change", () => arm(Number(choice.value)));
    }
    element("copy").addEventListener("click", copy);
  }

  tell(changes) {
    this.changed(changes);
  }

  /// Shows the settings. dof: number of weights.
  show(settings, dof, colors) {
    for (const [name, words] of Object.entries(SLIDERS)) {
      element(name).value = settings[name];
      element(`${name}-value`).value = words(settings[name]);
    }
    element("scheme").value = settings.scheme;
    element("scheme-words").textContent = SCHEME_WORDS[settings.scheme];
    element("limited").checked = settings.limited !== 0;
    element("alpha-row").hidden = settings.scheme !== FPBM;
    element("feedback-row").hidden = settings.scheme === MAN || settings.scheme === WMVN_ACCELERATION;
    element("weights-row").hidden = settings.scheme === MVN || settings.scheme === MAN;
    element("damping").disabled = settings.scheme < MAN;
    if (settings.scheme < MAN) element("damping-value").value = "none";
    const rows = element("weights");
    if (rows.childElementCount !== dof) rows.replaceChildren(...colors.slice(0, dof).map((_, i) => this.weight(i, dof)));
    [...rows.children].forEach((row, i) => {
      row.querySelector(".swatch").style.background = colors[i];
      row.querySelector("input").value = settings.weights[i];
      row.querySelector("output").value = settings.weights[i].toFixed(1);
    });
  }

  weight(i, dof) {
    const row = document.createElement("label");
    row.className = "slider";
    row.innerHTML = `<span><i><i class="swatch"></i>joint ${i + 1}</i><output></output></span>
      <input type="range" min="0.5" max="10" step="0.5" />`;
    row.querySelector("input").addEventListener("input", () => {
      const inputs = [...row.parentElement.querySelectorAll("input")];
      this.tell({ weights: inputs.slice(0, dof).map((input) => input.valueAsNumber) });
    });
    return row;
  }
}

async function copy() {
  const button = element("copy");
  try {
    await navigator.clipboard.writeText(element("install").textContent);
    button.textContent = "Copied";
  } catch {
    getSelection().selectAllChildren(element("install")); // The page may not write to the clipboard.
    button.textContent = "Selected";
  }
  setTimeout(() => (button.textContent = "Copy"), 2000);
}
