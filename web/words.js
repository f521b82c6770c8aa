// What the page says, in plain words.

const DEGREE = 180 / Math.PI;

export const ARMS = [
  {
    spare: "two joints to spare",
    story: `Two joints are enough to reach any point of a plane. This arm has four. So its tip can rest while its joints move,
      and something must choose how all four turn: fpbm_cpp does, a thousand times a second.`,
    weights: [1, 2, 3, 4],
  },
  {
    spare: "one joint to spare",
    story: `Six joints are enough to place a hand and to turn it. This Panda has seven, as your own arm has: hold your hand on
      the table, and your elbow can still move. fpbm_cpp chooses how all seven turn, a thousand times a second.`,
    weights: [1, 1, 1, 1, 1, 1, 1],
  },
  {
    spare: "four joints to spare",
    story: `Three joints are enough to place a hand that may turn as it likes. This Panda has seven. So its hand can stay in
      place while its joints move, and something must choose how: fpbm_cpp does, a thousand times a second.`,
    weights: [1, 1, 1, 1, 1, 1, 1],
  },
];

export const SCHEME_WORDS = [
  "The least joint speed for the motion of the tip.",
  "The least joint speed; joints with more weight move less.",
  "The least joint acceleration. Nothing leads the tip back once it is off its target.",
  "WMVN by accelerations. Nothing leads the tip back once it is off its target.",
  "Of Wang et al., 2019: a balance of MAN and WMVN, with feedback that leads the tip back to its target.",
];

const OK = 0;
const DAMPED = 2;
const SLOWED = 3;
const RECOVERING = 5;
const STALLED = 6;
const NOT_FINITE = 9;

/// What the arm does now. leads: whether the scheme has feedback on the tip.
export function describe({ status, dragging, following, resting, damped, limited, leads, fastest, error }) {
  const turning = fastest * DEGREE;
  const off = error > 0.01;
  if (status === NOT_FINITE) return "The motion has grown beyond all bounds. Press “Back to start”.";
  if (off && !leads && !dragging && (status === STALLED || turning < 0.05)) {
    return "The arm rests off its target: this scheme has no feedback that would lead it there.";
  }
  if (status === RECOVERING) return "The arm got no nearer. It moves to a posture that it remembers, and tries again.";
  if (status === STALLED) return "The arm gets no nearer. It waits at rest until the target moves.";
  if (status > STALLED) return "The arm is stretched out, where it cannot move in every direction. It brakes.";
  if (dragging && status === SLOWED) return "A joint is at its limit: the others take over, or the tip slows down.";
  if (dragging && status === DAMPED) return "The arm is almost straight. It moves only where it still can.";
  if (dragging && error > 0.1) return "The tip is on its way to you.";
  if (dragging && limited) return "The tip follows you, and every joint keeps within its limits.";
  if (dragging) return "The tip follows you, whatever that asks of the joints.";
  if (following) return "The tip draws its circle.";
  if (off && !resting) return "The tip is on its way.";
  if (turning > 0.05 && damped) return "The damping brakes the joints. The tip stays where it is.";
  if (turning > 1) return "The tip rests, but the joints go on: nothing in this scheme brakes them.";
  if (turning > 0.05) return "The tip rests. The joints still turn, slowly.";
  return status === OK ? "All joints are at rest." : "The arm rests.";
}

export function speed(fastest) {
  const value = fastest * DEGREE;
  if (value >= 99.5) return value.toFixed(0);
  return value.toFixed(value >= 0.1 || value === 0 ? 1 : 2);
}

export function length(metres) {
  for (const [unit, size] of [["m", 1], ["mm", 1e-3], ["µm", 1e-6], ["nm", 1e-9], ["pm", 1e-12]]) {
    if (metres >= 0.9995 * size) return `${(metres / size).toPrecision(3)} ${unit}`;
  }
  return "< 1 pm";
}
