// Simulates the arm with its target and updates the page, frame by frame.

import { element } from "./controls.js";
import { Strip, errorScale, shareScale, speedScale } from "./strips.js";
import { MAN, TICK, WMVN_ACCELERATION } from "./simulator.js";
import { describe, length, speed } from "./words.js";

const DEGREE = 180 / Math.PI;
const MOST = 100; // Ticks per frame: if the machine is too slow, the arm lags, but the page does not block.
const QUIET = 0.4; // Duration of a constant target after which the tip counts as at rest [s].

export class Show {
  constructor(simulator, stage, look) {
    this.simulator = simulator;
    this.stage = stage;
    this.look = look;
    this.moved = false; // Whether the visitor has moved the target.
    this.strips = {
      speed: new Strip(element("plot-speed"), { lines: 4, ...speedScale }),
      error: new Strip(element("plot-error"), { lines: 1, ...errorScale }),
      scale: new Strip(element("plot-scale"), { lines: 1, ...shareScale }),
    };
    this.begin();
  }

  /// Resets the state of the page after the simulator has started with an arm, or restarted.
  begin() {
    this.goal = [...this.simulator.tip];
    this.pushing = false;
    this.dragging = false;
    this.owed = 0;
    this.pace = 1;
    this.stage.rest(null);
    this.stage.forget();
    this.restedAt = null;
    this.before = [...this.simulator.reference];
    this.movedAt = this.simulator.time;
    this.strips.speed.set(this.simulator.dof);
    this.strips.error.clear();
    this.strips.scale.clear();
  }

  restart() {
    this.simulator.restart();
    this.begin();
  }

  followPath(pace = 1) {
    this.simulator.followPath();
    this.begin();
    this.pace = pace;
  }

  /// The target is grabbed, moved, released.
  take() {
    if (!this.pushing) this.goal = [...this.simulator.reference];
    this.pushing = this.dragging = true;
    this.pace = 1;
  }
  move(point) {
    this.moved = true;
    this.goal = this.simulator.arm === 0 ? [point[0], point[1], 0] : point;
  }
  release() {
    this.dragging = false;
  }

  /// The target stays at its current position.
  hold() {
    this.take();
    this.release();
  }

  /// Whether target and tip are at rest.
  get resting() {
    return this.simulator.time - this.movedAt > QUIET && this.simulator.error < 0.02;
  }

  get following() {
    return this.simulator.following !== 0;
  }

  run(ticks) {
    if (ticks <= 0) return;
    if (this.pushing) this.simulator.push(...this.goal);
    this.simulator.ticks(ticks);
    const { reference, time } = this.simulator;
    if (!this.pushing) this.goal = [...reference];
    const change = Math.hypot(...reference.map((x, i) => x - this.before[i]));
    this.before = [...reference];
    if (this.dragging || this.following || change > 1e-5) this.movedAt = time;
    if (this.resting && this.restedAt === null) {
      this.restedAt = time;
      this.pace = 1;
      this.stage.rest(this.simulator);
    } else if (time === this.movedAt) {
      this.restedAt = null;
      this.stage.rest(null);
    }
    this.stage.pass(this.simulator.tip);
    this.strips.speed.add(time, [...this.simulator.qd].map((rate) => rate * DEGREE));
    this.strips.error.add(time, [this.simulator.error]);
    this.strips.scale.add(time, [this.simulator.scale]);
  }

  /// Computes the ticks of a duration [s].
  advance(seconds) {
    this.owed = Math.min(this.owed + (this.pace * seconds) / TICK, MOST);
    const due = Math.floor(this.owed);
    this.owed -= due;
    this.run(due);
  }

  draw() {
    const { simulator, stage, look } = this;
    stage.show(simulator, this.goal);
    stage.draw();
    this.strips.speed.draw(look.joints, look);
    this.strips.error.draw([look.target], look);
    this.strips.scale.draw([look.target], look);
    say("speed", speed(simulator.fastest));
    say("error-value", length(simulator.error));
    const limited = simulator.settings.limited !== 0;
    say("scale-value", limited ? `${Math.round(100 * simulator.scale)} %` : "off");
    const { resting, following, dragging } = this;
    say("speed-label", resting ? "fastest joint, tip at rest" : "fastest joint");
    const still = simulator.fastest * DEGREE < 0.05;
    element("speed").closest(".meter").className = `meter ${resting ? (still ? "still" : "moving") : ""}`;
    const { status, fastest, error, settings } = simulator;
    const damped = settings.damping > 0;
    const leads = settings.feedback > 0 && settings.scheme !== MAN && settings.scheme !== WMVN_ACCELERATION;
    say("status", describe({ status, dragging, following, resting, damped, limited, leads, fastest, error }));
  }
}

function say(id, words) {
  const where = element(id);
  if (where.textContent !== words) where.textContent = words;
}
