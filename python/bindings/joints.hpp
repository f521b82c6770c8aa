#pragma once

#include <array>
#include <string>
#include <tuple>

#include <pybind11/typing.h>

#include "arrays.hpp"
#include "fpbm/model/joint.hpp"

namespace fpbm::bindings {

inline constexpr std::array kTypes{"revolute", "continuous", "prismatic"};

inline JointType joint_type(const std::string& type, const validation::Argument& name) {
  for (std::size_t i = 0; i < kTypes.size(); ++i) {
    if (type == kTypes[i]) return static_cast<JointType>(i);
  }
  validation::reject(name, " = '" + type + "': must be 'revolute', 'continuous' or 'prismatic'");
}

/// A joint from an object with the attributes of fpbm_cpp.Joint.
inline Joint<> joint_of_python(const py::handle& given, const validation::Argument& name) {
  const auto number = [&](const char* attribute) { return py::cast<double>(given.attr(attribute)); };
  const auto array = [&](const char* attribute) { return ArrayLike(py::object(given.attr(attribute))); };
  Joint<> joint;
  joint.type = joint_type(py::cast<std::string>(given.attr("type")), name + ".type");
  joint.placement = transform(array("placement"), (name + ".placement").text().c_str());
  joint.axis = fixed_vector<3>(array("axis"), (name + ".axis").text().c_str());
  joint.bounds = {number("lower"), number("upper"),           number("velocity"),    number("acceleration"),
                  number("jerk"),  number("velocity_offset"), number("deceleration")};
  joint.name = py::cast<std::string>(given.attr("name"));
  if (const py::object mimic = given.attr("mimic"); !mimic.is_none()) {
    const auto [index, ratio, offset] = py::cast<std::tuple<int, double, double>>(mimic);
    if (index < 0) validation::fail(name + ".mimic[0]", index, "the index of a joint");
    joint.mimic = {index, ratio, offset};
  }
  return joint;
}

using PlainJoint = py::typing::Dict<py::str, py::object>;

/// A joint as keyword arguments of fpbm_cpp.Joint.
inline PlainJoint fields_of(const Joint<>& joint) {
  PlainJoint fields;
  fields["type"] = kTypes[static_cast<std::size_t>(joint.type)];
  fields["placement"] = array_of(joint.placement);
  fields["axis"] = array_of(joint.axis);
  fields["lower"] = joint.bounds.lower;
  fields["upper"] = joint.bounds.upper;
  fields["velocity"] = joint.bounds.velocity;
  fields["acceleration"] = joint.bounds.acceleration;
  fields["jerk"] = joint.bounds.jerk;
  fields["velocity_offset"] = joint.bounds.velocity_offset;
  fields["deceleration"] = joint.bounds.deceleration;
  fields["name"] = joint.name;
  return fields;
}

}  // namespace fpbm::bindings
