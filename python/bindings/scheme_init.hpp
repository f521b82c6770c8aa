#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "recipe.hpp"
#include "scheme_options.hpp"

/// How Python's schemes are made: their own arguments, then the options that all share.
namespace fpbm::bindings {

/// The arguments that a scheme was made with, by name: its own, then the options.
template <typename Type, typename... Own>
py::dict arguments(const std::vector<std::string>& names, const Options& options, const Own&... own) {
  py::dict result;
  std::size_t i = 0;
  ((result[names[i++].c_str()] = copy_of(own)), ...);
  if (Type::kLevel == Level::kAcceleration) result["null_damping"] = options.null_damping;
  result["rest_posture"] = copy_of(options.rest_posture);
  result["null_stiffness"] = options.null_stiffness;
  result["c"] = copy_of(options.c);
  result["joint_centring"] = options.joint_centring;
  result["manipulability_gain"] = options.manipulability_gain;
  result["second_task"] = options.second_task;
  result["singular_radius"] = options.singular_radius;
  result["singular_brake"] = options.singular_brake;
  return result;
}

inline void note_name(std::vector<std::string>& names, const py::arg& argument) {
  names.emplace_back(argument.name);
}
inline void note_name(std::vector<std::string>&, const py::kw_only&) {}

/// Defines type(own..., options): own are the arguments that make() takes, args their names, the rest the options.
template <typename Type, typename... Own, typename... Args>
void define_init(py::class_<Type, PyScheme>& type, PyScheme (*make)(Own...), const Args&... args) {
  const auto define = [&](auto init, const auto&... damping) {
    type.def(py::init(init), args..., damping..., py::arg("rest_posture") = py::none(), py::arg("null_stiffness") = 0.0,
             py::arg("c") = py::none(), py::arg("joint_centring") = 0.0, py::arg("manipulability_gain") = 0.0,
             py::arg("second_task") = py::none(), py::arg("singular_radius") = 0.0,
             py::arg("singular_brake") = Options().singular_brake);
  };
  std::vector<std::string> names;
  (note_name(names, args), ...);
  const auto made = [make, names](const Own&... own, const Options& options) {
    Type scheme{{finish(make(own...), options)}};
    scheme.recipe = recipe(py::type::of<Type>(), **arguments<Type>(names, options, own...));
    return scheme;
  };
  if constexpr (Type::kLevel == Level::kAcceleration) {
    define(
        [made](Own... own, double damping, const OptionalArray& rest, double stiffness, const OptionalArray& c,
               double centring, double ascent, const OptionalTask& second, double radius, double brake) {
          return made(own..., {damping, rest, stiffness, c, centring, ascent, second, radius, brake});
        },
        py::arg("null_damping") = 0.0);
  } else {
    define([made](Own... own, const OptionalArray& rest, double stiffness, const OptionalArray& c, double centring,
                  double ascent, const OptionalTask& second, double radius, double brake) {
      return made(own..., {0.0, rest, stiffness, c, centring, ascent, second, radius, brake});
    });
  }
}

}  // namespace fpbm::bindings
