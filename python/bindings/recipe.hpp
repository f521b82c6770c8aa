#pragma once

#include <pybind11/typing.h>

#include <memory>
#include <type_traits>
#include <utility>

#include "arrays.hpp"

namespace fpbm::bindings {

/// The call that makes a thing again, for pickle: a functools.partial of what pickle knows.
struct Recipe {
  py::object call;
};

/// A thing as Python has it, and as nobody else can change it.
template <typename Thing>
[[nodiscard]] py::object copy_of(const Thing& thing) {
  const py::object copy = py::module_::import("copy").attr("deepcopy");
  if constexpr (std::is_base_of_v<py::object, Thing>) {
    return copy(thing);
  } else {
    return copy(py::cast(thing));
  }
}

/// callable(arguments...), once more. Arrays among them must be copies of the caller's.
template <typename... Arguments>
[[nodiscard]] std::shared_ptr<const Recipe> recipe(Arguments&&... arguments) {
  const py::object partial = py::module_::import("functools").attr("partial");
  return std::make_shared<const Recipe>(Recipe{partial(std::forward<Arguments>(arguments)...)});
}

/// A method of a thing that has a recipe, once more.
template <typename Thing, typename... Arguments>
[[nodiscard]] std::shared_ptr<const Recipe> recipe_of_method(const char* name, const Thing& self,
                                                             Arguments&&... arguments) {
  const py::object caller = py::module_::import("operator").attr("methodcaller");
  return recipe(caller(name, std::forward<Arguments>(arguments)...), self);
}

/// __reduce__ of a thing that has a recipe.
template <typename Thing>
[[nodiscard]] py::typing::Tuple<py::object, py::ellipsis> reduce(const Thing& thing) {
  return py::make_tuple(thing.recipe->call, py::tuple());
}

}  // namespace fpbm::bindings
