"""The array types of the package."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

if TYPE_CHECKING:
    # Types of data class fields that accept values of more types than they return.

    class ArrayField:
        def __get__(self, thing: object, owner: Any = None) -> Array: ...
        def __set__(self, thing: object, value: ArrayLike) -> None: ...

    class OptionalArrayField:
        def __get__(self, thing: object, owner: Any = None) -> Array | None: ...
        def __set__(self, thing: object, value: ArrayLike | None) -> None: ...

    class FilledArrayField:
        def __get__(self, thing: object, owner: Any = None) -> Array: ...
        def __set__(self, thing: object, value: ArrayLike | None) -> None: ...

    class DerivedField:
        def __get__(self, thing: object, owner: Any = None) -> float: ...
        def __set__(self, thing: object, value: float | None) -> None: ...

else:
    ArrayField = OptionalArrayField = FilledArrayField = DerivedField = Any
