import packed from "simulator.wasm.gz";

import { Controls, element } from "./controls.js";
import { Drag } from "./drag.js";
import { look, whenLookChanges } from "./look.js";
import { Stage } from "./scene.js";
import { Show } from "./show.js";
import { load } from "./simulator.js";
import { Steps } from "./steps.js";
import { ARMS } from "./words.js";

const PAPER = { scheme: 4, alpha: 0.6, damping: 0 };
const STILL = 0.02; // [rad/s]
const HURRY = 2.5; // Simulated time over real time.

async function unpacked(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

async function main() {
  const simulator = await load(await unpacked(packed));
  simulator.begin(0, { ...PAPER, feedback: 5, limited: 1, weights: ARMS[0].weights });
  let colors = look();
  const stage = new Stage(element("arm"), colors, () => [element("story").getBoundingClientRect().bottom + scrollY, 60]);
  introduce();
  stage.set(simulator);
  const show = new Show(simulator, stage, colors);
  const steps = new Steps();

  const controls = new Controls({ changed: set, arm });
  const drag = new Drag(stage, {
    goal: () => show.goal,
    tip: () => simulator.tip,
    began: () => show.take(),
    moved: (point) => show.move(point),
    ended: () => show.release(),
  });
  const tell = () => controls.show(simulator.settings, simulator.dof, colors.joints);

  function set(changes) {
    if (!simulator.set(changes)) show.begin();
    tell();
  }

  function arm(number) {
    simulator.begin(number, { weights: ARMS[number].weights });
    introduce();
    tell();
    stage.set(simulator);
    show.begin();
    greet();
  }

  function greet() {
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) show.followPath();
  }

  function introduce() {
    element("spare").textContent = ARMS[simulator.arm].spare;
    element("story").textContent = ARMS[simulator.arm].story;
    element("turn-words").hidden = simulator.arm === 0;
    for (const choice of document.getElementsByName("arm")) choice.checked = Number(choice.value) === simulator.arm;
  }

  /// Holds the target with the paper's scheme. An arm at rest first follows the path, so that its joints drift.
  function rest() {
    set(PAPER);
    if (simulator.fastest < STILL) show.followPath(HURRY);
    else show.hold();
  }

  element("rest").addEventListener("click", rest);
  element("circle").addEventListener("click", () => show.followPath());
  element("restart").addEventListener("click", () => {
    show.restart();
    stage.resize(true);
  });
  new ResizeObserver(() => stage.resize(!drag.active)).observe(element("arm"));
  whenLookChanges(() => {
    colors = look();
    show.look = colors;
    stage.set(simulator, colors);
    tell();
  });

  let running = true;
  let last = null;
  function frame(now) {
    requestAnimationFrame(frame);
    if (!running) return;
    if (last !== null) show.advance((now - last) / 1000);
    last = now;
    paint();
  }
  function paint() {
    element("arm").classList.toggle("dragging", drag.active);
    steps.watch(show);
    steps.place(stage, show.goal);
    show.draw();
  }

  tell();
  greet();
  requestAnimationFrame(frame);

  /// For tests: stop the clock, and compute single ticks.
  window.fpbm = {
    simulator,
    show,
    stage,
    set,
    arm,
    paint,
    pause: () => (running = false),
    resume: () => {
      running = true;
      last = null;
    },
    /// Position on the page of a point of the base frame.
    onPage: (point) => drag.onPage(point),
  };
}

main().catch((error) => {
  element("status").textContent = `This browser cannot run the page: ${error.message}. Use a current browser.`;
  throw error;
});
