#pragma once

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "fpbm/core/detail/validation.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/model/chain.hpp"

namespace fpbm::bindings {

using Array = py::array_t<double>;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Throws std::invalid_argument for an argument of a wrong type. demand: the requirement in words.
[[noreturn]] inline void reject_type(const py::handle& given, const std::string& name, const char* demand) {
  validation::reject(name, std::string(": must be ") + demand + ", got " +
                               py::cast<std::string>(py::type::handle_of(given).attr("__name__")) + " " +
                               py::cast<std::string>(py::repr(given)).substr(0, 60));
}

/// Whether an object is of a class of a module of the package.
inline bool is_class(const py::handle& given, const char* module, const char* name) {
  return py::isinstance(given, py::module_::import((std::string("fpbm_cpp.") + module).c_str()).attr(name));
}

/// Throws std::invalid_argument unless an argument is an object of a class of the package.
inline void require_class(const py::handle& given, const char* module, const char* name, const std::string& argument,
                          const char* demand) {
  if (!is_class(given, module, name)) reject_type(given, argument, demand);
}

/// A field of an object of the package. The class of the object may be a subclass outside the package, whose class
/// variables and properties do not count.
inline py::object field(const py::handle& object, const char* name) {
  return object.attr("__dict__")[name];
}

inline bool is_candidate(const PyObject* /*object*/) {
  return true;
}

/// Any input of numpy.asarray: the argument is checked and converted here, so that the ValueError for a wrong argument
/// has the name of the argument.
class ArrayLike : public py::object {
 public:
  PYBIND11_OBJECT_DEFAULT(ArrayLike, py::object, is_candidate)
};

/// An argument that must be a T. The ValueError for another object has the name of the argument, which the TypeError of
/// pybind11 does not have.
template <typename T>
class Given : public py::object {
 public:
  PYBIND11_OBJECT_DEFAULT(Given, py::object, is_candidate)

  /// demand: the requirement in words. Throws std::invalid_argument unless the argument is a T.
  [[nodiscard]] const T& as(const char* name, const char* demand) const {
    if (!py::isinstance<T>(*this)) reject_type(*this, name, demand);
    return py::cast<const T&>(*this);
  }
};

inline std::string shape_text(const py::array& array) {
  return py::cast<std::string>(py::str(array.attr("shape")));
}
inline std::string shape_text(const std::vector<py::ssize_t>& shape) {
  return py::cast<std::string>(py::str(py::tuple(py::cast(shape))));
}

/// Number of dimensions of an array or of an object that can be converted; otherwise -1.
inline int dimensions(const ArrayLike& argument) {
  const auto any = py::array::ensure(argument);
  PyErr_Clear();
  return any ? static_cast<int>(any.ndim()) : -1;
}

/// Real numbers in an array of the given number of dimensions. Throws std::invalid_argument.
inline py::array_t<double, py::array::c_style> real_array(const ArrayLike& argument, const char* name, int dimensions) {
  // Most arguments need no conversion.
  if (py::isinstance<py::array_t<double, py::array::c_style>>(argument)) {
    auto array = py::reinterpret_borrow<py::array_t<double, py::array::c_style>>(argument);
    if (array.ndim() == dimensions) return array;
  }
  const auto any = py::array::ensure(argument);
  if (!any || (any.dtype().kind() != 'f' && any.dtype().kind() != 'i' && any.dtype().kind() != 'u')) {
    PyErr_Clear();
    validation::reject(name, ": must be real numbers in an array or a plain sequence, got " +
                                 py::cast<std::string>(py::repr(argument)).substr(0, 80));
  }
  if (any.ndim() != dimensions) {
    validation::reject(name, ": must have " + std::to_string(dimensions) +
                                 (dimensions == 1 ? " dimension" : " dimensions") + ", got shape " + shape_text(any));
  }
  return py::array_t<double, py::array::c_style | py::array::forcecast>(any);
}

using OptionalArray = std::optional<ArrayLike>;

/// An array for a result instead of a new array.
class OutArray : public py::object {
 public:
  PYBIND11_OBJECT_DEFAULT(OutArray, py::object, is_candidate)
};
using OptionalOut = std::optional<OutArray>;

/// The array for a result of the given shape: `out`, or a new array. Throws std::invalid_argument if `out` is not an
/// array of the given shape that can be written without a conversion.
inline Array result_array(const OptionalOut& out, const std::vector<py::ssize_t>& shape) {
  if (!out) return Array(shape);
  if (py::isinstance<py::array_t<double, py::array::c_style>>(*out)) {
    auto array = py::reinterpret_borrow<Array>(*out);
    if (array.writeable() && std::equal(shape.begin(), shape.end(), array.shape(), array.shape() + array.ndim())) {
      return array;
    }
  }
  validation::reject("out", ": must be a writeable, C-contiguous array of float64 of shape " + shape_text(shape));
}

/// One entry per joint, 1 to kMaxDof entries; the values are not checked.
inline Vector<Eigen::Dynamic> joint_vector(const ArrayLike& argument, const char* name) {
  const auto array = real_array(argument, name, 1);
  validation::require_dof(name, array.size(), 1);
  return Eigen::Map<const Eigen::VectorXd>(array.data(), array.size());
}

/// One entry per joint, which may be infinite but not NaN.
inline Vector<Eigen::Dynamic> bound_vector(const ArrayLike& argument, const char* name) {
  const Vector<Eigen::Dynamic> values = joint_vector(argument, name);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (std::isnan(values(i))) validation::fail(validation::element(name, i), values(i), "a number");
  }
  return values;
}

