// The three steps of the introduction, marked as they are completed, and the hint at the target.

import { Vector3 } from "three";

import { element } from "./controls.js";
import { MAN } from "./simulator.js";

const STEPS = ["drag", "rest", "damp"];
const DEGREE = 180 / Math.PI;
const ALMOST = 0.1; // Speed below which joints count as at rest [°/s].

export class Steps {
  constructor() {
    this.done = new Set();
    this.drifted = false; // Whether joints moved without damping since the tip stopped.
    this.mark();
  }

  /// Detects the steps that the visitor has completed.
  watch({ moved, resting, simulator }) {
    const fastest = simulator.fastest * DEGREE;
    const damped = simulator.settings.damping > 0 || simulator.settings.scheme < MAN;
    this.drifted = resting && (this.drifted || (fastest > ALMOST && !damped));
    if (moved) this.finish("drag");
    if (this.drifted && this.done.has("drag")) this.finish("rest");
    if (this.drifted && this.done.has("rest") && fastest < ALMOST && damped) this.finish("damp");
  }

  finish(step) {
    if (this.done.has(step)) return;
    this.done.add(step);
    if (step === "drag") element("hint").classList.add("gone");
    this.mark();
  }

  mark() {
    const now = STEPS.find((step) => !this.done.has(step));
    for (const step of STEPS) {
      element(`step-${step}`).className = this.done.has(step) ? "done" : step === now ? "now" : "";
    }
    if (now) return;
    element("step-damp").classList.add("last");
    element("install").closest(".card").classList.add("next");
  }

  /// Keeps the hint beside the target.
  place(stage, goal) {
    if (this.done.has("drag")) return;
    const canvas = stage.renderer.domElement;
    const seen = stage.world.localToWorld(new Vector3(...goal)).project(stage.camera);
    const x = ((seen.x + 1) / 2) * canvas.clientWidth;
    const y = ((1 - seen.y) / 2) * canvas.clientHeight;
    const hint = element("hint");
    const left = Math.min(x + 24, canvas.clientWidth - hint.clientWidth - 6);
    hint.style.transform = `translate(${left.toFixed(1)}px, ${(y + 16).toFixed(1)}px)`;
  }
}
