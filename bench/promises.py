"""Promised bounds on the results, and whether the results satisfy them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from report import Results

PEERS = {"pinocchio": "Pinocchio + Eigen", "kdl": "KDL + Eigen"}
# Some promises are relative to the earlier commit 8e7cfab. The Panda pose step of FPBM at 8e7cfab took 0.25 of the time
# of Pinocchio + Eigen on a quiet machine (0.28 in the results of 8e7cfab, on a busy machine). bench/README.md
# explains the use of this ratio. OLD_INSTRUCTIONS are the instructions of ticks at 8e7cfab by g++ 12. Limited ticks
# were first counted at 02cf2e0.
OLD_STEP = 0.25
OLD_INSTRUCTIONS = {
    "loop/panda/pose/tick": 22541.1,
    "loop/panda/pose/limited": 29235.7,
    "loop/panda/pose/limited_jerk": 32092.8,
    "loop/panda/position/limited": 17321.3,
    "loop/panda/position/limited_jerk": 19847.2,
}


def instructions(results: Results, job: str) -> float | None:
    """Mean instructions per call of a job. None without a count by the compiler of OLD_INSTRUCTIONS."""
    same = str(results.values["built_with"]["compiler"]).startswith("g++ 12.")
    return results.values.get("instructions", {}).get(job) if same else None


def rows(results: Results) -> list[list[str]]:
    """Rows with a promise, the measured value, the promised bound, and whether the value satisfies the bound."""
    lines: list[list[str]] = []

    def add(what: str, value: float | None, bar: float, text: str, at_least: bool = False) -> None:
        if value is None:
            lines.append([what, "not measured", text.format(bar), ""])
            return
        kept = value >= bar if at_least else value <= bar
        lines.append([what, text.format(value), text.format(bar), "yes" if kept else "**no**"])

    fpbm = "step/panda/pose/fpbm"
    for damping, library in (("damping off", "fpbm_cpp"), ("damping on", "fpbm_cpp_damped")):
        for step, name, peer, bar, text in (
            ("Panda pose step", fpbm, "pinocchio", 0.17, "{:.2f}"),
            ("Panda pose step", fpbm, "kdl", 0.055, "{:.3f}"),
            ("planar n = 4 step", "step/planar4/position/fpbm", "pinocchio", 0.13, "{:.2f}"),
        ):
            share = results.ratio(name, peer, library)
            add(f"{step} of FPBM, {damping}: ratio to {PEERS[peer]}'s time", share, bar, text)
    for kind, lanes, bar in (("avx2", "in 4 lanes, AVX2", 0.20), ("avx512", "in 8 lanes, AVX-512", 0.14)):
        share = results.ratio(fpbm, "pinocchio", kind)
        old = share / OLD_STEP if share else None
        add(f"Panda pose step of FPBM, an arm {lanes}: ratio to a step of 8e7cfab, computed", old, bar, "{:.2f}")
    for case in ("panda/pose/acceleration", "panda/pose/jerk", "panda/position/acceleration", "panda/position/jerk"):
        shares = [results.ratio(f"limited/{case}", qp) for qp in ("eiquadprog_rt", "eiquadprog_fast")]
        share = max((each for each in shares if each), default=None)
        words = case.replace("/", ", ") + (", two problems each" if case.endswith("jerk") else "")
        add(f"limited step, {words}: ratio to the faster eiquadprog's time", share, 0.30, "{:.2f}")
    for job, before in OLD_INSTRUCTIONS.items():
        count, bar = instructions(results, job), 0.75 if job.endswith("tick") else 0.8
        share = count / before if count else None
        add(f"instructions of {job.replace('/', ' ')}: ratio to an earlier version", share, bar, "{:.2f}")
    for robot, words in (("two_pandas", "two Pandas"), ("g1_upper_body", "G1's upper body")):
        for part, meaning in (("J", "J"), ("J_and_Jd", "J and J̇"), ("J_and_Jd_qd", "J and J̇q̇")):
            share = results.ratio(f"trees/{robot}/{part}", "pinocchio")
            add(f"{meaning} of two frames of {words}: ratio to Pinocchio's time", share, 0.30, "{:.2f}")
    for row, words, bar in (
        ("14/two_poses/free", "two poses of two Pandas, without limits", 5.0),
        ("g1_upper_body/grasp/limited", "three levels of G1's 17 joints, limits active", 15.0),
        ("17/grasp/limited", "three levels of two Pandas on a torso of 3 joints, limits active", 15.0),
    ):
        time = results.least(f"ticks/{row}")
        add(f"tick: {words}", time / 1e3 if time else None, bar, "{:.1f} µs")
    torch, pose = (results.least(f"step/{row}/fpbm_damped/fpbm_cpp") for row in ("ur5e/torch", "panda/pose"))
    of_pose = torch / pose if torch and pose else None
    add("UR5e step of FPBM, position and axis of the tip: ratio to a Panda pose step", of_pose, 1.1, "{:.2f}")
    many = results.least("python/panda/pose/fpbm/fpbm_cpp_many")
    add("Panda pose step of FPBM from Python, 10,000 states a call, on one thread", many, 600.0, "{:.0f} ns")
    if results.values.get("isolated"):  # On a shared core, the tail depends on other programs.
        for row in results.tails:
            if row["caches"] == "warm" and row["name"] != "timer":
                name = row["name"].replace("/", " ")
                add(f"p99.9 over p50 in a warm loop, {name}", row["p99.9"] / row["p50"], 1.5, "{:.2f}")
    for task in ("pose", "position"):
        counts = results.values.get("instructions", {})
        plain_count, jerk = (counts.get(f"loop/panda/{task}/limited{suffix}") for suffix in ("", "_jerk"))
        ratio = jerk / plain_count if plain_count and jerk else None
        name = f"limited tick, Panda {task}, with bounds on jerk: ratio to a tick without these bounds"
        add(name, ratio, 1.3, "{:.2f}")
    best = max((row["ratio"] for row in results.sweeps if row["name"] == "planar4/position"), default=None)
    name = "sweep of the paper's circle on two threads: ratio to one thread without lanes"
    add(name, best, 10.0, "{:.1f}", at_least=True)
    return lines