/// One finite entry per joint of an arm.
inline Vector<Eigen::Dynamic> joint_vector(const ArrayLike& argument, const char* name, int dof) {
  const auto array = real_array(argument, name, 1);
  const Eigen::Map<const Eigen::VectorXd> values(array.data(), array.size());
  validation::require_joint_vector(name, values, dof);
  return values;
}

/// A vector of exactly `Size` entries.
template <int Size>
Vector<Size> any_vector(const ArrayLike& argument, const char* name) {
  const auto array = real_array(argument, name, 1);
  if (array.size() != Size) {
    validation::reject(name, " has " + std::to_string(array.size()) + " entries: must have " + std::to_string(Size));
  }
  return Eigen::Map<const Vector<Size>>(array.data());
}

/// A vector of exactly `Size` finite entries.
template <int Size>
Vector<Size> fixed_vector(const ArrayLike& argument, const char* name) {
  const auto result = any_vector<Size>(argument, name);
  validation::require_finite(name, result);
  return result;
}

/// A nonzero vector of any length, multiplied by a power of 2 so that its square neither overflows nor underflows.
inline Vector<3> direction(const ArrayLike& argument, const char* name) {
  const Vector<3> given = fixed_vector<3>(argument, name);
  const double size = given.cwiseAbs().maxCoeff();
  if (!(size > 0.0)) validation::reject(name, " is zero: must be a nonzero vector");
  const int exponent = -std::ilogb(size);
  Vector<3> scaled;
  for (int i = 0; i < 3; ++i) scaled(i) = std::ldexp(given(i), exponent);
  return scaled;
}

/// A matrix of exactly `rows` x `cols` entries, which must be finite unless is_any.
template <typename Result = Eigen::MatrixXd>
Result matrix(const ArrayLike& argument, const char* name, Eigen::Index rows, Eigen::Index cols, bool is_any = false) {
  const auto array = real_array(argument, name, 2);
  if (array.shape(0) != rows || array.shape(1) != cols) {
    validation::reject(name, ": must have shape (" + std::to_string(rows) + ", " + std::to_string(cols) + "), got " +
                                 shape_text(array));
  }
  const Result result = Eigen::Map<const RowMajor>(array.data(), rows, cols);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < cols; ++j) {
      if (!is_any && !std::isfinite(result(i, j)))
        validation::fail(validation::element(name, i, j), result(i, j), "finite");
    }
  }
  return result;
}

