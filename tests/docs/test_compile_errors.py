"""A task or a bound of a user's own that misses a member fails to compile with one sentence that names the member."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

TASK = {
    "Scalar": "using Scalar = double;",
    "Space": "using Space = fpbm::Position<1>;",
    "kRows": "static constexpr int kRows = 1;",
    "kWhole": "static constexpr bool kWhole = true;",
    "gains": "fpbm::TaskGains<> gains{10.0, 25.0};",
    "bind": "template <typename Robot> void bind(const Robot&) {}",
}
TASK_PROGRAM = """
#include <fpbm/task/stack.hpp>
#include <fpbm/model/presets.hpp>
#include <fpbm/model/robot.hpp>
#include <fpbm/task/detail/task_gains.hpp>
struct Own {{ {members} }};
int main() {{
  fpbm::Stack stack(Own{{}});
  stack.bind(fpbm::Robot<7>(fpbm::presets::panda()));
}}
"""
BOUND = {
    "kRows": "static constexpr int kRows = 1;",
    "kStatus": "static constexpr fpbm::Status kStatus = fpbm::Status::kSlowed;",
    "empty": "bool empty() const noexcept { return false; }",
    "require": "void require(const fpbm::Vector<7>&) {}",
    "rows": "template <typename Next, typename Rows> void rows(const Next&, Rows&) noexcept {}",
    "accepts": "template <typename Limits, typename Stop>\n"
    "bool accepts(const Limits&, const fpbm::State<7>&, const Stop&) noexcept { return true; }",
}
GAPS = "template <typename F> void gaps(const fpbm::Vector<7>&, double, const F&) noexcept {}"
GAPS_PROGRAM = """
#include <fpbm/fpbm.hpp>
struct Own {{ {members} }};
int main() {{
  const fpbm::Robot<7> robot(fpbm::presets::panda());
  const fpbm::Stack stack(fpbm::PoseTask<>{{fpbm::LinkFrame<>(fpbm::Robot<7>::kTip), fpbm::TaskGains<>(1.0)}});
  fpbm::InverseKinematics inverse(robot, stack, {{}}, robot.limits(), fpbm::Bounds(Own{{}}));
  (void)inverse.solve(inverse.tip(fpbm::Vector<7>{{}}), fpbm::Vector<7>{{}});
}}
"""
BOUND_PROGRAM = """
#include <fpbm/bound/bounds.hpp>
struct Own {{ {members} }};
int main() {{
  fpbm::Bounds<Own> bounds;
  bounds.require(fpbm::Vector<7>{{}});
  constexpr auto kLevel = fpbm::Level::kAcceleration;
  using Next = fpbm::NextMotion<kLevel, 7>;
  (void)(bounds.rows(*static_cast<const Next*>(nullptr)).count);
  using Limits = fpbm::Limits<kLevel, 7>;
  (void)bounds.accepts(*static_cast<const Limits*>(nullptr), fpbm::State<7>{{}}, fpbm::Stop<kLevel, 7>::at_rest(7));
}}
"""


def errors(program: str, folder: Path) -> str:
    """Errors of g++, without the code that the compiler quotes."""
    source = folder / "own.cpp"
    source.write_text(program)
    command = ["g++", "-std=c++17", "-fsyntax-only", f"-I{ROOT}/cpp/include", "-isystem", "/usr/include/eigen3"]
    outcome = subprocess.run([*command, str(source)], capture_output=True, text=True, check=False)
    return "\n".join(re.findall(r"error: (.*)", outcome.stderr))


@pytest.mark.parametrize("missing", [None, *TASK])
def test_a_task_names_its_missing_member(missing: str | None, tmp_path: Path) -> None:
    members = " ".join(code for name, code in TASK.items() if name != missing)
    text = errors(TASK_PROGRAM.format(members=members), tmp_path)
    assert (missing is None) == (not text), text
    assert missing is None or re.search(rf"a task needs `.*\b{missing}\b", text), text


@pytest.mark.parametrize("missing", [None, *BOUND])
def test_a_bound_names_its_missing_member(missing: str | None, tmp_path: Path) -> None:
    members = " ".join(code for name, code in BOUND.items() if name != missing)
    text = errors(BOUND_PROGRAM.format(members=members), tmp_path)
    assert (missing is None) == (not text), text
    assert missing is None or re.search(rf"a bound needs `.*\b{missing}\b", text), text


@pytest.mark.parametrize("missing", [False, True])
def test_a_bound_of_inverse_kinematics_needs_gaps(missing: bool, tmp_path: Path) -> None:
    members = " ".join([*BOUND.values(), *([] if missing else [GAPS])])
    text = errors(GAPS_PROGRAM.format(members=members), tmp_path)
    assert missing == ("a bound on the postures of InverseKinematics needs `template <typename F> void gaps(" in text)
    assert missing or not text, text
