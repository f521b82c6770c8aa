"""Disabled pairs of links, named postures and rotors of an SRDF file."""

from __future__ import annotations

import os

from .xml_file import Kept, errors_of, read_xml

STATES: Kept = {("robot",): {"group_state": ("name",)}, ("robot", "group_state"): {"joint": ("name", "value")}}
ROTORS: Kept = {
    ("robot",): {"rotor_params": ()},
    ("robot", "rotor_params"): {"joint": ("name", "mass", "gear_ratio")},
}
KEPT: Kept = {("robot",): {"disable_collisions": ("link1", "link2")}}


def read_disabled_pairs(path: str | os.PathLike[str]) -> list[tuple[str, str]]:
    """The links of each <disable_collisions link1="..." link2="...">, as MoveIt's setup assistant writes them.

    The pairs and the names in a pair are sorted, without duplicates. <disable_default_collisions> is ignored, so more
    pairs are checked than in MoveIt. Raises ValueError if the file is not a valid SRDF, OSError if it cannot be read.
    """
    pairs = set()
    with errors_of(path):
        for element in read_xml(os.fsdecode(path), KEPT).parts:
            links = [element.attributes.get(key) for key in ("link1", "link2")]
            one, other = (link or "" for link in links)
            if not one or not other or one == other:
                raise ValueError(
                    f"line {element.line}: <disable_collisions> of {one!r} and {other!r}: must be two different links"
                )
            pairs.add((min(one, other), max(one, other)))
    return sorted(pairs)


def read_group_states(path: str | os.PathLike[str]) -> list[dict[str, float]]:
    """Joint positions of each <group_state> [rad] or [m], except states with a joint that has several numbers.

    Raises ValueError if the file is not a valid SRDF, OSError if it cannot be read.
    """
    states = []
    with errors_of(path):
        for element in read_xml(os.fsdecode(path), STATES).parts:
            state: dict[str, float] = {}
            for joint in element.parts:
                own = f"line {joint.line}: group state {element.attributes.get('name', '')!r}"
                if len(joint.attributes.get("value", "").split()) > 1:
                    break
                (state[joint.attributes.get("name", "")],) = joint.own_numbers("value", [0.0], own)
            else:
                states.append(state)
    return states


def read_rotors(path: str | os.PathLike[str]) -> dict[str, float]:
    """Inertias of the rotors at the joints, by joint, from each <joint> of <rotor_params> as Pinocchio reads them.

    The attribute "mass" is the inertia of the rotor [kg m^2]; the inertia at the joint is mass gear_ratio^2. Raises
    ValueError if the file is not a valid SRDF, OSError if it cannot be read.
    """
    rotors = {}
    with errors_of(path):
        for joint in (joint for element in read_xml(os.fsdecode(path), ROTORS).parts for joint in element.parts):
            name = joint.attributes.get("name", "")
            own = f"line {joint.line}: rotor of joint {name!r}"
            (mass,), (gear,) = joint.own_numbers("mass", [0.0], own), joint.own_numbers("gear_ratio", [1.0], own)
            if mass < 0.0:
                raise ValueError(f"{own}: mass = {mass:g}: must not be negative: correct <rotor_params>")
            rotors[name] = mass * gear**2
    return rotors