/// A frame: a homogeneous 4 x 4 matrix of finite numbers. name() returns the name of the argument.
template <typename Name>
Transform<> transform_of(const Eigen::Matrix4d& H, const Name& name) {
  const Transform<> result{H.topRightCorner<3, 1>(), H.topLeftCorner<3, 3>()};
  if (H.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    validation::reject(name(), ": must be a homogeneous matrix, with (0, 0, 0, 1) as its last row");
  }
  if (!chain_check::is_rotation(result.R)) validation::reject(name() + ".R", ": must be a rotation matrix");
  return result;
}
inline Transform<> transform(const ArrayLike& argument, const char* name) {
  return transform_of(matrix<Eigen::Matrix4d>(argument, name, 4, 4), [name] { return validation::Argument(name); });
}

/// A point of a task space from Space::kSize finite numbers. name() returns the name of the point.
template <typename Space, typename Name>
typename Space::template Point<double> point_at(const double* numbers, const Name& name) {
  if constexpr (std::is_same_v<Space, Pose>) {
    return transform_of(Eigen::Map<const RowMajor>(numbers, 4, 4), name);
  } else {
    return Eigen::Map<const Vector<Space::kSize>>(numbers);
  }
}

/// A point of a task space: shape (2,), (3,) or (4, 4).
template <typename Space>
typename Space::template Point<double> point(const ArrayLike& argument, const char* name) {
  if constexpr (std::is_same_v<Space, Pose>) {
    return transform(argument, name);
  } else {
    return fixed_vector<Space::kSize>(argument, name);
  }
}

/// Limits from any object with lower, upper, velocity and acceleration, and optionally jerk, velocity_offset,
/// deceleration and effort. Each attribute has one number per joint, not NaN. Throws std::invalid_argument.
inline JointLimits<Eigen::Dynamic> joint_limits(const py::object& limits) {
  for (const char* name : {"lower", "upper", "velocity", "acceleration"}) {
    if (!py::hasattr(limits, name)) reject_type(limits, "limits", "JointLimits");
  }
  const auto bound = [&](const char* name) {
    if (limits.attr(name).is_none()) {
      validation::reject(validation::Argument("limits.") + name, " is missing: give limits.of(arm)");
    }
    return bound_vector(ArrayLike(py::object(limits.attr(name))), name);
  };
  JointLimits<Eigen::Dynamic> result{bound("lower"), bound("upper"), bound("velocity"), bound("acceleration")};
  const auto has = [&](const char* name) { return py::hasattr(limits, name) && !limits.attr(name).is_none(); };
  if (has("jerk")) result.jerk = bound("jerk");
  if (has("velocity_offset")) result.velocity_offset = bound("velocity_offset");
  if (has("deceleration")) result.deceleration = bound("deceleration");
  if (has("effort")) result.effort = bound("effort");
  return result;
}

struct Model;

/// The limits of a motion of a model: the given limits, which may lack fields, or the limits of the model.
JointLimits<Eigen::Dynamic> limits_of(const Model& model, const py::object& given);

/// A vector, a matrix or a point of a task space in Python.
template <typename Derived>
Array array_of(const Eigen::MatrixBase<Derived>& values) {
  std::vector<py::ssize_t> shape{values.rows()};
  if (Derived::ColsAtCompileTime != 1) shape.push_back(values.cols());
  Array result(shape);
  Eigen::Map<RowMajor>(result.mutable_data(), values.rows(), values.cols()) = values;
  return result;
}
inline Array array_of(const Transform<>& x) {
  Array result({4, 4});
  Pose::store(x, result.mutable_data());
  return result;
}

/// Which of n joints have a bit.
inline py::array_t<bool> array_of(JointBits bits, Eigen::Index n) {
  py::array_t<bool> joints(n);
  for (Eigen::Index i = 0; i < n; ++i) joints.mutable_at(i) = ((bits >> i) & 1U) != 0;
  return joints;
}

}  // namespace fpbm::bindings

namespace pybind11::detail {
template <>
struct handle_type_name<fpbm::bindings::OutArray> {
  static constexpr auto name = const_name("numpy.typing.NDArray[numpy.float64]");
};
template <typename T>
struct handle_type_name<fpbm::bindings::Given<T>> {
  static constexpr auto name = make_caster<T>::name;
};
template <>
struct handle_type_name<fpbm::bindings::ArrayLike> {
  static constexpr auto name = const_name("numpy.typing.ArrayLike");
};
}  // namespace pybind11::detail
