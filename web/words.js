// Texts of the page.

const DEGREE = 180 / Math.PI;

export const ARMS = [
  {
    spare: "two redundant joints",
    story: `Two joints are enough for any position in a plane. This arm has four joints, so the joints can move while
      the tip is at rest. fpbm_cpp computes the motion of all four joints, a thousand times a second.`,
    weights: [1, 2, 3, 4],
  },
  {
    spare: "one redundant joint",
    story: `Six joints are enough for any pose of a hand. This Panda has seven joints, like your own arm: hold your hand
      on the table, and your elbow can still move. fpbm_cpp computes the motion of all joints, a thousand times a
      second.`,
    weights: [1, 1, 1, 1, 1, 1, 1],
  },
  {
    spare: "four redundant joints",
    story: `Three joints are enough for any position of a hand. This Panda has seven joints, so the joints can move
      while the hand stays in place. fpbm_cpp computes the motion of all joints, a thousand times a second.`,
    weights: [1, 1, 1, 1, 1, 1, 1],
  },
];

export const SCHEME_WORDS = [
  "The minimum joint velocity for the motion of the tip.",
  "The minimum weighted joint velocity. Joints with a larger weight move less.",
  "The minimum joint acceleration, without feedback of the tip error.",
  "WMVN at acceleration level, without feedback of the tip error.",
  "Wang et al., 2019: a balance of MAN and WMVN, with feedback of the tip error.",
];

const OK = 0;
const DAMPED = 2;
const SLOWED = 3;
const RECOVERING = 5;
const STALLED = 6;
const NOT_FINITE = 10;

/// The current state of the arm as a sentence. leads: whether the scheme has feedback of the tip error.
export function describe({ status, dragging, following, resting, damped, limited, leads, fastest, error }) {
  const turning = fastest * DEGREE;
  const off = error > 0.01;
  if (status === NOT_FINITE) return "The motion is not finite. Press “Back to start”.";
  if (off && !leads && !dragging && (status === STALLED || turning < 0.05)) {
    return "The arm is at rest away from its target: this scheme has no feedback of the tip error.";
  }
  if (status === RECOVERING) return "The arm made no progress, and moves to a remembered posture.";
  if (status === STALLED) return "The arm makes no progress, and stays at rest until the target moves.";
  if (status > STALLED) return "The posture is singular: the tip cannot move in every direction. The arm brakes.";
  if (dragging && status === SLOWED) return "A joint is at its limit: other joints take over, or the tip slows down.";
  if (dragging && status === DAMPED) return "Near a singular posture, the tip cannot move in every direction.";
  if (dragging && error > 0.1) return "The tip moves toward the target.";
  if (dragging && limited) return "The tip follows the target, and every joint stays within its limits.";
  if (dragging) return "The tip follows the target, without joint limits.";
  if (following) return "The tip draws its circle.";
  if (off && !resting) return "The tip moves toward its target.";
  if (turning > 0.05 && damped) return "The damping brakes the joints. The tip stays at rest.";
  if (turning > 1) return "The tip is at rest, but the joints still move: nothing in this scheme brakes them.";
  if (turning > 0.05) return "The tip is at rest. The joints still move slowly.";
  return status === OK ? "All joints are at rest." : "The arm is at rest.";
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
