"""The array types of the package."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

if TYPE_CHECKING:
    Got = TypeVar("Got")
    Given = TypeVar("Given")

    # Types of data class fields that accept values of more types than they return.
    class Field(Generic[Got, Given]):
        def __get__(self, thing: object, owner: Any = None) -> Got: ...
        def __set__(self, thing: object, value: Given) -> None: ...

    ArrayField = Field[Array, ArrayLike]
    OptionalArrayField = Field[Array | None, ArrayLike | None]
    FilledArrayField = Field[Array, ArrayLike | None]

else:
    ArrayField = OptionalArrayField = FilledArrayField = Any
