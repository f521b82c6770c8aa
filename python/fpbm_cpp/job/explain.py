"""Pydantic's findings as complaints."""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from .complaint import Complaint, JobError
from .section import Section

# What values must be, by the names that Pydantic has for what they are not.
DEMANDS = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "text in quotes",
    "bool_type": "true or false",
    "list_type": "a list",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "numbers": "numbers, as in [1, 2, 3]",
    "too_short": "one at least",
}

Models = Sequence[type[Section]]


def explain(error: ValidationError, model: type[Section], table: Mapping[str, Any]) -> JobError:
    """What is wrong with a table that this model has refused."""
    return JobError(*(_complaint(finding, model, table) for finding in error.errors()))


def one_of(value: object, allowed: Sequence[str]) -> str:
    """' = value: must be one of ...', with the closest where one is close."""
    return f" = {text_of(value)}: must be one of {', '.join(allowed)}{_close_match(value, allowed)}"


def text_of(value: object) -> str:
    """A value as a file has it, or the beginning of it."""
    text = json.dumps(value, default=str, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _complaint(finding: ErrorDetails, model: type[Section], table: Mapping[str, Any]) -> Complaint:
    kind, value, context, steps = finding["type"], finding["input"], finding.get("ctx", {}), finding["loc"]
    where, models = _follow(steps, model, table)
    if kind == "extra_forbidden":
        above, models = _follow(steps[:-1], model, table)
        owner = "".join(_kinds(models[0])) or above or "a job"
        keys = [key for key in models[0].key_order() if key != "kind"]
        return Complaint(
            where, f": {owner} has no such key: must be one of {', '.join(keys)}{_close_match(steps[-1], keys)}"
        )
    if kind == "missing":
        return Complaint(where, ": is missing")
    if kind == "union_tag_not_found":
        return Complaint(f"{where}.kind", f": is missing: must be one of {', '.join(_all_kinds(models))}")
    if kind == "union_tag_invalid":
        return Complaint(f"{where}.kind", one_of(context["tag"], _all_kinds(models)))
    if kind == "literal_error":
        return Complaint(where, one_of(value, re.findall("'([^']*)'", context["expected"])))
    return Complaint(where, f" = {text_of(value)}: must be {DEMANDS.get(kind, finding['msg'])}")


def _close_match(word: object, allowed: Sequence[str]) -> str:
    close = difflib.get_close_matches(str(word).lower().replace("-", "_"), allowed, 1)
    return f'; did you mean "{close[0]}"?' if close else ""


def _follow(steps: Sequence[int | str], model: type[Section], table: Any) -> tuple[str, Models]:
    """The key that steps lead to, without the kinds that they pass, and the models that may stand there."""
    where, models = "", [model]
    for step in steps:
        if isinstance(step, int):
            if isinstance(table, list):  # Not where one table stands for a list of one.
                where, table = f"{where}[{step}]", table[step]
        elif len(models) > 1 and any(step in _kinds(each) for each in models):
            models = [each for each in models if step in _kinds(each)]
        else:
            where = f"{where}.{step}" if where else step
            field = models[0].model_fields.get(step) if models else None
            models = list(_models_in(field.annotation)) if field else []
            table = table.get(step) if isinstance(table, Mapping) else None
    return where, models


def _kinds(model: type[Section]) -> tuple[str, ...]:
    return get_args(model.model_fields["kind"].annotation) if "kind" in model.model_fields else ()


def _all_kinds(models: Models) -> list[str]:
    return [kind for model in models for kind in _kinds(model)]


def _models_in(annotation: Any) -> Iterator[type[Section]]:
    """The models that a type is made of."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)
