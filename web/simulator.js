// The simulator in WebAssembly: settings and view by name, in the order of plain.hpp.

const SETTINGS = ["scheme", "alpha", "feedback", "damping", "limited"];
const WEIGHTS = 7;
const VIEW = [
  ["dof", 1],
  ["time", 1],
  ["status", 1],
  ["scale", 1],
  ["error", 1],
  ["following", 1],
  ["q", 7],
  ["qd", 7],
  ["tip", 3],
  ["reference", 3],
  ["frames", 8 * 12],
  ["capsules", 8 * 8],
];

export const SCHEMES = ["MVN", "WMVN", "MAN", "WMVN acceleration", "FPBM"];
export const [MVN, , MAN, WMVN_ACCELERATION, FPBM] = SCHEMES.keys();
export const TICK = 1e-3; // [s]

export async function load(bytes) {
  const module = await WebAssembly.compile(bytes);
  // The module imports functions to print and to exit, for wrong arguments. These functions are never called, because
  // change() checks the settings.
  const imports = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    imports[from] ??= {};
    imports[from][name] = () => {
      throw new Error(`the simulator called ${name}`);
    };
  }
  const core = (await WebAssembly.instantiate(module, imports)).exports;
  core._initialize?.();
  return new Simulator(core);
}

class Simulator {
  constructor(core) {
    this.core = core;
    this.arm = 0;
    this.numbers = new Float64Array(core.memory.buffer, core.settings_address(), SETTINGS.length + WEIGHTS);
    let at = core.view_address();
    for (const [name, count] of VIEW) {
      const numbers = new Float64Array(core.memory.buffer, at, count);
      if (count === 1) Object.defineProperty(this, name, { get: () => numbers[0] });
      else this[name] = numbers;
      at += 8 * count;
    }
  }

  get settings() {
    const named = Object.fromEntries(SETTINGS.map((name, i) => [name, this.numbers[i]]));
    return { ...named, weights: [...this.numbers.subarray(SETTINGS.length)] };
  }

  /// Returns true if the arm continues, false if it had to restart.
  set(changes) {
    const before = this.numbers.slice();
    for (const [name, value] of Object.entries(changes)) {
      if (name === "weights") this.numbers.set(value, SETTINGS.length);
      else if (SETTINGS.includes(name)) this.numbers[SETTINGS.indexOf(name)] = value;
      else throw new Error(`no setting ${name}`);
    }
    const answer = this.core.change();
    if (answer < 0) {
      this.numbers.set(before);
      throw new Error(`out of range: ${JSON.stringify(changes)}`);
    }
    return answer === 1;
  }

  begin(arm, settings) {
    this.arm = arm;
    this.core.begin(arm);
    if (settings) this.set(settings);
    this.core.restart();
  }

  restart() {
    this.core.restart();
  }

  followPath() {
    this.core.follow_path();
  }

  push(x, y, z) {
    this.core.push(x, y, z);
  }

  ticks(count) {
    this.core.ticks(count);
  }

  /// Velocity of the fastest joint [rad/s].
  get fastest() {
    return this.qd.reduce((most, rate) => Math.max(most, Math.abs(rate)), 0);
  }
}
