"""What the sections of a job have in common."""

from typing import Annotated, Any, Optional

import numpy as np
from pydantic import BaseModel, ConfigDict, PlainValidator
from pydantic_core import PydanticCustomError


class Section(BaseModel):
    """A table of a job: these keys and no others, each of just its type.

    What values are good is for the library to say. A key that is left out is left to the library, too.
    """

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    @classmethod
    def key_order(cls) -> list[str]:
        """All keys, the kind first, then those of its own, then those that it shares with other kinds."""
        keys = ["kind"] if "kind" in cls.model_fields else []
        for each in cls.__mro__:
            if issubclass(each, Section):
                shared = {key for base in each.__bases__ if issubclass(base, Section) for key in base.model_fields}
                keys += [key for key in each.model_fields if key not in shared and key not in keys]
        return keys

    def given(self, *without: str) -> dict[str, Any]:
        """What is not left out, as keyword arguments."""
        values = {key: getattr(self, key) for key in self.key_order() if key != "kind" and key not in without}
        return {key: value for key, value in values.items() if value is not None}


def _numbers(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_numbers(entry) for entry in value]
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    raise PydanticCustomError("numbers", "must be numbers, as in [1, 2, 3]")


def _plane(value: Any) -> Any:
    return value if isinstance(value, str) else _numbers(value)


# What NumPy calls array_like: a number, or lists of them.
Numbers = Annotated[Any, PlainValidator(_numbers)]
Plane = Annotated[Any, PlainValidator(_plane)]
OptionalNumbers = Optional[Numbers]
